#include "app/crash.hpp"

#include <unistd.h>

#include <csignal>
#include <cstring>

#include "plugin/border.hpp"

namespace bramah {
namespace {

void put(const char* text) {
  if (text != nullptr && write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

const char* name_of(int signal) {
  switch (signal) {
    case SIGSEGV: return "SIGSEGV";
    case SIGBUS: return "SIGBUS";
    case SIGFPE: return "SIGFPE";
    case SIGINT: return "SIGINT";
    case SIGTERM: return "SIGTERM";
    default: return "SIGABRT";
  }
}

void tell(int signal) {
  const BorderCall& call = border_call();
  if (call.entry != nullptr) {
    put("\nerror: ");
    put(name_of(signal));
    put(" in ");
    put(call.entry);
    put(" of ");
    put(call.component);
    if (call.type != nullptr) {
      if (call.instances > 1) put(" and others");
      put(" (");
      put(call.type->name);
      put(")");
      put(", ");
      put(file_of(*call.type));
    }
    put(signal == SIGINT || signal == SIGTERM ? "\n  to do     mend the library, if this call never ends\n"
                                              : "\n  to do     mend the library; a debugger shows the line\n");
  }
  raise(signal);  // the handler is gone: SA_RESETHAND
}

}  // namespace

void tell_of_crashes() {
  struct sigaction action = {};
  action.sa_handler = tell;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

}  // namespace bramah
