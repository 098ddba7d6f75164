// Progress on stderr: one live line on a terminal, one line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "data/base/pace.h"

namespace sandwright {

class RunStatus;

class Progress {
 public:
  // `unit` in the plural: "strokes". total 0: unknown. `status` (none: nobody watches) is told too.
  Progress(std::string label, int64_t total, std::string unit, RunStatus* status = nullptr);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` counts from the start of the whole job; `note` is shown behind the rate.
  void Update(int64_t done, const std::string& note = "");
  double elapsed_s() const { return pace_.elapsed_s(); }

 private:
  void Print(bool last);

  std::string label_, unit_, note_;
  int64_t total_;
  RunStatus* status_;
  bool terminal_, printed_ = false;
  Pace pace_;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace sandwright
