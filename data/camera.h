// The pinhole model of a depth camera with Brown's lens distortion (OpenCV's convention).
#pragma once

#include <cstdint>
#include <vector>

#include "data/base/config.h"

namespace sandwright {

// Frame C: z forward along the optical axis, x right, y down; pixel (u, v) has its centre at
// integer coordinates. Defaults: the nominal depth sensor of the Kinect v2.
struct CameraModel {
  int64_t width = 512;
  int64_t height = 424;
  double fx_px = 366, fy_px = 366;
  double cx_px = 256, cy_px = 212;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;

  void Fields(FieldList& f) {
    f.Add("width", width, "columns of a frame [px]", 8, 16384);
    f.Add("height", height, "rows of a frame [px]", 8, 16384);
    f.Add("fx_px", fx_px, "focal length along the rows [px]", 1, 1e6);
    f.Add("fy_px", fy_px, "focal length along the columns [px]", 1, 1e6);
    f.Add("cx_px", cx_px, "column of the optical axis [px]", -1e5, 1e5);
    f.Add("cy_px", cy_px, "row of the optical axis [px]", -1e5, 1e5);
    f.Add("k1", k1, "radial distortion, r^2 [-]", -10, 10);
    f.Add("k2", k2, "radial distortion, r^4 [-]", -10, 10);
    f.Add("p1", p1, "tangential distortion [-]", -1, 1);
    f.Add("p2", p2, "tangential distortion [-]", -1, 1);
    f.Add("k3", k3, "radial distortion, r^6 [-]", -10, 10);
  }
};

// Where a pixel looks: the point (x, y, 1) of its ray in C, so that depth z gives (x z, y z, z).
struct PixelRay {
  float x, y;
};

// The rays of all pixels, row by row, with the distortion taken out.
std::vector<PixelRay> PixelRays(const CameraModel& camera);

}  // namespace sandwright
