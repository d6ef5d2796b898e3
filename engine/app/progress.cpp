#include "app/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <string_view>
#include <utility>

#include "app/context.hpp"
#include "app/failure.hpp"
#include "io/tables.hpp"

namespace bramah {
namespace {

constexpr std::chrono::milliseconds kPatience(300), kInterval(100);
constexpr int kBarWidth = 30;

std::atomic<bool> interrupt_seen = false;  // a signal handler reaches nothing else
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr std::array interrupts = {SIGINT, SIGTERM, SIGHUP};

/// Read by handlers: set before these are, cleared after.
std::string_view words_at_the_end;

void note_interrupt(int) {
  interrupt_seen = true;
  if (!words_at_the_end.empty()) alarm(1);
}

void end_now(int) {
  if (write(STDERR_FILENO, words_at_the_end.data(), words_at_the_end.size()) < 0) _exit(exit_interrupted);
  _exit(exit_interrupted);
}

}  // namespace

Progress::Progress(std::string label, bool allowed)
    : label_(std::move(label)), enabled_(allowed && isatty(STDERR_FILENO) == 1), begin_(Clock::now()), last_(begin_) {}

void Progress::show(double share, const std::string& words) {
  if (!enabled_) return;
  const Clock::time_point now = Clock::now();
  if (now - begin_ < kPatience || now - last_ < kInterval) return;
  last_ = now;
  shown_ = true;
  share = std::clamp(share, 0.0, 1.0);
  const int full = static_cast<int>(share * kBarWidth);
  std::string line = "\r" + label_ + " [";
  for (int k = 0; k < kBarWidth; ++k) line += k < full ? '=' : ' ';
  line += "] " + std::to_string(static_cast<int>(100.0 * share)) + " %";
  if (!words.empty()) line += "  " + words;
  const double elapsed = std::chrono::duration<double>(now - begin_).count();
  if (share > 0.01) line += "  " + duration(elapsed * (1.0 - share) / share) + " left";
  say(line + "\x1b[K");
}

void Progress::clear() {
  if (shown_) say("\r\x1b[K");
  shown_ = false;
}

InterruptGuard::InterruptGuard(std::string last_words) : last_words_(std::move(last_words)) {
  interrupt_seen = false;
  words_at_the_end = last_words_;
  if (!last_words_.empty()) std::signal(SIGALRM, end_now);
  struct sigaction action = {};
  action.sa_handler = note_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (std::size_t k = 0; k < before_.size(); ++k) sigaction(interrupts[k], &action, &before_[k]);
}

InterruptGuard::~InterruptGuard() {
  for (std::size_t k = 0; k < before_.size(); ++k) sigaction(interrupts[k], &before_[k], nullptr);
  alarm(0);
  if (!last_words_.empty()) std::signal(SIGALRM, SIG_DFL);
  words_at_the_end = {};
}

bool InterruptGuard::interrupted() { return interrupt_seen; }

}  // namespace bramah
