#include "data/stroke_drawing.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/atomic_file.h"

namespace sandwright {
namespace {

constexpr double kStep_m = 0.002;

// What the drawing of a stroke goes through: its corners, or its curve in steps [m].
std::vector<Eigen::Vector3d> Line(const Stroke& stroke) {
  if (stroke.degree == 1 || stroke.control_points_m.size() == 2) return stroke.control_points_m;
  std::vector<Eigen::Vector3d> line;
  for (const BladePose& pose : SamplePath(stroke, kStep_m)) line.emplace_back(pose.x_m, pose.y_m, pose.z_m);
  return line;
}

std::string SvgPath(const Stroke& stroke) {
  const auto& points = stroke.control_points_m;
  const bool curve = stroke.degree == 2 && points.size() > 2;
  std::string path;
  for (size_t i = 0; i < points.size(); ++i) {
    const char* command = i == 0 ? "M" : i == 1 && curve ? (points.size() == 3 ? " Q" : " C") : curve ? " " : " L";
    path += fmt::format("{}{:.4f},{:.4f}", command, 1000 * points[i].x(), -1000 * points[i].y());
  }
  return path;
}

std::string Heights(const Stroke& stroke) {
  std::string text;
  for (const auto& p : stroke.control_points_m) text += fmt::format("{}{:.4f}", text.empty() ? "" : " ", 1000 * p.z());
  return text;
}

}  // namespace

void WriteStrokesDxf(const std::vector<Stroke>& strokes, const std::filesystem::path& file) {
  std::string text =
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  const auto point = [](const Eigen::Vector3d& p_m) {
    return fmt::format("10\n{:.4f}\n20\n{:.4f}\n30\n{:.4f}\n", 1000 * p_m.x(), 1000 * p_m.y(), 1000 * p_m.z());
  };
  for (const Stroke& stroke : strokes) {
    text += "0\nPOLYLINE\n8\nSTROKES\n66\n1\n" + point({0, 0, 0}) + "70\n8\n";
    for (const Eigen::Vector3d& p_m : Line(stroke)) text += "0\nVERTEX\n8\nSTROKES\n" + point(p_m) + "70\n32\n";
    text += "0\nSEQEND\n8\nSTROKES\n";
  }
  WriteFileAtomically(file, text + "0\nENDSEC\n0\nEOF\n");
}

void WriteStrokesSvg(const std::vector<Stroke>& strokes, const Blade& blade, const std::filesystem::path& file) {
  Eigen::Vector2d low(0, 0), high(0, 0);
  std::string shapes;
  bool first = true;
  for (const Stroke& stroke : strokes) {
    shapes += fmt::format("  <path d=\"{}\" data-z-mm=\"{}\"/>\n", SvgPath(stroke), Heights(stroke));
    for (const auto& p : stroke.control_points_m) {
      low = first ? Eigen::Vector2d(p.head<2>()) : Eigen::Vector2d(low.cwiseMin(p.head<2>()));
      high = first ? Eigen::Vector2d(p.head<2>()) : Eigen::Vector2d(high.cwiseMax(p.head<2>()));
      first = false;
    }
  }
  const double margin_mm = 1000 * blade.width_m;
  const Eigen::Vector2d size_mm = 1000 * (high - low) + Eigen::Vector2d::Constant(2 * margin_mm);
  WriteFileAtomically(
      file, fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.2f}mm\" height=\"{1:.2f}mm\" "
                        "viewBox=\"{2:.2f} {3:.2f} {0:.2f} {1:.2f}\">\n"
                        "<g fill=\"none\" stroke=\"#7a5537\" stroke-opacity=\"0.5\" stroke-width=\"{4:g}\">\n{5}</g>\n</svg>\n",
                        size_mm.x(), size_mm.y(), 1000 * low.x() - margin_mm, -1000 * high.y() - margin_mm,
                        1000 * blade.width_m, shapes));
}

}  // namespace sandwright
