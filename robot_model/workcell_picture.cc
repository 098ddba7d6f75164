#include "robot_model/workcell_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/camera_pose.h"

namespace sandwright {
namespace {

constexpr double kPixelsPerM = 1400;  // drawn at twice the size that is kept, for smooth lines
constexpr double kMargin_m = 0.12;
constexpr int kPanel_px = 380;
constexpr double kAxis_m = 0.09;

const cv::Scalar kPaper(250, 251, 252), kInk(60, 50, 45), kWood(150, 185, 210), kFaint(170, 165, 160),
    kView(40, 60, 220);

// Pixels of points of C, distortion included.
std::vector<cv::Point2d> Project(const std::vector<cv::Point3d>& points_C,
                                 const CameraModel& camera) {
  const cv::Matx33d k(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const cv::Vec<double, 5> distortion(camera.k1, camera.k2, camera.p1, camera.p2, camera.k3);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points_C, cv::Vec3d(), cv::Vec3d(), k, distortion, pixels);
  return pixels;
}

// The picture's border on the plane z = 0 of B, where its rays meet it.
std::vector<Eigen::Vector2d> ViewOnFloor(const Workcell& cell, const Eigen::Isometry3d& X_BC) {
  const std::vector<PixelRay> rays = PixelRays(cell.camera);
  const int w = static_cast<int>(cell.camera.width), h = static_cast<int>(cell.camera.height);
  std::vector<int> border;
  for (int u = 0; u < w; ++u) border.push_back(u);
  for (int v = 1; v < h; ++v) border.push_back(v * w + w - 1);
  for (int u = w - 2; u >= 0; --u) border.push_back((h - 1) * w + u);
  for (int v = h - 2; v > 0; --v) border.push_back(v * w);
  std::vector<Eigen::Vector2d> outline;
  for (const int i : border) {
    const PixelRay& ray = rays[static_cast<size_t>(i)];
    const Eigen::Vector3d direction = X_BC.linear() * Eigen::Vector3d(ray.x, ray.y, 1);
    const double along = -X_BC.translation().z() / direction.z();
    if (along > 0) outline.push_back((X_BC.translation() + along * direction).head<2>());
  }
  return outline;
}

// Paper to scale: x of B to the right, y up.
class Sheet {
 public:
  Sheet(const Workcell& cell, const std::vector<Eigen::Vector2d>& inside) {
    low_ = {-cell.box.wall_thickness_m, -cell.box.wall_thickness_m};
    high_ = {cell.box.width_m - low_.x(), cell.box.depth_m - low_.y()};
    for (const Eigen::Vector2d& p : inside) low_ = low_.cwiseMin(p), high_ = high_.cwiseMax(p);
    low_.array() -= kMargin_m;
    high_.array() += kMargin_m;
    const cv::Point size = At({high_.x(), low_.y()});
    image_ = cv::Mat(size.y + kPanel_px, std::max(size.x, 2000), CV_8UC3, kPaper);
    panel_top_ = size.y;
  }

  cv::Point At(const Eigen::Vector2d& p) const {
    return {static_cast<int>((p.x() - low_.x()) * kPixelsPerM),
            static_cast<int>((high_.y() - p.y()) * kPixelsPerM)};
  }
  void Rectangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const cv::Scalar& colour) {
    cv::rectangle(image_, At(a), At(b), colour, cv::FILLED, cv::LINE_AA);
  }
  void Write(const std::string& text, cv::Point at, double size, const cv::Scalar& colour) {
    cv::putText(image_, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kPaper, 10, cv::LINE_AA);
    cv::putText(image_, text, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, 2, cv::LINE_AA);
  }
  cv::Mat& image() { return image_; }
  int panel_top() const { return panel_top_; }

