#include "data/base/progress.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cstdio>

namespace sandwright {

using Clock = std::chrono::steady_clock;

Progress::Progress(std::string label, int64_t total, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      total_(total),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      shown_(start_) {}

Progress::~Progress() {
  if (printed_) Print(true);
}

double Progress::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::Update(int64_t done, const std::string& note) {
  if (first_ < 0) first_ = done > 0 ? done - 1 : 0;  // a continued job starts above zero
  done_ = done;
  note_ = note;
  const double since_shown_s = std::chrono::duration<double>(Clock::now() - shown_).count();
  if (since_shown_s < (terminal_ ? 0.2 : 15.0)) return;
  Print(false);
}

void Progress::Print(bool last) {
  shown_ = Clock::now();
  printed_ = true;
  const double seconds = elapsed_s();
  const double rate = seconds > 0 ? static_cast<double>(done_ - first_) / seconds : 0;
  std::string line = fmt::format("{}: {}", label_, done_);
  if (total_ > 0) line += fmt::format("/{}", total_);
  line += fmt::format(" {}, {:.3g}/s", unit_, rate);
  if (!last && total_ > done_ && rate > 0)
    line += fmt::format(", {:.0f} s left", static_cast<double>(total_ - done_) / rate);
  if (!note_.empty()) line += ", " + note_;
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "", line, terminal_ && !last ? "" : "\n");
  std::fflush(stderr);
}

}  // namespace sandwright
