#include "data/camera.h"

#include <opencv2/calib3d.hpp>

namespace sandwright {

std::vector<PixelRay> PixelRays(const CameraModel& camera) {
  const auto count = static_cast<size_t>(camera.width * camera.height);
  std::vector<cv::Point2f> pixels, rays;
  pixels.reserve(count);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      pixels.emplace_back(static_cast<float>(u), static_cast<float>(v));
  const cv::Matx33d k(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const cv::Vec<double, 5> distortion(camera.k1, camera.k2, camera.p1, camera.p2, camera.k3);
  // Five iterations (the default) leave 0.01 px at the corner of a Kinect frame; twenty nothing.
  cv::undistortPoints(pixels, rays, k, distortion, cv::noArray(), cv::noArray(),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 1e-9));
  std::vector<PixelRay> result;
  result.reserve(count);
  for (const cv::Point2f& ray : rays) result.push_back({ray.x, ray.y});
  return result;
}

}  // namespace sandwright
