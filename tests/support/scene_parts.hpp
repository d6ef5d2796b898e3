// What scenes made in code are put together from.
#pragma once

#include <cstdio>
#include <initializer_list>
#include <string>
#include <utility>

#include "system/scene.hpp"

namespace bramah::support {

/// All digits of a double.
inline std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

inline std::string numbered(const char* name, int i) { return name + std::to_string(i); }

inline Value list(std::initializer_list<double> numbers) {
  Value::List values;
  for (const double number : numbers) values.emplace_back(number);
  return values;
}
inline Value names(std::initializer_list<const char*> texts) {
  Value::List values;
  for (const char* text : texts) values.emplace_back(text);
  return values;
}

inline Scene scene_of(std::string title, Value libraries, Value::Object components) {
  Scene scene;
  scene.root = Value::Object{{"bramah", 1},
                             {"title", std::move(title)},
                             {"libraries", std::move(libraries)},
                             {"components", std::move(components)}};
  return scene;
}

}  // namespace bramah::support
