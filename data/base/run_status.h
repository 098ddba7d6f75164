// How a long run goes, for whoever looks at it from outside.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "data/base/pace.h"

namespace sandwright {

enum class RunState { kRunning, kDone, kStopped, kFailed, kRefused };

// "running", "done", "stopped", "failed", "refused".
const char* NameOf(RunState state);

// A picture that is drawn only when it is shown.
struct RunPicture {
  std::string caption;
  std::function<std::string()> png;
};

// What is known of a run at one moment.
struct RunReport {
  std::string command;
  RunState state = RunState::kRunning;
  std::string text;              // how it ended; empty while it runs
  std::string began, updated;    // UtcNow
  int64_t done = 0, total = 0;   // total 0: unknown
  std::string unit, note;        // unit in the plural
  double rate_per_s = 0;
  std::optional<double> left_s;
  double longest_silence_s = 0;  // between two updates so far
  nlohmann::json figures = nlohmann::json::object();  // the last ones, units in their names
  std::string last_warning, last_warning_time;        // empty: none
  std::vector<RunPicture> pictures;                   // the last ones

  nlohmann::json ToJson() const;  // without the pictures
};

// Safe to use from several threads.
class RunStatus {
 public:
  using Publish = std::function<void(const RunReport&)>;
  // `publish` is called at the first step, then at most every other second, and at the end; what
  // it cannot write is a warning, never the end of a run.
  RunStatus(std::string command, Publish publish);

  // The last figures, added to those before, and the last pictures: shown with the next step.
  void Figures(const nlohmann::json& figures);
  void Show(std::vector<RunPicture> pictures);
  void Warn(const std::string& text);
  // A step of the job; see Progress::Update.
  void Advance(int64_t done, int64_t total, const std::string& unit, const std::string& note = "");
  // Publishes the end of a run that had begun; one without a step leaves no trace.
  void End(RunState state, const std::string& text);

 private:
  void PublishNow(const RunReport& report);

  Publish publish_;
  std::mutex mutex_;
  RunReport report_;
  Pace pace_;
  std::optional<std::chrono::steady_clock::time_point> advanced_, published_;
  bool failed_ = false;  // to publish: said once
};

}  // namespace sandwright