 private:
  Eigen::Vector2d low_, high_;
  cv::Mat image_;
  int panel_top_ = 0;
};

cv::Scalar ReachColour(double share) {
  const cv::Vec3d none(205, 222, 232), all(140, 185, 130);  // sand to green
  const cv::Vec3d mixed = none + share * (all - none);
  return {mixed[0], mixed[1], mixed[2]};
}

void DrawBox(Sheet& sheet, const Workcell& cell, const ReachMap& reach) {
  const double w = cell.box.width_m, d = cell.box.depth_m, t = cell.box.wall_thickness_m;
  sheet.Rectangle({-t, -t}, {w + t, d + t}, kWood);
  for (int row = 0; row < reach.rows; ++row)
    for (int column = 0; column < reach.columns; ++column) {
      const double dx = w / reach.columns, dy = d / reach.rows;
      sheet.Rectangle({column * dx, row * dy}, {(column + 1) * dx, (row + 1) * dy},
                      ReachColour(reach.share[static_cast<size_t>(row * reach.columns + column)]));
    }
}

void DrawView(Sheet& sheet, const std::vector<Eigen::Vector2d>& outline) {
  // Dashes of 16 mm along the border, which is a point a pixel of the camera.
  for (size_t i = 0; i < outline.size(); ++i) {
    if (i / 12 % 2) continue;
    cv::line(sheet.image(), sheet.At(outline[i]), sheet.At(outline[(i + 1) % outline.size()]), kView,
             4, cv::LINE_AA);
  }
}

// Axes as seen from above, red, green, blue for x, y, z; one that stands upright is a ring, with a dot
// where it points up and a cross where it points down. The name stands `label` px from the origin, to
// its left where that is negative.
void DrawFrame(Sheet& sheet, const std::string& name, const Eigen::Isometry3d& X_B,
               cv::Point label) {
  constexpr double kText = 1.0;
  const cv::Scalar colours[] = {{50, 50, 210}, {60, 150, 40}, {200, 90, 30}};
  const cv::Point origin = sheet.At(X_B.translation().head<2>());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = X_B.linear().col(axis);
    const Eigen::Vector2d tip = X_B.translation().head<2>() + kAxis_m * direction.head<2>();
    if (direction.head<2>().norm() > 0.2) {
      cv::arrowedLine(sheet.image(), origin, sheet.At(tip), colours[axis], 6, cv::LINE_AA, 0, 0.2);
      continue;
    }
    cv::circle(sheet.image(), origin, 16, kPaper, cv::FILLED, cv::LINE_AA);
    cv::circle(sheet.image(), origin, 16, colours[axis], 5, cv::LINE_AA);
    if (direction.z() > 0)
      cv::circle(sheet.image(), origin, 5, colours[axis], cv::FILLED, cv::LINE_AA);
    else
      cv::drawMarker(sheet.image(), origin, colours[axis], cv::MARKER_TILTED_CROSS, 18, 4);
  }
  const std::string text = fmt::format("{}  z {:.0f} mm", name, 1e3 * X_B.translation().z());
  if (label.x < 0)
    label.x -= cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kText, 2, nullptr).width;
  sheet.Write(text, origin + label, kText, kInk);
}

void DrawFrames(Sheet& sheet, const Workcell& cell) {
  const Ur10 arm(cell.kinematics);
  const Eigen::Isometry3d X_BW = cell.X_WB.ToIsometry().inverse();
  const Eigen::Isometry3d X_BF_home = X_BW * arm.Forward(cell.home());
  const Eigen::Isometry3d X_BF = X_BW * arm.Forward(cell.camera_pose());
  const cv::Point base = sheet.At(X_BW.translation().head<2>());
  cv::circle(sheet.image(), base, static_cast<int>(cell.box.pedestal_radius_m * kPixelsPerM),
             {225, 222, 218}, cv::FILLED, cv::LINE_AA);
  cv::circle(sheet.image(), base, static_cast<int>(0.075 * kPixelsPerM), kFaint, cv::FILLED,
             cv::LINE_AA);
  DrawFrame(sheet, "W  base", X_BW, {60, 60});
  DrawFrame(sheet, "B  box", Eigen::Isometry3d::Identity(), {30, 60});
  DrawFrame(sheet, "F  flange at home", X_BF_home, {-50, -10});
  DrawFrame(sheet, "T  blade at the camera pose", X_BF * cell.tool.X_FT.ToIsometry(), {-50, 30});
  DrawFrame(sheet, "C  camera at its pose", X_BF * cell.tool.X_FC.ToIsometry(), {60, -40});
}

