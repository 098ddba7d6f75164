#include "env/depth_camera.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "data/base/error.h"

namespace sandwright {
namespace {

using Eigen::Vector3d;

constexpr double kEdge_m = 0.03;
constexpr double kNoiseDepth_m = 1.2;

enum class Surface : uint8_t { kNothing, kTable, kWall, kSand };

struct Sight {
  double depth_m = 0;  // along the optical axis, since rays have z = 1 in C
  Surface surface = Surface::kNothing;
};

struct Interval {
  double begin, end;
  bool empty() const { return !(begin < end); }
};

// Where eye + t ray lies between `low` and `high` in all three axes, t > 0.
Interval Crossing(const Vector3d& eye, const Vector3d& ray, const Vector3d& low,
                  const Vector3d& high) {
  Interval inside{0, std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    // A ray across the axis divides by zero: its interval is
    // everything or nothing, as it should be.
    const double a = (low[axis] - eye[axis]) / ray[axis], b = (high[axis] - eye[axis]) / ray[axis];
    inside.begin = std::max(inside.begin, std::min(a, b));
    inside.end = std::min(inside.end, std::max(a, b));
  }
  return inside;
}

// The scene: the sand's surface, four walls around it on a table.
class Scene {
 public:
  Scene(const HeightMap& bed, const DepthCameraConfig& config) : bed_(bed), config_(config) {
    const auto [low, high] = std::ranges::minmax(bed.height_m);
    lowest_ = low, highest_ = high;
    const double t = config.wall_thickness_m, w = bed.width_m(), d = bed.depth_m();
    const double base = -config.table_m, top = config.wall_height_m;
    walls_ = {{{Vector3d(-t, -t, base), Vector3d(0, d + t, top)},
               {Vector3d(w, -t, base), Vector3d(w + t, d + t, top)},
               {Vector3d(0, -t, base), Vector3d(w, 0, top)},
               {Vector3d(0, d, base), Vector3d(w, d + t, top)}}};
  }

  Sight Look(const Vector3d& eye, const Vector3d& ray) const {
    Sight sight;
    const auto see = [&](double depth, Surface surface) {
      if (depth > 0 && (sight.surface == Surface::kNothing || depth < sight.depth_m))
        sight = {depth, surface};
    };
    if (ray.z() < 0) see((-config_.table_m - eye.z()) / ray.z(), Surface::kTable);
    for (const auto& [low, high] : walls_) {
      const Interval wall = Crossing(eye, ray, low, high);
      if (!wall.empty()) see(wall.begin, Surface::kWall);
    }
    const double sand = SandDepth(eye, ray);
    if (sand > 0) see(sand, Surface::kSand);
    return sight;
  }

 private:
  // Depth of the first point below the sand's surface; 0: none.
  double SandDepth(const Vector3d& eye, const Vector3d& ray) const {
    const Interval span = Crossing(eye, ray, {0, 0, lowest_ - 1e-6},
                                   {bed_.width_m(), bed_.depth_m(), highest_ + 1e-6});
    if (span.empty()) return 0;
    const auto below = [&](double t) {
      const Vector3d p = eye + t * ray;
      return p.z() < HeightAt(bed_, p.x(), p.y());
    };
    const double length = (span.end - span.begin) * ray.head<2>().norm();
    const int steps = 1 + static_cast<int>(2 * length / bed_.cell_size_m);
    double above = span.begin;
    for (int step = 0; step <= steps; ++step) {
      double t = span.begin + (span.end - span.begin) * step / steps;
      if (!below(t)) {
        above = t;
        continue;
      }
      for (int halving = 0; halving < 12; ++halving) {
        const double middle = 0.5 * (above + t);
        (below(middle) ? t : above) = middle;
      }
      return t;
    }
    return 0;
  }

  const HeightMap& bed_;
  const DepthCameraConfig& config_;
  double lowest_, highest_;
  std::array<std::pair<Vector3d, Vector3d>, 4> walls_;
};

}  // namespace

Eigen::Isometry3d CameraAbove(double width_m, double depth_m, double height_m) {
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  X_BC.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  X_BC.translation() = Vector3d(width_m / 2, depth_m / 2, height_m);
  return X_BC;
}

DepthCamera::DepthCamera(const CameraModel& camera, const Eigen::Isometry3d& X_BC,
                         const DepthCameraConfig& config)
    : camera_(camera), X_BC_(X_BC), config_(config), rays_(PixelRays(camera)) {}

DepthFrame DepthCamera::Render(const HeightMap& bed, RandomStream& stream) const {
  CheckHeightMap(bed, "the bed under the camera");
  const Vector3d eye = X_BC_.translation();
  const double top = std::max<double>(config_.wall_height_m, std::ranges::max(bed.height_m));
  if (eye.z() <= top)
    throw Error(fmt::format(
        "the camera is {:.3f} m above the box floor; it must be above walls and sand ({:.3f} m)",
        eye.z(), top));
  const Scene scene(bed, config_);
  std::vector<Sight> sights;
  sights.reserve(rays_.size());
  for (const PixelRay& ray : rays_)
    sights.push_back(scene.Look(eye, X_BC_.linear() * Vector3d(ray.x, ray.y, 1)));

  const int width = static_cast<int>(camera_.width), height = static_cast<int>(camera_.height);
  DepthFrame frame{width, height, std::vector<float>(sights.size(), 0)};
  const uint64_t seed = stream.Next64();
  for (int v = 0; v < height; ++v) {
    RandomStream row(seed, StreamId("depth camera row"), static_cast<uint64_t>(v));
    for (int u = 0; u < width; ++u) {
      const size_t i = static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u);
      const Sight& sight = sights[i];
      const auto jumps = [&](int du, int dv) {
        if (u + du < 0 || u + du >= width || v + dv < 0 || v + dv >= height) return false;
        const auto k = static_cast<std::ptrdiff_t>(i) + dv * width + du;
        return std::abs(sights[static_cast<size_t>(k)].depth_m - sight.depth_m) > kEdge_m;
      };
      const double noise = row.Normal(), luck = row.Uniform();
      double missing = config_.dropout_share;
      if (sight.surface == Surface::kWall) missing = std::max(missing, config_.wall_dropout_share);
      if (jumps(-1, 0) || jumps(1, 0) || jumps(0, -1) || jumps(0, 1))
        missing = std::max(missing, config_.edge_dropout_share);
      if (sight.surface == Surface::kNothing || luck < missing) continue;
      const double scale = sight.depth_m / kNoiseDepth_m;
      const double reading = sight.depth_m + config_.noise_m * scale * scale * noise;
      frame.depth_m[i] =
          static_cast<float>(std::round(reading / config_.resolution_m) * config_.resolution_m);
    }
  }
  return frame;
}

}  // namespace sandwright
