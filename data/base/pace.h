// How fast a job goes and how long it still takes.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace sandwright {

// Counts from its construction on.
class Pace {
 public:
  // `done` counts from the start of the whole job: a continued one starts above zero.
  void Update(int64_t done);
  int64_t done() const { return done_; }
  double elapsed_s() const;
  // What this part of the job did a second; 0 where nothing is known yet.
  double rate_per_s() const;
  // None where the end (`total` 0: unknown) or the rate is not known, and at the end.
  std::optional<double> left_s(int64_t total) const;

 private:
  int64_t done_ = 0, first_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace sandwright
