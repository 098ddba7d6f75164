// The `d` of an SVG path as lines.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace sandwright {

struct SvgLine {
  std::vector<Eigen::Vector2d> points;  // user units
  bool closed = false;
};

// All commands of SVG 1.1 (M L H V C S Q T A Z, absolute and relative); a curve becomes 32 pieces. Error naming
// `source` and the place where the text cannot be read.
std::vector<SvgLine> ParseSvgPath(const std::string& d, const std::string& source);

}  // namespace sandwright
