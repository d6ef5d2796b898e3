#include "io/json_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>

namespace bramah {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::optional<unsigned> hex4(std::string_view text) {
  unsigned code = 0;
  if (text.size() < 4) return std::nullopt;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + 4, code, 16);
  if (fault != std::errc{} || end != text.data() + 4) return std::nullopt;
  return code;
}

void append_utf8(std::string& text, unsigned code) {
  const auto put = [&](unsigned byte) { text += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | (code >> 6));
    put(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    put(0xE0 | (code >> 12));
    put(0x80 | ((code >> 6) & 0x3F));
    put(0x80 | (code & 0x3F));
  } else {
    put(0xF0 | (code >> 18));
    put(0x80 | ((code >> 12) & 0x3F));
    put(0x80 | ((code >> 6) & 0x3F));
    put(0x80 | (code & 0x3F));
  }
}

// Takes the digits of \uXXXX off `rest`, and those of the second half of a surrogate pair.
unsigned take_code(std::string_view& rest) {
  constexpr unsigned replacement = 0xFFFD;
  const std::optional<unsigned> high = hex4(rest);
  if (!high) return replacement;
  rest.remove_prefix(4);
  if (*high < 0xD800 || *high > 0xDFFF) return *high;
  const std::optional<unsigned> low = rest.starts_with("\\u") ? hex4(rest.substr(2)) : std::nullopt;
  if (*high > 0xDBFF || !low || *low < 0xDC00 || *low > 0xDFFF) return replacement;
  rest.remove_prefix(6);
  return 0x10000 + ((*high - 0xD800) << 10) + (*low - 0xDC00);
}

std::string decoded(std::string_view rest) {
  std::string text;
  while (!rest.empty()) {
    const std::size_t plain = std::min(rest.find('\\'), rest.size());
    text += rest.substr(0, plain);
    rest.remove_prefix(plain);
    if (rest.size() < 2) break;
    const char escape = rest[1];
    rest.remove_prefix(2);
    switch (escape) {
      case 'b': text += '\b'; break;
      case 'f': text += '\f'; break;
      case 'n': text += '\n'; break;
      case 'r': text += '\r'; break;
      case 't': text += '\t'; break;
      case 'u': append_utf8(text, take_code(rest)); break;
      default: text += escape;
    }
  }
  return text;
}

}  // namespace

JsonScanner::JsonScanner(std::string_view text) : text_(text) {
  if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
}

JsonScanner::Event JsonScanner::next() {
  for (;;) {
    skip_blanks();
    if (at_ >= text_.size()) return began(Event::end, text_.size(), text_.size());
    const std::size_t begin = at_;
    switch (text_[begin]) {
      case '{':
      case '[': {
        began(Event::open, begin, begin + 1);
        const bool is_object = text_[begin] == '{';
        open_.push_back({is_object, is_object, 0, begin});
        return Event::open;
      }
      case '}':
      case ']':
        if (!open_.empty()) open_.pop_back();
        return began(Event::close, begin, begin + 1);
      case ',':
        ++at_;
        if (!open_.empty()) {
          open_.back().at_key = open_.back().is_object;
          ++open_.back().index;
        }
        break;
      case ':':
        ++at_;
        if (!open_.empty()) open_.back().at_key = false;
        break;
      case '"': {
        const std::size_t end = end_of_text(begin);
        if (!in_object() || !open_.back().at_key) return began(Event::value, begin, end);
        open_.back().at_key = false;
        key_ = text_.substr(begin + 1, std::max(end, begin + 2) - begin - 2);
        key_begin_ = begin;
        return began(Event::key, begin, end);
      }
      default: return began(Event::value, begin, end_of_scalar(begin));
    }
  }
}

std::string JsonScanner::name() const { return named_by_index_ ? std::to_string(index_) : decoded(key_); }

JsonScanner::Event JsonScanner::began(Event event, std::size_t begin, std::size_t end) {
  begin_ = begin;
  at_ = end;
  named_by_index_ = !in_object();
  index_ = open_.empty() ? 0 : open_.back().index;
  if (named_by_index_) key_begin_ = begin;
  return event;
}

void JsonScanner::skip_blanks() {
  while (at_ < text_.size()) {
    const std::string_view rest = text_.substr(at_);
    if (rest[0] == ' ' || rest[0] == '\n' || rest[0] == '\r' || rest[0] == '\t') {
      ++at_;
    } else if (rest.starts_with("//")) {
      at_ = std::min(text_.find_first_of("\n\r", at_), text_.size());
    } else if (rest.starts_with("/*")) {
      const std::size_t close = text_.find("*/", at_ + 2);
      at_ = close == std::string_view::npos ? text_.size() : close + 2;
    } else {
      return;
    }
  }
}

// A text that is not closed ends with its line, so that one slip does not swallow the rest.
std::size_t JsonScanner::end_of_text(std::size_t quote) const {
  std::size_t i = quote + 1;
  for (; i < text_.size() && text_[i] != '\n'; ++i) {
    if (text_[i] == '"') return i + 1;
    if (text_[i] == '\\') ++i;
  }
  return std::min(i, text_.size());
}

std::size_t JsonScanner::end_of_scalar(std::size_t begin) const {
  const std::size_t end = text_.find_first_of(" \n\r\t,:{}[]\"/", begin);
  return std::max(std::min(end, text_.size()), begin + 1);
}

std::vector<Place> places(std::string_view text, const std::vector<std::size_t>& bytes) {
  std::vector<std::size_t> order(bytes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return bytes[a] < bytes[b]; });
  std::vector<Place> result(bytes.size());
  Place place;
  std::size_t at = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  for (const std::size_t i : order) {
    for (; at < std::min(bytes[i], text.size()); ++at) {
      if (text[at] == '\n') {
        ++place.line;
        place.column = 1;
      } else if ((static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U) {
        ++place.column;  // continuation bytes belong to the character before
      }
    }
    result[i] = place;
  }
  return result;
}

}  // namespace bramah
