// Numbered points of a board or of tags in camera pictures.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace sandwright {

struct MarkedPoint {
  int id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // u, v
};

struct MarkedFrame {
  std::string name;  // of the picture
  std::vector<MarkedPoint> points;
};

// A ChArUco board: squares, of which the white ones carry markers. Points: inner corners, numbered
// row by row from the origin.
struct CharucoBoard {
  int columns = 7, rows = 5;  // squares
  double square_m = 0.040, marker_m = 0.030;
  std::string dictionary = "4X4_50";

  std::vector<Eigen::Vector3d> Corners() const;  // by id, in the board's plane z = 0 [m]
};

// "7x5,0.040,0.030" or "7x5,0.040,0.030,5X5_100": squares, their side and the markers' [m],
// dictionary. Throws Error with the form that is allowed.
CharucoBoard ParseBoard(const std::string& text);

// The board as a picture to print or to test with, `pixels_per_square` wide squares.
cv::Mat DrawBoard(const CharucoBoard& board, int pixels_per_square);

// What a grey picture (8 bit) shows; empty where it shows none.
std::vector<MarkedPoint> DetectBoard(const cv::Mat& grey, const CharucoBoard& board);
// The middles of ArUco tags.
std::vector<MarkedPoint> DetectTags(const cv::Mat& grey, const std::string& dictionary);

// A picture file as 8-bit grey; 16-bit infrared is stretched so that its brightest percent is white.
cv::Mat ReadGrey(const std::filesystem::path& file);

// The frames that paths name. Files as given and folders as their .png, .jpg and .tif by name, each
// through `detect`; or one YAML or JSON file of points that another program found:
// `frames: [{name: ..., points: [[id, u, v], ...]}]`. Throws Error naming the entry.
std::vector<MarkedFrame> ReadFrames(
    const std::vector<std::string>& paths,
    const std::function<std::vector<MarkedPoint>(const cv::Mat& grey)>& detect);

}  // namespace sandwright
