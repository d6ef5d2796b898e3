#include "plugin/library_file.hpp"

#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <vector>

namespace bramah {
namespace {

namespace fs = std::filesystem;

/// `count` bytes at `offset`; false where the file has none.
bool read_at(std::ifstream& in, std::uint64_t offset, void* to, std::size_t count) {
  in.seekg(static_cast<std::streamoff>(offset));
  in.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
  return !in.fail();
}

/// False where this is no ELF file of 64 bits.
bool read_header(std::ifstream& in, Elf64_Ehdr& header) {
  return read_at(in, 0, &header, sizeof header) && std::memcmp(header.e_ident, ELFMAG, SELFMAG) == 0 &&
         header.e_ident[EI_CLASS] == ELFCLASS64;
}

}  // namespace

std::string cut_short(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  Elf64_Ehdr header{};
  if (!read_header(in, header)) return "";  // dlopen says what it is instead
  std::error_code ignored;
  const std::uint64_t size = fs::file_size(file, ignored);
  std::uint64_t end = header.e_shoff + std::uint64_t{header.e_shnum} * header.e_shentsize;
  for (unsigned k = 0; k < header.e_phnum && header.e_phentsize == sizeof(Elf64_Phdr); ++k) {
    Elf64_Phdr segment{};
    if (!read_at(in, header.e_phoff + k * sizeof segment, &segment, sizeof segment))
      return "it ends within its headers";
    if (segment.p_type == PT_LOAD) end = std::max(end, segment.p_offset + segment.p_filesz);
  }
  if (end <= size) return "";
  return std::to_string(size) + " bytes of " + std::to_string(end);
}

std::string stamp_of(const fs::path& file) {
  constexpr char wanted[] = ".bramah_stamp";
  constexpr std::uint64_t longest = 256;
  std::ifstream in(file, std::ios::binary);
  Elf64_Ehdr header{};
  if (!read_header(in, header) || header.e_shentsize != sizeof(Elf64_Shdr) || header.e_shstrndx >= header.e_shnum)
    return "";
  std::vector<Elf64_Shdr> sections(header.e_shnum);
  if (!read_at(in, header.e_shoff, sections.data(), sections.size() * sizeof(Elf64_Shdr))) return "";
  const std::uint64_t names = sections[header.e_shstrndx].sh_offset;
  for (const Elf64_Shdr& section : sections) {
    char name[sizeof wanted] = {};
    if (!read_at(in, names + section.sh_name, name, sizeof name)) {
      in.clear();
      continue;
    }
    if (std::memcmp(name, wanted, sizeof wanted) != 0 || section.sh_size > longest) continue;
    std::string stamp(section.sh_size, '\0');
    if (!read_at(in, section.sh_offset, stamp.data(), stamp.size())) return "";
    return stamp.c_str();
  }
  return "";
}

}  // namespace bramah
