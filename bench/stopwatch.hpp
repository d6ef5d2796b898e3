// Wall and CPU time of a work, and the memory of this process.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace bramah::bench {

/// Of this thread: other work on the machine does not count.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Elapsed {
  double wall = 0.0, cpu = 0.0;  // s
};

template <class Work>
Elapsed elapsed(Work&& work) {
  const auto wall = std::chrono::steady_clock::now();
  const double cpu = cpu_seconds();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(), cpu_seconds() - cpu};
}

/// Medians of several runs, fewer of long ones. The first finds memory not yet touched and factors not yet made: it counts
/// only where it takes longer than `patience` and stays alone.
template <class Work>
Elapsed median_elapsed(Work&& work, double budget = 0.3) {
  constexpr std::size_t most = 51;
  constexpr double patience = 5.0;  // s
  const Elapsed first = elapsed(work);
  if (first.wall > patience) return first;
  std::vector<double> wall, cpu;
  for (double total = first.wall; wall.empty() || (total < budget && wall.size() < most);) {
    const Elapsed run = elapsed(work);
    wall.push_back(run.wall);
    cpu.push_back(run.cpu);
    total += run.wall;
  }
  const auto median = [](std::vector<double>& list) {
    const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
    std::nth_element(list.begin(), middle, list.end());
    return *middle;
  };
  return {median(wall), median(cpu)};
}

/// MB, of the whole process so far.
inline double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace bramah::bench
