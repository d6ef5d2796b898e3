// What is said when a library kills the process.
#pragma once

namespace bramah {

/// Installs handlers of SIGSEGV, SIGBUS, SIGFPE and SIGABRT, and of SIGINT and SIGTERM for calls that never end. They print
/// which entry of which library the thread was in, and let the process die of its signal.
void tell_of_crashes();

}  // namespace bramah
