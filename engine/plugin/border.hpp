// The calls into libraries: which entry of which instance a thread is in, and why an entry failed.
#pragma once

#include <string>

#include "bramah/abi.h"
#include "plugin/registry.hpp"

namespace bramah {

/// What this thread has asked a library for; plain pointers, for a signal handler to read.
struct BorderCall {
  const char* entry = nullptr;  // "evaluate"
  const char* component = "";   // name in the scene, of the first of several instances; of a library: its file
  const bramah_type* type = nullptr;
  long long instances = 1;
};

/// The call that this thread is in; entry is null outside of all libraries.
inline BorderCall& border_call() {
  static thread_local BorderCall call;
  return call;
}

/// Marks a call for as long as it lasts.
class AtBorder {
 public:
  AtBorder(const char* entry, const char* component, const bramah_type& type, long long instances = 1)
      : before_(border_call()) {
    border_call() = {entry, component, &type, instances};
  }
  ~AtBorder() { border_call() = before_; }
  AtBorder(const AtBorder&) = delete;
  AtBorder& operator=(const AtBorder&) = delete;

 private:
  BorderCall before_;
};

/// The text of the last exception behind an entry of `type` in this thread, which is forgotten; "" where none is known.
inline std::string take_fault(const bramah_type& type) {
  const auto* fault = extension<bramah_fault>(type, BRAMAH_EXTENSION_FAULT);
  const char* text = fault == nullptr || fault->take == nullptr ? nullptr : fault->take(type.self);
  return text == nullptr ? "" : text;
}

/// The file that the code of `type` is in; null where it is unknown. Serves a signal handler: it reads tables that stand
/// still.
const char* file_of(const bramah_type& type);

}  // namespace bramah
