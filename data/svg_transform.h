// Transforms and lengths of SVG attributes.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

namespace sandwright {

// The list in a `transform` attribute: translate, scale, rotate, matrix. Error naming `source` and the text.
Eigen::Affine2d ParseSvgTransform(const std::string& text, const std::string& source);

// A length with an absolute unit (mm, cm, in, pt, pc; px as 1/96 in) in mm; none for a bare number or a percentage.
std::optional<double> SvgLengthMm(const std::string& text);

}  // namespace sandwright
