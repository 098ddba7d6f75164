// What a training run says about itself: progress.csv and TensorBoard scalars, the same numbers
// under the names that other trainers' dashboards know.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>

#include "data/base/tensorboard.h"

namespace sandwright {

class RunLog {
 public:
  // Rows of an earlier run that lie beyond `first_step` are dropped:
  // a resumed run writes them anew.
  RunLog(const std::filesystem::path& folder, int64_t first_step);
  void Write(int64_t step, const std::map<std::string, double>& scalars);
  void WritePicture(int64_t step, const std::string& tag, const cv::Mat& bgr);

 private:
  std::filesystem::path csv_;
  TensorboardWriter tensorboard_;
};

}  // namespace sandwright
