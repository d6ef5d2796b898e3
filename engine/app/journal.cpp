#include "app/journal.hpp"

#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "app/failure.hpp"
#include "io/parse_json.hpp"

namespace bramah {
namespace {

namespace fs = std::filesystem;

/// 64 bits of FNV-1a over all that the results follow from.
std::string stamp_of(const Context& context) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto take = [&](std::string_view text) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    hash = (hash ^ 0xff) * 0x100000001b3;  // no byte of UTF-8: where one text ends
  };
  take(BRAMAH_VERSION);
  take(context.scene.source.text);
  for (const std::string& setting : context.arguments.settings) take(setting);
  take("");
  for (const std::string& over : context.arguments.over) take(over);
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, hash);
  return text;
}

[[noreturn]] void refuse(const fs::path& file, const std::string& found, const std::string& expected,
                         const std::string& remedy) {
  throw Failure::scene({file.string(), ""}, SceneError(fault("not-a-journal", found, expected, remedy)), {});
}

/// False where the line is none that `add` writes.
bool parse_point(std::string_view line, std::vector<double>& at, Value& point) {
  Faults faults;
  if (!parse_json(line, point, faults) || !faults.empty() || point.object() == nullptr) return false;
  const Value* list = point.find("at");
  return list != nullptr && read_numbers(*list, at);
}

}  // namespace

Journal::Journal(const Context& context, const std::string& study, const std::string& name) {
  JsonWriter json;
  json.begin_flat_object().member("bramah_journal", study).member("stamp", stamp_of(context)).end_object();
  const std::string header = json.take();
  const Arguments& arguments = context.arguments;
  const fs::path folder(arguments.out);
  if (!arguments.out.empty()) {
    make_folder(folder);
    file_ = folder / name;
  }
  std::error_code ignored;
  const fs::path resume(arguments.resume);
  const std::string known = arguments.resume.empty() ? "" : read(resume, header);
  if (file_.empty()) return;
  const bool is_same = !arguments.resume.empty() && resume.filename() == file_.filename() &&
                       fs::equivalent(fs::absolute(resume).parent_path(), folder, ignored);
  if (is_same) {
    out_.emplace(file_, header.size() + known.size());
  } else {
    out_.emplace(file_);
    out_->write(header);
    out_->write(known);
  }
  out_->keep_on_failure();
  out_->flush();
}

std::string Journal::read(const fs::path& file, const std::string& header) {
  const fs::path there = OutputFile::there_is(file);
  std::ifstream in(there, std::ios::binary);
  if (there.empty() || !in) {
    refuse(file, "there is no such file", "the journal that an interrupted run has left",
           "name DIR/*.journal of its --out");
  }
  std::string line;
  std::getline(in, line);
  if (line + '\n' != header) {
    const bool is_journal = line.starts_with("{\"bramah_journal\"") || line.starts_with("{ \"bramah_journal\"");
    refuse(there,
           is_journal ? "the journal of another study, scene or version, or of other settings"
                      : "a file that is no journal",
           "the journal of this scene, as it was when it was written, with the same --set and --over",
           "take the journal of this run, or begin anew without --resume");
  }
  std::string known;
  // The last line may be cut short: the run was killed while it wrote.
  for (std::size_t number = 2; std::getline(in, line) && !in.eof(); ++number) {
    std::vector<double> at;
    Value point;
    if (!parse_point(line, at, point)) {
      refuse(there, "line " + std::to_string(number) + " is damaged", "a point of the study on every line",
             "delete that line, and its point is computed again");
    }
    points_.insert_or_assign(std::move(at), std::move(point));
    known += line + '\n';
  }
  return known;
}

const Value* Journal::find(const std::vector<double>& at) const {
  const auto found = points_.find(at);
  return found == points_.end() ? nullptr : &found->second;
}

void Journal::add(const std::vector<double>& at, const std::function<void(JsonWriter&)>& write) {
  if (!out_) return;
  JsonWriter json;
  json.begin_flat_object().key("at").values(at);
  write(json);
  json.end_object();
  const std::string line = json.take();
  const std::scoped_lock lock(mutex_);
  if (broken_) return;
  try {
    out_->write(line);
    out_->flush();
  } catch (const WriteError& error) {
    error_.emplace(error.file(), error.found() + "; what was found so far is in it",
                   error.remedy() + ", and go on with --resume " + file_.string());
    broken_ = true;
  }
}

void Journal::check() const {
  if (error_) throw WriteError(*error_);
}

void Journal::finish(bool interrupted) {
  if (!out_) return;
  if (interrupted) {
    out_->commit();
    say(last_words());
    return;
  }
  out_->discard();
  std::error_code ignored;
  fs::remove(file_, ignored);  // of an earlier run
}

std::string Journal::last_words() const {
  return file_.empty() ? ""
                       : "interrupted; what was found so far is in " + file_.string() + ", --resume " + file_.string() +
                             " goes on\n";
}

}  // namespace bramah
