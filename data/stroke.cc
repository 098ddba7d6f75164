#include "data/stroke.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kMinSegment_m = 1e-3;

// `yaw` shifted by whole turns to within half a turn of `previous`.
double Unwrap(double yaw, double previous) {
  return yaw - 2 * std::numbers::pi * std::round((yaw - previous) / (2 * std::numbers::pi));
}

// De Casteljau: the point and the derivative's direction of a Bezier curve at t.
std::pair<Eigen::Vector3d, Eigen::Vector3d> Bezier(std::vector<Eigen::Vector3d> points, double t) {
  while (points.size() > 2) {
    for (size_t i = 0; i + 1 < points.size(); ++i)
      points[i] = (1 - t) * points[i] + t * points[i + 1];
    points.pop_back();
  }
  return {(1 - t) * points[0] + t * points[1], points[1] - points[0]};
}

Eigen::Vector2d Plane(const Eigen::Vector3d& p) { return p.head<2>(); }

ToolPath SamplePolyline(const Stroke& stroke, double step_m, double turn_step_rad) {
  ToolPath path;
  const auto& points = stroke.control_points_m;
  for (size_t s = 0; s + 1 < points.size(); ++s) {
    const Eigen::Vector3d a = points[s], d = points[s + 1] - a;
    double yaw = std::atan2(d.y(), d.x());
    if (!path.empty()) {
      const BladePose corner = path.back();
      yaw = Unwrap(yaw, corner.yaw_rad);
      const double turn = yaw - corner.yaw_rad;
      const int turns = static_cast<int>(std::ceil(std::abs(turn) / turn_step_rad));
      for (int k = 1; k <= turns; ++k) {
        path.push_back(corner);
        path.back().yaw_rad += turn * k / turns;
      }
    }
    const int steps = std::max(1, static_cast<int>(std::ceil(Plane(d).norm() / step_m)));
    for (int k = path.empty() ? 0 : 1; k <= steps; ++k) {
      const Eigen::Vector3d p = a + d * (static_cast<double>(k) / steps);
      path.push_back({p.x(), p.y(), p.z(), yaw});
    }
  }
  return path;
}

ToolPath SampleBezier(const Stroke& stroke, double step_m, double turn_step_rad) {
  // Dense in t, then thinned by travelled length and turned angle.
  const double control_length = [&] {
    double sum = 0;
    for (size_t i = 0; i + 1 < stroke.control_points_m.size(); ++i)
      sum += Plane(stroke.control_points_m[i + 1] - stroke.control_points_m[i]).norm();
    return sum;
  }();
  const int fine = std::max(64, 8 * static_cast<int>(std::ceil(control_length / step_m)));
  ToolPath path;
  BladePose previous;
  for (int k = 0; k <= fine; ++k) {
    const auto [p, d] = Bezier(stroke.control_points_m, static_cast<double>(k) / fine);
    const double yaw = std::atan2(d.y(), d.x());
    const BladePose pose{p.x(), p.y(), p.z(), k == 0 ? yaw : Unwrap(yaw, previous.yaw_rad)};
    if (k == 0) {
      path.push_back(pose);
    } else {
      const BladePose& last = path.back();
      if (std::hypot(pose.x_m - last.x_m, pose.y_m - last.y_m) > step_m ||
          std::abs(pose.yaw_rad - last.yaw_rad) > turn_step_rad)
        path.push_back(k > 1 ? previous : pose);
    }
    previous = pose;
  }
  if (path.back().x_m != previous.x_m || path.back().y_m != previous.y_m) path.push_back(previous);
  return path;
}

double HeightRange(const Stroke& stroke) {
  const auto [low, high] = std::ranges::minmax_element(
      stroke.control_points_m, {}, [](const Eigen::Vector3d& p) { return p.z(); });
  return high->z() - low->z();
}

}  // namespace

