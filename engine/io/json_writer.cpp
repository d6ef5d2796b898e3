#include "io/json_writer.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace bramah {
namespace {

void append_quoted(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      (out += '\\') += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (byte < 0x20 || byte == 0x7F) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(byte));
      out += escape.data();
    } else {
      out += c;
    }
  }
  out += '"';
}

}  // namespace

std::string exact_number(double value) {
  std::array<char, 40> digits{};
  const auto written =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 17);
  return {digits.data(), written.ptr};
}

void JsonWriter::new_line() {
  text_ += '\n';
  text_.append(2 * levels_.size(), ' ');
}

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (levels_.empty()) return;
  Level& level = levels_.back();
  if (!level.empty) text_ += level.flat ? ", " : ",";
  if (!level.flat) new_line();
  level.empty = false;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  append_quoted(text_, name);
  text_ += ": ";
  after_key_ = true;
  return *this;
}

JsonWriter& JsonWriter::raw(std::string_view text) {
  separate();
  text_ += text;
  return *this;
}

JsonWriter& JsonWriter::null() { return raw("null"); }

JsonWriter& JsonWriter::value(double number) { return std::isfinite(number) ? raw(exact_number(number)) : null(); }

JsonWriter& JsonWriter::value(std::string_view text) {
  separate();
  append_quoted(text_, text);
  return *this;
}

JsonWriter& JsonWriter::open(char bracket, bool flat) {
  const bool inside_flat = !levels_.empty() && levels_.back().flat;
  separate();
  text_ += bracket;
  levels_.push_back({flat || inside_flat});
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  const Level level = levels_.back();
  levels_.pop_back();
  if (!level.empty && !level.flat) new_line();
  text_ += bracket;
  return *this;
}

JsonWriter& JsonWriter::values(std::span<const double> numbers) {
  begin_list(true);
  for (const double number : numbers) value(number);
  return end_list();
}

JsonWriter& JsonWriter::values(const std::vector<std::string>& texts) {
  begin_list(true);
  for (const std::string& text : texts) value(text);
  return end_list();
}

std::string JsonWriter::take() {
  std::string text = std::move(text_);
  *this = JsonWriter();
  text += '\n';
  return text;
}

}  // namespace bramah
