// Progress on stderr: one live line on a terminal, one line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace sandwright {

class Progress {
 public:
  // `unit` in the plural: "strokes". total 0: unknown.
  Progress(std::string label, int64_t total, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` counts from the start of the whole job; `note` is shown behind the rate.
  void Update(int64_t done, const std::string& note = "");
  double elapsed_s() const;

 private:
  void Print(bool last);

  std::string label_, unit_, note_;
  int64_t total_, done_ = 0, first_ = -1;
  bool terminal_, printed_ = false;
  std::chrono::steady_clock::time_point start_, shown_;
};

}  // namespace sandwright