void CheckStroke(const Stroke& stroke, const std::string& source) {
  const auto& points = stroke.control_points_m;
  if (points.size() < 2 || points.size() > 4)
    throw Error(
        fmt::format("{}: control_points_m has {} points; allowed: 2..4", source, points.size()));
  if (stroke.degree != 1 && stroke.degree != 2)
    throw Error(
        fmt::format("{}: degree = {}; allowed: 1 (polyline), 2 (Bezier)", source, stroke.degree));
  if (!(stroke.speed_mps > 0) || !std::isfinite(stroke.speed_mps))
    throw Error(fmt::format("{}: speed_mps = {}; must be > 0", source, stroke.speed_mps));
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite())
      throw Error(fmt::format("{}: control point {} is [{}, {}, {}]; must be finite", source, i,
                              points[i].x(), points[i].y(), points[i].z()));
    if (i == 0) continue;
    const double distance = Plane(points[i] - points[i - 1]).norm();
    if (distance < kMinSegment_m)
      throw Error(
          fmt::format("{}: control points {} and {} are {:.3g} m apart in the plane; at least "
                      "{} m is needed for a direction",
                      source, i - 1, i, distance, kMinSegment_m));
  }
}

ToolPath SamplePath(const Stroke& stroke, double step_m, double turn_step_rad) {
  CheckStroke(stroke, "stroke");
  SAND_CHECK(step_m > 0 && turn_step_rad > 0, step_m, turn_step_rad);
  return stroke.degree == 1 || stroke.control_points_m.size() == 2
             ? SamplePolyline(stroke, step_m, turn_step_rad)
             : SampleBezier(stroke, step_m, turn_step_rad);
}

double PathLength(const Stroke& stroke) {
  const ToolPath path = SamplePath(stroke, 1e-3);
  double length = 0;
  for (size_t i = 1; i < path.size(); ++i)
    length += std::hypot(path[i].x_m - path[i - 1].x_m, path[i].y_m - path[i - 1].y_m);
  return length;
}

char ComplexityClass(const Stroke& stroke) {
  const bool flat = HeightRange(stroke) < 1e-3;
  const size_t points = stroke.control_points_m.size();
  if (stroke.degree == 2 && points > 2) return flat ? 'D' : 'F';
  if (flat) return points == 2 ? 'A' : 'B';
  return points <= 3 ? 'C' : 'E';
}

std::vector<Stroke> ReadStrokes(const std::filesystem::path& file) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw Error("cannot read " + file.string() + ": no such file");
  } catch (const YAML::Exception& e) {
    throw Error(fmt::format("{}: not YAML: {}", file.string(), e.what()));
  }
  const auto text = [&](const char* key) {
    return root.IsMap() && root[key] && root[key].IsScalar() ? root[key].Scalar() : std::string();
  };
  if (text("schema") != "sandwright-plan" || text("schema_version") != "1")
    throw Error(
        fmt::format("{}: schema is \"{}\" version \"{}\"; expected sandwright-plan version 1",
                    file.string(), text("schema"), text("schema_version")));
  if (text("frame") != "box")
    throw Error(fmt::format("{}: frame is \"{}\"; allowed: box", file.string(), text("frame")));
  if (!root["strokes"] || !root["strokes"].IsSequence())
    throw Error(file.string() + ": strokes must be a list");
  std::vector<Stroke> strokes;
  for (const YAML::Node& node : root["strokes"]) {
    const std::string where = fmt::format("{}: strokes[{}]", file.string(), strokes.size());
    Stroke stroke;
    try {
      for (const YAML::Node& point : node["control_points_m"]) {
        const auto p = point.as<std::vector<double>>();
        if (p.size() != 3) throw Error(where + ": a control point needs 3 numbers [x, y, z]");
        stroke.control_points_m.emplace_back(p[0], p[1], p[2]);
      }
      stroke.degree = node["degree"].as<int>();
      stroke.speed_mps = node["speed_mps"].as<double>();
    } catch (const YAML::Exception& e) {
      throw Error(
          fmt::format("{}: needs control_points_m, degree and speed_mps ({})", where, e.what()));
    }
    CheckStroke(stroke, where);
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

}  // namespace sandwright
