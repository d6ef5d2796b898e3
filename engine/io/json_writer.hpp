// JSON text, written from front to back: numbers with 17 digits, which read back as the same double.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace bramah {

/// As printf's %.17g, whatever the locale.
std::string exact_number(double value);

/// Indented by two blanks; lists opened as `flat` stay on one line. NaN and infinity become null.
class JsonWriter {
 public:
  JsonWriter& begin_object() { return open('{', false); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_list(bool flat = false) { return open('[', flat); }
  JsonWriter& end_list() { return close(']'); }
  JsonWriter& begin_flat_object() { return open('{', true); }
  JsonWriter& key(std::string_view name);

  JsonWriter& value(double number);
  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& null();
  template <class T>
  requires std::is_integral_v<T> JsonWriter& value(T number) {
    if constexpr (std::is_same_v<T, bool>) {
      return raw(number ? "true" : "false");
    } else {
      return raw(std::to_string(number));
    }
  }
  JsonWriter& values(std::span<const double> numbers);
  JsonWriter& values(const std::vector<std::string>& texts);

  /// key and value in one.
  template <class T>
  JsonWriter& member(std::string_view name, const T& content) {
    return key(name).value(content);
  }

  /// The document, with a newline at its end; the writer begins anew.
  std::string take();

 private:
  struct Level {
    bool flat;
    bool empty = true;
  };
  JsonWriter& open(char bracket, bool flat);
  JsonWriter& close(char bracket);
  JsonWriter& raw(std::string_view text);
  void separate();
  void new_line();

  std::string text_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

}  // namespace bramah
