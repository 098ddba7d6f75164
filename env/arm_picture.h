// A picture of the arm over the box with the sand in it, drawn by MuJoCo without a screen (EGL).
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "data/height_map.h"
#include "robot_model/workcell.h"

namespace sandwright {

// Holds a drawing context: use it on the thread that made it. Throws Error with the reason where
// the machine offers no EGL; callers then leave the picture out with a word.
class ArmPicture {
 public:
  ArmPicture(const Workcell& workcell, const HeightMap& terrain, int width_px = 960,
             int height_px = 640);
  ~ArmPicture();
  ArmPicture(const ArmPicture&) = delete;
  ArmPicture& operator=(const ArmPicture&) = delete;

  // BGR, height x width.
  cv::Mat Draw(const JointAngles& q);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandwright
