// A walk over JSON text that knows where everything stands. The parser keeps no positions: faults are rare, so their
// places are found by a second look. Understands comments and a byte order mark, goes on over broken text, never throws.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/read_scene.hpp"

namespace bramah {

class JsonScanner {
 public:
  enum class Event {
    key,    // of a member of an object
    value,  // text, number, true, false, null, or anything that stands in their place
    open,   // { or [
    close,  // } or ]
    end,    // of the text
  };

  explicit JsonScanner(std::string_view text);
  Event next();

  // Of the last event:
  [[nodiscard]] std::size_t begin() const { return begin_; }          // its first byte
  [[nodiscard]] std::size_t end() const { return at_; }               // the byte after it
  [[nodiscard]] std::size_t key_begin() const { return key_begin_; }  // of its key; `begin()` where it has none
  [[nodiscard]] std::string name() const;  // its key, escapes decoded, or its index in a list

  /// The containers open at the place reached: how many, and the innermost, where there is one.
  [[nodiscard]] std::size_t depth() const { return open_.size(); }
  [[nodiscard]] std::size_t innermost() const { return open_.back().begin; }
  [[nodiscard]] bool innermost_is_object() const { return open_.back().is_object; }

 private:
  struct Container {
    bool is_object;
    bool at_key;        // the next text is a key
    std::size_t index;  // of the element reached, for lists
    std::size_t begin;
  };
  [[nodiscard]] bool in_object() const { return !open_.empty() && open_.back().is_object; }
  Event began(Event event, std::size_t begin, std::size_t end);
  void skip_blanks();
  [[nodiscard]] std::size_t end_of_text(std::size_t quote) const;
  [[nodiscard]] std::size_t end_of_scalar(std::size_t begin) const;

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t begin_ = 0;
  std::size_t key_begin_ = 0;
  std::string_view key_;  // between its quotes, as written
  bool named_by_index_ = false;
  std::size_t index_ = 0;
  std::vector<Container> open_;
};

/// Line and column of each byte, in the order given; bytes behind the end stand at the end.
std::vector<Place> places(std::string_view text, const std::vector<std::size_t>& bytes);

}  // namespace bramah
