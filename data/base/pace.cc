#include "data/base/pace.h"

namespace sandwright {

void Pace::Update(int64_t done) {
  if (first_ < 0) first_ = done > 0 ? done - 1 : 0;
  done_ = done;
}

double Pace::elapsed_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double Pace::rate_per_s() const {
  const double seconds = elapsed_s();
  return seconds > 0 && first_ >= 0 ? static_cast<double>(done_ - first_) / seconds : 0;
}

std::optional<double> Pace::left_s(int64_t total) const {
  const double rate = rate_per_s();
  if (total <= done_ || rate <= 0) return std::nullopt;
  return static_cast<double>(total - done_) / rate;
}

}  // namespace sandwright
