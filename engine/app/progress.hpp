// A bar on standard error for work that lasts, and Ctrl-C as a question rather than an end.
#pragma once

#include <array>
#include <chrono>
#include <csignal>
#include <string>

namespace bramah {

/// Shows nothing where standard error is no terminal, where standard output would be mixed with it, or when the work is
/// done within 0.3 s.
class Progress {
 public:
  explicit Progress(std::string label, bool allowed = true);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// `share` of the work done, 0 ... 1, and a few words about where it stands.
  void show(double share, const std::string& words);
  /// Takes the bar off the screen.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool enabled_, shown_ = false;
  Clock::time_point begin_, last_;
};

/// While it lives, the first Ctrl-C, SIGTERM or SIGHUP is noted and the second one ends the program.
class InterruptGuard {
 public:
  InterruptGuard() : InterruptGuard("") {}
  /// With `last_words` the program says them and ends a second after the signal, whatever it is computing: for work whose
  /// results so far are in a file. No words: it waits for the work.
  explicit InterruptGuard(std::string last_words);
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  ~InterruptGuard();
  [[nodiscard]] static bool interrupted();

 private:
  std::string last_words_;
  std::array<struct sigaction, 3> before_{};
};

}  // namespace bramah
