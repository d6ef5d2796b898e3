// Two looks at the text: the parser builds the value and stops at the first error of syntax; only if something is wrong
// the scanner goes over it again for positions and repeated keys.
#include "io/parse_json.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "io/json_scanner.hpp"

namespace bramah {

namespace {

constexpr std::size_t kDeepest = 64;
constexpr std::size_t kMostOverflows = 16;  // each costs a reading of the text

Diagnostic at_byte(std::size_t byte, Diagnostic diagnostic) {
  diagnostic.byte = static_cast<long long>(byte);
  return diagnostic;
}

// ---- text to Value ----

bool has_repeated_key(const Value::Object& members) {
  constexpr std::size_t few = 16;  // up to here comparing each with each beats sorting
  if (members.size() <= few) {
    for (auto i = members.begin(); i != members.end(); ++i) {
      if (std::any_of(members.begin(), i, [&](const Member& m) { return m.key == i->key; })) return true;
    }
    return false;
  }
  std::vector<std::string_view> keys;
  keys.reserve(members.size());
  for (const Member& member : members) keys.push_back(member.key);
  std::sort(keys.begin(), keys.end());
  return std::adjacent_find(keys.begin(), keys.end()) != keys.end();
}

/// Receives the parser's events. A callback that returns false stops the parser.
class SceneBuilder {
 public:
  enum class Stop { none, syntax, overflow, depth };

  explicit SceneBuilder(Value& root) : root_(root) { open_.reserve(kDeepest); }

  [[nodiscard]] Stop stop() const { return stop_; }
  [[nodiscard]] std::size_t last_byte() const { return last_byte_; }  // of the token at which the parser stopped
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] bool has_repeated_keys() const { return has_repeated_keys_; }
  [[nodiscard]] bool is_complete() const { return has_root_ && open_.empty(); }

  bool null() { return add({}); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) { return add(static_cast<double>(value)); }
  bool number_float(double value, const std::string& /*as_written*/) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  static bool binary(nlohmann::json::binary_t& /*no such thing in text*/) { return false; }
  bool start_object(std::size_t /*unknown*/) { return open(Value::Object{}); }
  bool start_array(std::size_t /*unknown*/) { return open(Value::List{}); }
  bool end_array() { return close(); }

  bool key(std::string& key) {
    open_.back()->object()->push_back({std::move(key), Value{}});
    return true;
  }

  bool end_object() {
    has_repeated_keys_ = has_repeated_keys_ || has_repeated_key(*open_.back()->object());
    return close();
  }

  bool parse_error(std::size_t position, const std::string& /*token*/, const nlohmann::json::exception& error) {
    constexpr int number_overflow = 406;
    stop_ = error.id == number_overflow ? Stop::overflow : Stop::syntax;
    last_byte_ = position > 0 ? position - 1 : 0;
    message_ = error.what();
    return false;
  }

 private:
  // Containers do not move while one of their elements is open, so pointers to the open ones stay valid.
  Value& place_for_next() {
    has_root_ = true;
    if (open_.empty()) return root_;
    if (Value::Object* members = open_.back()->object()) return members->back().value;
    return std::get<Value::List>(open_.back()->data).emplace_back();
  }

  bool add(Value value) {
    place_for_next() = std::move(value);
    return true;
  }

