#include "env/paper_import.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "data/base/atomic_file.h"
#include "data/stroke_import.h"
#include "env/paper_encoding.h"

namespace sandwright {
namespace {

constexpr double kLeastOverlap = 0.8, kStraight_px = 1.0, kFlat_m = 0.002, kPathStep_m = 0.002;
constexpr int kMiddle = kPaperPixels / 2;

cv::Mat ReadPair(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file);
  cv::Mat image;
  if (!bytes.empty())
    image = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())),
                         cv::IMREAD_UNCHANGED);
  if (image.empty()) throw Error(file.string() + ": not a picture, or cut off");
  if (image.type() != CV_8UC3 || image.rows != kPaperPixels || image.cols != 2 * kPaperPixels)
    throw Error(fmt::format("{}: {} x {} pixels in {} channels of {} bits; a pair has {} x {} in 3 channels of 8",
                            file.string(), image.cols, image.rows, image.channels(), 8 * image.elemSize1(),
                            2 * kPaperPixels, kPaperPixels));
  return image;
}

HeightMap MapOf(const cv::Mat& image, int first_column, int channel) {
  HeightMap map(kPaperPixels, kPaperPixels, kPaperPixel_m);
  for (int row = 0; row < map.rows; ++row)  // the picture's way down is -y
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = static_cast<float>(
          kPaperLevel_m * image.at<cv::Vec3b>(kPaperPixels - 1 - row, first_column + column)[channel]);
  return map;
}

bool Passed(const cv::Mat& image, int row, int column) { return image.at<cv::Vec3b>(row, column)[1] > 127; }

// A point of the way's middle: picture row, picture column, height of the blade's edge [m].
using Middle = Eigen::Vector3d;

// Where the way lies in each row of the picture between its ends.
std::vector<Middle> TraceMiddle(const cv::Mat& image, double first_row, double last_row) {
  std::vector<Middle> middle;
  for (int row = static_cast<int>(std::ceil(first_row)); row + 0.5 <= last_row; ++row) {
    double sum = 0;
    int count = 0;
    for (int column = 0; column < kPaperPixels; ++column)
      if (Passed(image, row, column)) sum += column + 0.5, ++count;
    if (count == 0) continue;
    const double at = sum / count;
    const cv::Vec3b& pixel = image.at<cv::Vec3b>(row, std::min(kPaperPixels - 1, static_cast<int>(at)));
    middle.emplace_back(row + 0.5, at, kPaperLevel_m * (pixel[2] - pixel[0]));
  }
  return middle;
}

// Rows of the first and the last point: they lie in the picture's middle column, and the blade's footprint, grown by
// half a pixel, reaches beyond them.
std::pair<double, double> Ends(const cv::Mat& image, const Blade& blade, const std::string& where) {
  int first = -1, last = -1;
  for (int row = 0; row < kPaperPixels; ++row) {
    if (!Passed(image, row, kMiddle) && !Passed(image, row, kMiddle - 1)) continue;
    if (first < 0) first = row;
    last = row;
  }
  const double half = (last + 1 - first) / 2.0 - blade.thickness_m / 2 / kPaperPixel_m - 0.5;
  if (first < 0 || half < 2) throw Error(where + ": no path in its middle (green channel)");
  return {kMiddle - half, kMiddle + half};
}

// The Bernstein polynomials of order three at the rows of `middle`: the row grows evenly along the curve.
Eigen::MatrixXd Basis(const std::vector<Middle>& middle, double first_row, double last_row) {
  Eigen::MatrixXd basis(middle.size(), 4);
  for (size_t i = 0; i < middle.size(); ++i) {
    const double t = (middle[i].x() - first_row) / (last_row - first_row), s = 1 - t;
    basis.row(static_cast<Eigen::Index>(i)) << s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t;
  }
  return basis;
}

Eigen::VectorXd Entries(const std::vector<Middle>& middle, Eigen::Index entry) {
  Eigen::VectorXd values(middle.size());
  for (size_t i = 0; i < middle.size(); ++i) values[static_cast<Eigen::Index>(i)] = middle[i][entry];
  return values;
}

