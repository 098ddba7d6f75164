// How the benchmarks of the environment take times.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace sandwright {

inline constexpr int kBenchRuns = 5;  // of which the median counts

inline double Now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Of an odd number of values.
inline double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace sandwright
