// Where a rig's depth frames come from: a command, or a folder that something else fills.
#pragma once

#include <string>
#include <vector>

#include "data/base/config.h"
#include "data/depth_frame.h"

namespace sandwright {

struct CameraSource {
  std::string command;
  std::string folder;
  std::string unit = "mm";
  int64_t frames = 4;
  double timeout_s = 30;

  void Fields(FieldList& f) {
    f.Add("command", command,
          "run by sh for each scan; leaves its frames (.png or .npy, 16 bit) in the folder that "
          "$SANDWRIGHT_FRAMES names; empty: `folder` is watched");
    f.Add("folder", folder, "where a camera program of its own leaves frames; newer ones are taken");
    f.Add("unit", unit, "of the numbers in them", {"mm", "m", "0.1mm"});
    f.Add("frames", frames, "depth frames that one scan fuses", 1, 100);
    f.Add("timeout_s", timeout_s, "for all of them [s]", 0.1, 600);
  }
};

// Frames that were begun after the call, so that none shows the bed before the last stroke: `frames`
// of them. Throws Error where neither source is named, the command fails, or too few come in time.
std::vector<DepthFrame> TakeFrames(const CameraSource& source);

}  // namespace sandwright