  bool open(Value container) {
    if (open_.size() == kDeepest) {
      stop_ = Stop::depth;
      return false;
    }
    Value& place = place_for_next();
    place = std::move(container);
    open_.push_back(&place);
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  Value& root_;
  std::vector<Value*> open_;
  bool has_root_ = false;
  bool has_repeated_keys_ = false;
  Stop stop_ = Stop::none;
  std::size_t last_byte_ = 0;
  std::string message_;
};

// ---- places of faults in the text ----

struct Token {
  std::size_t begin;
  std::size_t end;
};

// The token around `byte`; a single character where the scanner sees none.
Token token_at(std::string_view text, std::size_t byte) {
  JsonScanner scanner(text);
  while (scanner.next() != JsonScanner::Event::end && scanner.begin() <= byte) {
    if (byte < scanner.end()) return {scanner.begin(), scanner.end()};
  }
  return {std::min(byte, text.size()), std::min(byte + 1, text.size())};
}

std::size_t line_of(std::string_view text, std::size_t byte) { return places(text, {byte}).front().line; }

std::size_t byte_of_depth(std::string_view text, std::size_t depth) {
  JsonScanner scanner(text);
  while (scanner.depth() < depth && scanner.next() != JsonScanner::Event::end) {
  }
  return scanner.begin();
}

// Every key that its object already has, as far as the text was read.
void report_repeated_keys(std::string_view text, std::size_t stop, Faults& faults) {
  struct Repeated {
    std::string key;
    std::size_t first;
    std::size_t again;
  };
  std::vector<Repeated> repeated;
  std::vector<std::unordered_map<std::string, std::size_t>> seen;  // per open container
  JsonScanner scanner(text);
  for (auto event = scanner.next(); event != JsonScanner::Event::end && scanner.end() <= stop; event = scanner.next()) {
    if (event == JsonScanner::Event::key) {
      const auto [entry, is_new] = seen.back().try_emplace(scanner.name(), scanner.begin());
      if (!is_new) repeated.push_back({entry->first, entry->second, scanner.begin()});
    } else {
      seen.resize(scanner.depth());
    }
  }
  std::vector<std::size_t> firsts;
  firsts.reserve(repeated.size());
  for (const Repeated& r : repeated) firsts.push_back(r.first);
  const std::vector<Place> first_places = places(text, firsts);
  for (std::size_t i = 0; i < repeated.size(); ++i) {
    faults.push_back(at_byte(
        repeated[i].again,
        fault("duplicate-key", "key " + in_quotes(repeated[i].key) + " written twice", "each key once in an object",
              "rename or remove one; the first is in line " + std::to_string(first_places[i].line))));
  }
}

// ---- errors of syntax ----

// What the parser says, taken apart: "... syntax error while parsing CONTEXT - REASON; expected ...".
struct Complaint {
  std::string context;
  std::string reason;
  bool is_unexpected_token = false;
};

Complaint take_apart(const std::string& message) {
  constexpr std::string_view before_context = "while parsing ";
  constexpr std::string_view before_reason = " - ";
  const std::size_t context = message.find(before_context);
  const std::size_t dash = context == std::string::npos ? context : message.find(before_reason, context);
  if (dash == std::string::npos) return {"value", message, false};
  Complaint complaint;
  const std::size_t begin = context + before_context.size();
  complaint.context = message.substr(begin, dash - begin);
  complaint.reason = message.substr(dash + before_reason.size());
  complaint.is_unexpected_token = complaint.reason.starts_with("unexpected ");
  // What was last read may be long and is in the user's file anyway.
  complaint.reason.resize(std::min(
      complaint.reason.find(complaint.is_unexpected_token ? "; expected " : "; last read: "), complaint.reason.size()));
  return complaint;
}

std::string expectation(const std::string& context, bool is_complete) {
  if (is_complete) return "nothing after the end of the scene";
  if (context == "object key") return "a key in double quotes";
  if (context == "object separator") return "a colon after the key";
  if (context == "object") return "a comma or \"}\"";
  if (context == "array") return "a comma or \"]\"";
  return "a value: text in double quotes, number, true, false, null, list or object";
}

bool follows_comma(std::string_view text, std::size_t byte) {
  const std::size_t before = text.substr(0, byte).find_last_not_of(" \t\r\n");
  return before != std::string_view::npos && text[before] == ',';
}

std::string syntax_remedy(const Complaint& complaint, bool is_after_comma, bool is_complete) {
  const auto says = [&](std::string_view words) { return complaint.reason.find(words) != std::string::npos; };
  if (says("unexpected '}'") || says("unexpected ']'")) {
    return is_after_comma ? "remove the comma before it" : "complete what stands before it, or remove it";
  }
  if (says("end of input")) return "close what is still open; the end of the file may be lost";
  if (says("U+000A") || says("U+000D") || says("closing quote"))
    return "close the text with a double quote on its line";
  if (says("control character")) return "write it as an escape like \\t";
  if (says("backslash")) return "write a backslash as \\\\";
  if (says("\\u") || says("surrogate")) return "write the character itself";
  if (says("invalid number")) return "write numbers like 0.5 or -1.5e3";
  if (says("comment")) return "comments are // to the end of the line, or /* ... */";
  if (is_complete) return "remove it; the scene has ended before it";
  if (complaint.context == "object key") return "put the key in double quotes";
  if (complaint.context == "object separator") return "write \"key\": value";
  const bool is_between = complaint.context == "object" || complaint.context == "array";
  if (is_between && complaint.is_unexpected_token) return "put a comma before it";
  return "put texts in double quotes; the only bare words are true, false and null";
}

// What the text ends in the middle of, when it ends too soon.
std::string unclosed(std::string_view text) {
  JsonScanner scanner(text);
  while (scanner.next() != JsonScanner::Event::end) {
  }
  if (scanner.depth() == 0) return {};
  return std::string(" in the ") + (scanner.innermost_is_object() ? "object" : "list") + " that begins in line " +
         std::to_string(line_of(text, scanner.innermost()));
}

Diagnostic syntax_fault(std::string_view text, const SceneBuilder& builder) {
  const std::size_t byte = std::min(builder.last_byte(), text.size());
  Complaint complaint = take_apart(builder.message());
  if (complaint.reason.find("UTF-8") != std::string::npos) {
    return at_byte(byte, fault("not-utf8", "a byte that is not UTF-8", "text encoded as UTF-8",
                               "save the file as UTF-8, or write the character as \\uXXXX"));
  }
  const bool ends_too_soon = complaint.is_unexpected_token && byte == text.size();
  if (ends_too_soon && JsonScanner(text).next() == JsonScanner::Event::end) {
    return fault("empty-file", "no scene, the text is empty", "an object", "begin with { \"bramah\": 1 }");
  }
  const std::size_t begin = complaint.is_unexpected_token ? token_at(text, byte).begin : byte;
  std::string found = complaint.reason + (ends_too_soon ? unclosed(text) : "");
  return at_byte(begin, fault("syntax", std::move(found), expectation(complaint.context, builder.is_complete()),
                              syntax_remedy(complaint, follows_comma(text, begin), builder.is_complete())));
}

Diagnostic overflow_fault(std::string_view text, const Token& number) {
  constexpr std::size_t longest = 40;
  std::string digits(text.substr(number.begin, std::min(number.end - number.begin, longest)));
  if (number.end - number.begin > longest) digits += "...";
  return at_byte(number.begin, fault("number-out-of-range", "number " + digits + " is out of range",
                                     "a number between -1.79e308 and 1.79e308", "check the exponent"));
}

}  // namespace

bool parse_json(std::string_view text, Value& root, Faults& faults) {
  // The parser takes a zero byte for the end and would not look at the rest.
  const std::size_t zero = text.find('\0');
  if (zero != std::string_view::npos) {
    faults.push_back(at_byte(zero, fault("syntax", "a zero byte", "JSON text encoded as UTF-8",
                                         "save the file as UTF-8; it may be UTF-16 or no text at all")));
    return false;
  }
  std::string mended;  // a copy in which numbers out of range are 0: the parser cannot go on after one
  std::string_view readable = text;
  for (;;) {
    root = Value{};
    SceneBuilder builder(root);
    nlohmann::json::sax_parse(readable.begin(), readable.end(), &builder, nlohmann::json::input_format_t::json,
                              /*strict=*/true, /*ignore_comments=*/true);
    std::size_t stop = text.size();
    if (builder.stop() == SceneBuilder::Stop::overflow) {
      const Token number = token_at(readable, builder.last_byte());
      faults.push_back(overflow_fault(text, number));
      if (faults.size() < kMostOverflows) {
        if (mended.empty()) mended = text;
        std::fill_n(mended.begin() + static_cast<std::ptrdiff_t>(number.begin), number.end - number.begin, ' ');
        mended[number.begin] = '0';
        readable = mended;
        continue;
      }
      stop = number.begin;
    } else if (builder.stop() == SceneBuilder::Stop::depth) {
      stop = byte_of_depth(text, kDeepest + 1);
      faults.push_back(at_byte(stop, fault("too-deep", "lists and objects nested too deep",
                                           "at most " + std::to_string(kDeepest) + " levels", "flatten the scene")));
    } else if (builder.stop() == SceneBuilder::Stop::syntax) {
      stop = std::min(builder.last_byte(), text.size());
      faults.push_back(syntax_fault(text, builder));
    }
    const bool is_whole = builder.stop() == SceneBuilder::Stop::none;
    if (builder.has_repeated_keys() || !is_whole) report_repeated_keys(text, stop, faults);
    return is_whole;
  }
}

bool read_numbers(const Value& list, std::vector<double>& numbers) {
  if (list.list() == nullptr) return false;
  for (const Value& item : *list.list()) {
    if (item.number() == nullptr) return false;
    numbers.push_back(*item.number());
  }
  return true;
}

}  // namespace bramah
