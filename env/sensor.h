// What lies between the sand and what an agent sees of it: the camera's and the scan's faults.
#pragma once

#include "data/base/config.h"
#include "data/base/random.h"
#include "data/height_map.h"

namespace sandwright {

// All off by default. docs/environment.md has what a Kinect v2 and `scan` leave.
struct SensorConfig {
  double noise_m = 0;
  double registration_m = 0;
  double offset_m = 0;
  double hole_share = 0;
  double hole_m = 0.02;
  double resolution_m = 0;

  void Fields(FieldList& f) {
    f.Add("noise_m", noise_m, "sd of the height of a cell, each by itself [m]", 0, 0.05);
    f.Add("registration_m", registration_m,
          "sd of how far a scan lies off along x and along y, all of its cells alike [m]", 0, 0.05);
    f.Add("offset_m", offset_m, "sd of a scan's zero: all of its heights alike [m]", 0, 0.05);
    f.Add("hole_share", hole_share,
          "share of the cells that no reading reaches: spanned from around them", 0, 0.5);
    f.Add("hole_m", hole_m, "diameter of such a hole [m]", 0.001, 0.5);
    f.Add("resolution_m", resolution_m, "heights are whole multiples of this [m]; 0: any", 0, 0.05);
  }
  // Shows the truth.
  bool perfect() const {
    return noise_m == 0 && registration_m == 0 && offset_m == 0 && hole_share == 0 &&
           resolution_m == 0;
  }
};

// One scan of `sand`, on its grid, drawn from `stream` (which is left alone where the sensor is perfect). Beyond a
// wall it sees the height at the wall.
HeightMap Sense(const HeightMap& sand, const SensorConfig& config, RandomStream& stream);

}  // namespace sandwright
