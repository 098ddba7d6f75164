// Depth frames: what a depth camera delivers, before anything is known about the scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sandwright {

// Distances along the optical axis, row by row; 0 = no reading.
struct DepthFrame {
  int width = 0, height = 0;
  std::vector<float> depth_m;  // [height x width]

  float At(int u, int v) const {
    return depth_m[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)];
  }
};

// A 16-bit picture file or a u2 array in units of `unit` ("mm", "m" or "0.1mm"): .npy, .npz, .png.
// Throws Error naming the file where it is missing, foreign, cut off, not 16 bits or not of rank 2.
DepthFrame ReadDepthFrame(const std::filesystem::path& file, const std::string& unit = "mm");

// Writes millimetres as a 16-bit PNG or, by extension, as a u2 .npy array; whole or not at all.
void WriteDepthFrame(const DepthFrame& frame, const std::filesystem::path& file);

// One frame out of several of the same still scene: each pixel the median of its readings.
// Throws Error where sizes differ or there is none.
DepthFrame FuseFrames(std::span<const DepthFrame> frames);

}  // namespace sandwright