// One Bezier curve by least squares, its ends in the picture's middle column; a line where it is straight.
Stroke FitCurve(const std::vector<Middle>& middle, double first_row, double last_row, double inset) {
  // Rows at the ends are crossed by the blade's edge, not by its whole way: their columns do not count.
  std::vector<Middle> whole;
  for (const Middle& m : middle)
    if (m.x() >= first_row + inset && m.x() <= last_row - inset) whole.push_back(m);
  Eigen::Vector4d column = Eigen::Vector4d::Zero();
  column.segment<2>(1) = Basis(whole, first_row, last_row).middleCols<2>(1).colPivHouseholderQr().solve(
      Entries(whole, 1) - Eigen::VectorXd::Constant(static_cast<Eigen::Index>(whole.size()), kMiddle));
  const Eigen::VectorXd heights_m = Entries(middle, 2);
  Eigen::Vector4d z_m = Basis(middle, first_row, last_row).colPivHouseholderQr().solve(heights_m);
  if (z_m.maxCoeff() - z_m.minCoeff() < kFlat_m) z_m.setConstant(heights_m.mean());
  Stroke stroke{{}, 2, Stroke().speed_mps};
  for (int k = 0; k < 4; ++k) {
    const double row = first_row + (last_row - first_row) * k / 3;
    stroke.control_points_m.emplace_back((kMiddle + column[k]) * kPaperPixel_m,
                                         (kPaperPixels - row) * kPaperPixel_m, z_m[k]);
  }
  const double bend_m = (z_m - Eigen::Vector4d::LinSpaced(z_m[0], z_m[3])).cwiseAbs().maxCoeff();
  if (column.cwiseAbs().maxCoeff() < kStraight_px && bend_m < kFlat_m)
    stroke = {{stroke.control_points_m.front(), stroke.control_points_m.back()}, 1, stroke.speed_mps};
  return stroke;
}

// Share of the pixels of either path that both have.
double Overlap(const cv::Mat& image, const PaperInput& again) {
  int both = 0, either = 0;
  for (int i = 0; i < kPaperCount; ++i) {
    const bool a = Passed(image, i / kPaperPixels, i % kPaperPixels), b = again.path[static_cast<size_t>(i)] != 0;
    both += a && b;
    either += a || b;
  }
  return either == 0 ? 0 : static_cast<double>(both) / either;
}

}  // namespace

StrokeRecord ReadPaperPair(const std::filesystem::path& file, const Blade& blade) {
  const cv::Mat image = ReadPair(file);
  const auto [first_row, last_row] = Ends(image, blade, file.string());
  const double inset = std::min(0.2 * (last_row - first_row), 500 * blade.width_m);
  const std::vector<Middle> middle = TraceMiddle(image, first_row, last_row);
  if (middle.size() < 8) throw Error(file.string() + ": its path is shorter than a few pixels");
  StrokeRecord record{.before = MapOf(image, 0, 2), .after = MapOf(image, kPaperPixels, 1),
                      .stroke = FitCurve(middle, first_row, last_row, inset), .path = {}, .blade = blade,
                      .replicate_of = {}};
  CheckStroke(record.stroke, file.string());
  record.path = SamplePath(record.stroke, kPathStep_m);
  const auto again = EncodePaperInput(record.before, record.path, blade);
  const double overlap = again ? Overlap(image, *again) : 0;
  if (overlap < kLeastOverlap)
    throw Error(fmt::format("{}: no curve of four points gives its path back: {:.0f} % of the pixels agree; at least "
                            "{:.0f} % are needed (blade {:g} x {:g} mm)",
                            file.string(), 100 * overlap, 100 * kLeastOverlap, 1e3 * blade.width_m,
                            1e3 * blade.thickness_m));
  return record;
}

StrokeFile ReadPaperPairs(const std::filesystem::path& path, const Blade& blade) {
  StrokeFile content = ImportedStrokes(path.has_filename() ? path : path.parent_path(), Datum::kRelative);
  if (!std::filesystem::is_directory(path)) {
    content.strokes.push_back(ReadPaperPair(path, blade));
    return content;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path))
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const auto& file : files) {
    try {
      content.strokes.push_back(ReadPaperPair(file, blade));
      content.strokes.back().sequence = static_cast<int64_t>(content.strokes.size()) - 1;
    } catch (const Error& e) {
      spdlog::warn("left out: {}", e.what());
    }
  }
  if (content.strokes.empty()) throw Error(path.string() + ": no pair of pictures (.png) in it can be taken");
  return content;
}

}  // namespace sandwright
