#include "data/base/progress.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cstdio>

#include "data/base/run_status.h"

namespace sandwright {

using Clock = std::chrono::steady_clock;

Progress::Progress(std::string label, int64_t total, std::string unit, RunStatus* status)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      total_(total),
      status_(status),
      terminal_(::isatty(STDERR_FILENO) == 1),
      shown_(Clock::now()) {}

Progress::~Progress() {
  if (printed_) Print(true);
}

void Progress::Update(int64_t done, const std::string& note) {
  pace_.Update(done);
  note_ = note;
  if (status_) status_->Advance(done, total_, unit_, note);
  const double since_shown_s = std::chrono::duration<double>(Clock::now() - shown_).count();
  if (since_shown_s < (terminal_ ? 0.2 : 15.0)) return;
  Print(false);
}

void Progress::Print(bool last) {
  shown_ = Clock::now();
  printed_ = true;
  std::string line = fmt::format("{}: {}", label_, pace_.done());
  if (total_ > 0) line += fmt::format("/{}", total_);
  line += fmt::format(" {}, {:.3g}/s", unit_, pace_.rate_per_s());
  if (const auto left_s = pace_.left_s(total_); left_s && !last)
    line += fmt::format(", {:.0f} s left", *left_s);
  if (!note_.empty()) line += ", " + note_;
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "", line, terminal_ && !last ? "" : "\n");
  std::fflush(stderr);
}

}  // namespace sandwright
