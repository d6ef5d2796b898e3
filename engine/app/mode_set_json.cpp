#include "app/mode_set_json.hpp"

#include <complex>
#include <vector>

#include "io/parse_json.hpp"

namespace bramah {
namespace {

using Complex = std::complex<double>;

template <class List>
std::vector<double> numbers_of(const List& list) {
  std::vector<double> numbers;
  numbers.reserve(2 * static_cast<std::size_t>(list.size()));
  for (const Complex value : list) {
    numbers.push_back(value.real());
    numbers.push_back(value.imag());
  }
  return numbers;
}

bool read_list(const Value& object, const char* key, std::vector<double>& list) {
  const Value* found = object.find(key);
  return found != nullptr && read_numbers(*found, list);
}

/// -1 where there is none.
Eigen::Index read_index(const Value& object, const char* key) {
  const Value* found = object.find(key);
  return found != nullptr && found->number() != nullptr ? static_cast<Eigen::Index>(*found->number()) : -1;
}

}  // namespace

void write_mode_set(JsonWriter& json, const ModeSet& set) {
  json.member("zeros", set.zeros).member("rows", set.right.rows());
  json.key("values").values(numbers_of(set.values)).key("error").values(set.error);
  json.key("right").values(numbers_of(set.right.reshaped())).key("left").values(numbers_of(set.left.reshaped()));
}

std::optional<ModeSet> read_mode_set(const Value& object) {
  const Eigen::Index rows = read_index(object, "rows");
  std::vector<double> values, right, left;
  ModeSet set;
  set.zeros = read_index(object, "zeros");
  if (!read_list(object, "values", values) || !read_list(object, "error", set.error) ||
      !read_list(object, "right", right) || !read_list(object, "left", left) || rows < 0 || set.zeros < 0)
    return std::nullopt;
  const auto modes = static_cast<Eigen::Index>(values.size() / 2);
  const std::size_t size = 2 * static_cast<std::size_t>(rows * modes);
  if (values.size() % 2 != 0 || right.size() != size || left.size() != size) return std::nullopt;
  const auto complex = [](const std::vector<double>& list) { return reinterpret_cast<const Complex*>(list.data()); };
  set.values.assign(complex(values), complex(values) + modes);
  set.right = Eigen::Map<const Eigen::MatrixXcd>(complex(right), rows, modes);
  set.left = Eigen::Map<const Eigen::MatrixXcd>(complex(left), rows, modes);
  return set;
}

}  // namespace bramah