void DrawPanel(Sheet& sheet, const SafetyGate& gate) {
  const Workcell& cell = gate.workcell();
  double reach = 0;
  for (const float share : gate.reach().share)
    reach += share / static_cast<double>(gate.reach().share.size());
  int y = sheet.panel_top() + 60;
  const int step = 75, left = 80;
  sheet.Write(fmt::format("{}:  {:.0f} x {:.0f} mm inside, rim {:.0f} mm", cell.name,
                          1e3 * cell.box.width_m, 1e3 * cell.box.depth_m,
                          1e3 * cell.box.wall_height_m),
              {left, y}, 1.3, kInk);
  y += step + 15;
  for (int i = 0; i < 120; ++i)
    cv::rectangle(sheet.image(), {left + 2 * i, y - 34, 2, 34}, ReachColour(i / 119.0), cv::FILLED);
  sheet.Write(fmt::format("strokes can start here in none to all headings; {:.0f} % over the box",
                          100 * reach),
              {left + 270, y}, 1.1, kInk);
  y += step;
  for (int dash = 0; dash < 4; ++dash)
    cv::line(sheet.image(), {left + 62 * dash, y - 14}, {left + 62 * dash + 40, y - 14}, kView, 4,
             cv::LINE_AA);
  sheet.Write(fmt::format("border of the camera's picture on the floor; it sees {:.1f} % of the box",
                          100 * CameraCoverage(cell)),
              {left + 270, y}, 1.1, kInk);
  y += step;
  const auto faults = CalibrationFaults(cell);
  sheet.Write(faults.empty() ? std::string("calibrated for a real arm")
                             : fmt::format("not ready for a real arm: {} of 4 calibrations missing, "
                                           "outdated or not good enough",
                                           faults.size()),
              {left, y}, 1.1, faults.empty() ? cv::Scalar(60, 130, 40) : kView);
}

// A point of the floor is in the camera's picture, and not behind a wall's rim.
bool Sees(const Workcell& cell, const Eigen::Isometry3d& X_BC, const Eigen::Vector3d& floor) {
  const Eigen::Vector3d eye = X_BC.translation(), p_C = X_BC.inverse() * floor;
  if (p_C.z() <= 0 || eye.z() <= cell.box.wall_height_m) return false;
  // Where the line of sight comes down to the rim it must be inside the walls.
  const Eigen::Vector3d rim = floor + (cell.box.wall_height_m / eye.z()) * (eye - floor);
  if (rim.x() < 0 || rim.y() < 0 || rim.x() > cell.box.width_m || rim.y() > cell.box.depth_m)
    return false;
  const cv::Point2d p = Project({{p_C.x(), p_C.y(), p_C.z()}}, cell.camera).front();
  return p.x >= 0 && p.y >= 0 && p.x <= static_cast<double>(cell.camera.width - 1) &&
         p.y <= static_cast<double>(cell.camera.height - 1);
}

}  // namespace

double CameraCoverage(const Workcell& cell) {
  constexpr double kGrid_m = 0.01;
  std::vector<Eigen::Isometry3d> cameras;
  for (const JointAngles& pose : cell.camera_poses()) cameras.push_back(CameraInBox(cell, pose));
  size_t all = 0, seen = 0;
  for (double y = kGrid_m / 2; y < cell.box.depth_m; y += kGrid_m)
    for (double x = kGrid_m / 2; x < cell.box.width_m; x += kGrid_m, ++all)
      seen += std::ranges::any_of(cameras, [&](const Eigen::Isometry3d& X_BC) {
        return Sees(cell, X_BC, Eigen::Vector3d(x, y, 0));
      });
  return static_cast<double>(seen) / static_cast<double>(all);
}

cv::Mat DrawWorkcell(const SafetyGate& gate) {
  const Workcell& cell = gate.workcell();
  std::vector<std::vector<Eigen::Vector2d>> views;
  std::vector<Eigen::Vector2d> inside;
  for (const JointAngles& pose : cell.camera_poses()) {
    views.push_back(ViewOnFloor(cell, CameraInBox(cell, pose)));
    inside.insert(inside.end(), views.back().begin(), views.back().end());
  }
  const Eigen::Vector2d base = cell.X_WB.ToIsometry().inverse().translation().head<2>();
  const Eigen::Vector2d post = Eigen::Vector2d::Constant(cell.box.pedestal_radius_m);
  inside.push_back(base - post);
  inside.push_back(base + post);
  Sheet sheet(cell, inside);
  DrawBox(sheet, cell, gate.reach());
  for (const auto& view : views) DrawView(sheet, view);
  DrawFrames(sheet, cell);
  DrawPanel(sheet, gate);
  cv::Mat kept;
  cv::resize(sheet.image(), kept, {}, 0.5, 0.5, cv::INTER_AREA);
  return kept;
}

}  // namespace sandwright
