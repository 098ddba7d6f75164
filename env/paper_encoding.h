// The pictures of Deep Sandscapes (Tsuruta, Griffioen, Medina, Johns, ANNSIM 2022): a crop around
// one stroke, turned with it, in 8 bits.
//
// A picture is 256 x 256 pixels of 1 mm, centred on the middle between the first and the last point
// of the path and turned so that the way from one to the other runs from top to bottom. A path that
// ends where it began keeps its last direction as the way down. Seen from above, so the left of the
// stroke is the right of the picture. Pixels beyond the walls show the height at the wall.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

inline constexpr int kPaperPixels = 256;
inline constexpr int kPaperCount = kPaperPixels * kPaperPixels;
inline constexpr double kPaperPixel_m = 0.001;
inline constexpr double kPaperRange_m = 0.150;  // of the 8 bits
inline constexpr double kPaperLevel_m = kPaperRange_m / 255;

using PaperPlane = std::vector<uint8_t>;  // [kPaperPixels, kPaperPixels], row-major, row 0 on top

// Where a picture lies on the box.
struct PaperFrame {
  explicit PaperFrame(const ToolPath& path);
  // Place in B [m] of a place in the picture [pixels]: rows down, columns to the right; the centre
  // of the first pixel is (0.5, 0.5).
  Eigen::Vector2d ToBox(double row, double column) const;
  // The inverse: (row, column).
  Eigen::Vector2d ToPicture(double x_m, double y_m) const;

  Eigen::Vector2d middle_m;  // of the picture, in B
  Eigen::Vector2d down;      // unit vector of its columns' way down, in B
};

// Whether a place in B lies inside the walls of `map`.
bool InsideWalls(const HeightMap& map, const Eigen::Vector2d& p_m);

// The nearest of the 256 levels of a height above the picture's zero; clamped to 0-150 mm.
uint8_t PaperLevel(double height_m);

// What pix2pix sees of a stroke.
struct PaperInput {
  PaperFrame frame;
  double zero_m = 0;  // height above the floor of level 0
  PaperPlane height;  // R: the terrain before
  PaperPlane path;    // G: 255 where the blade's edge passes, 0 elsewhere
  PaperPlane depth;   // B: how far below the terrain it passes at its lowest, 0 where it does not
  PaperPlane counts;  // 1: inside the box and seen by the camera; not part of the picture
};

// The blade passes a pixel when its footprint, grown by half a pixel, holds the pixel's centre.
// Zero is the lowest point of the crop before the stroke, the blade's way included: a furrow in
// level sand would otherwise lie below zero. None where the picture lies outside the box.
std::optional<PaperInput> EncodePaperInput(const HeightMap& before, const ToolPath& path,
                                           const Blade& blade);

// The terrain `map` in the frame and above the zero of `input`.
PaperPlane EncodePaperHeight(const HeightMap& map, const PaperInput& input);

// Adds what `predicted` changes against `input.height` to the cells of `map` whose centres lie in
// the picture: means of bilinear samples as dense as the pixels. Others stay as they are. No cell
// that was above the floor goes below it (a map whose datum is relative has none). Returns the
// bounds of the cells that the picture holds.
CellRect PastePaperChange(const PaperInput& input, const PaperPlane& predicted, HeightMap& map);

// One training pair as pix2pix data sets keep it: a PNG of 512 x 256 pixels, input on the left (R,
// G, B as above), the terrain after the stroke on the right (grey).
void WritePaperPair(const PaperInput& input, const PaperPlane& after,
                    const std::filesystem::path& file);

}  // namespace sandwright
