#include "data/base/run_status.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>

#include "data/base/utc_time.h"

namespace sandwright {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kInterval{2};  // between two publications

const char* NameOf(RunState state) {
  switch (state) {
    case RunState::kRunning: return "running";
    case RunState::kDone: return "done";
    case RunState::kStopped: return "stopped";
    case RunState::kFailed: return "failed";
    case RunState::kRefused: return "refused";
  }
  return "";
}

nlohmann::json RunReport::ToJson() const {
  return {{"command", command},
          {"state", NameOf(state)},
          {"text", text},
          {"pid", ::getpid()},
          {"began", began},
          {"updated", updated},
          {"done", done},
          {"total", total},
          {"unit", unit},
          {"note", note},
          {"rate_per_s", rate_per_s},
          {"left_s", left_s ? nlohmann::json(*left_s) : nlohmann::json()},
          {"longest_silence_s", longest_silence_s},
          {"figures", figures},
          {"last_warning", last_warning},
          {"last_warning_time", last_warning_time}};
}

RunStatus::RunStatus(std::string command, Publish publish) : publish_(std::move(publish)) {
  report_.command = std::move(command);
  report_.began = UtcNow();
}

void RunStatus::Figures(const nlohmann::json& figures) {
  const std::lock_guard lock(mutex_);
  report_.figures.update(figures);
}

void RunStatus::Show(std::vector<RunPicture> pictures) {
  const std::lock_guard lock(mutex_);
  report_.pictures = std::move(pictures);
}

// It only takes note: a warning that nothing can be published must not publish.
void RunStatus::Warn(const std::string& text) {
  const std::lock_guard lock(mutex_);
  report_.last_warning = text;
  report_.last_warning_time = UtcNow();
}

void RunStatus::Advance(int64_t done, int64_t total, const std::string& unit,
                        const std::string& note) {
  RunReport now;
  {
    const std::lock_guard lock(mutex_);
    const auto time = Clock::now();
    pace_.Update(done);
    report_.done = done;
    report_.total = total;
    report_.unit = unit;
    report_.note = note;
    if (advanced_)
      report_.longest_silence_s = std::max(
          report_.longest_silence_s, std::chrono::duration<double>(time - *advanced_).count());
    advanced_ = time;
    if (published_ && time - *published_ < kInterval) return;
    published_ = time;
    report_.rate_per_s = pace_.rate_per_s();
    report_.left_s = pace_.left_s(total);
    report_.updated = UtcNow();
    now = report_;
  }
  PublishNow(now);
}

void RunStatus::End(RunState state, const std::string& text) {
  RunReport now;
  {
    const std::lock_guard lock(mutex_);
    if (!published_) return;
    report_.state = state;
    report_.text = text;
    report_.rate_per_s = pace_.rate_per_s();
    report_.left_s.reset();
    report_.updated = UtcNow();
    now = report_;
  }
  PublishNow(now);
}

void RunStatus::PublishNow(const RunReport& report) {
  try {
    publish_(report);
  } catch (const std::exception& e) {
    const bool said = std::exchange(failed_, true);
    if (!said) spdlog::warn("the state of the run cannot be shown: {}", e.what());
  }
}

}  // namespace sandwright
