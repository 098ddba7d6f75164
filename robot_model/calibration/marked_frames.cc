#include "robot_model/calibration/marked_frames.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "data/base/error.h"
#include "robot_model/calibration/joint_list.h"

namespace sandwright {
namespace {

namespace aruco = cv::aruco;

cv::Ptr<aruco::Dictionary> DictionaryOf(const std::string& name) {
  static const std::map<std::string, int> known = {
      {"4X4_50", aruco::DICT_4X4_50},     {"4X4_100", aruco::DICT_4X4_100},
      {"4X4_250", aruco::DICT_4X4_250},   {"5X5_50", aruco::DICT_5X5_50},
      {"5X5_100", aruco::DICT_5X5_100},   {"5X5_250", aruco::DICT_5X5_250},
      {"6X6_50", aruco::DICT_6X6_50},     {"6X6_100", aruco::DICT_6X6_100},
      {"6X6_250", aruco::DICT_6X6_250},   {"ORIGINAL", aruco::DICT_ARUCO_ORIGINAL}};
  const auto found = known.find(name);
  if (found == known.end()) {
    std::string names;
    for (const auto& [other, number] : known) names += " " + other;
    throw Error("dictionary " + name + " is not known; allowed:" + names);
  }
  return aruco::getPredefinedDictionary(found->second);
}

cv::Ptr<aruco::CharucoBoard> MakeBoard(const CharucoBoard& board) {
  return aruco::CharucoBoard::create(board.columns, board.rows,
                                     static_cast<float>(board.square_m),
                                     static_cast<float>(board.marker_m),
                                     DictionaryOf(board.dictionary));
}

bool IsPicture(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".png" || extension == ".jpg" || extension == ".tif";
}

// Files as given, folders as their pictures by name.
std::vector<std::filesystem::path> PictureFiles(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::filesystem::path> inside;
    for (const auto& entry : std::filesystem::directory_iterator(path))
      if (IsPicture(entry.path())) inside.push_back(entry.path());
    std::ranges::sort(inside);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

// Points found by another program.
std::vector<MarkedFrame> ReadPoints(const std::filesystem::path& file) {
  const YAML::Node root = LoadYamlNode(file);
  const std::string form = ": the key `frames` is needed, a list of {name, points}";
  if (!root.IsMap() || !root["frames"] || !root["frames"].IsSequence())
    throw Error(file.string() + form);
  std::vector<MarkedFrame> frames;
  for (const YAML::Node& node : root["frames"]) {
    const std::string where = fmt::format("{}: frame {}", file.string(), frames.size() + 1);
    if (!node.IsMap() || !node["points"] || !node["points"].IsSequence())
      throw Error(where + ": `points` is needed, a list of [id, u, v]");
    MarkedFrame frame;
    frame.name = node["name"] ? node["name"].as<std::string>()
                              : fmt::format("frame {}", frames.size() + 1);
    for (const YAML::Node& point : node["points"]) {
      const auto numbers = ReadNumbers(point, 3, where + ": points");
      if (numbers[0] < 0 || numbers[0] > 1e6 || numbers[0] != std::floor(numbers[0]))
        throw Error(fmt::format("{}: points: id {}; a whole number is needed", where, numbers[0]));
      frame.points.push_back({static_cast<int>(numbers[0]), {numbers[1], numbers[2]}});
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace

std::vector<Eigen::Vector3d> CharucoBoard::Corners() const {
  std::vector<Eigen::Vector3d> corners;
  for (int row = 1; row < rows; ++row)
    for (int column = 1; column < columns; ++column)
      corners.emplace_back(column * square_m, row * square_m, 0);
  return corners;
}

CharucoBoard ParseBoard(const std::string& text) {
  static const std::regex form(R"((\d{1,2})x(\d{1,2}),(\d*\.?\d+),(\d*\.?\d+)(?:,(\w+))?)");
  std::smatch match;
  CharucoBoard board;
  if (std::regex_match(text, match, form)) {
    board.columns = std::stoi(match[1]), board.rows = std::stoi(match[2]);
    board.square_m = std::stod(match[3]), board.marker_m = std::stod(match[4]);
    if (match[5].matched) board.dictionary = match[5];
    if (board.columns >= 3 && board.rows >= 3 && board.marker_m > 0 &&
        board.marker_m < board.square_m && board.square_m < 1) {
      DictionaryOf(board.dictionary);
      return board;
    }
  }
  throw Error("--board " + text +
              " is no board; expected COLUMNSxROWS,SQUARE_M,MARKER_M[,DICTIONARY], three squares or "
              "more each way, markers smaller than squares, for example 7x5,0.040,0.030,4X4_50");
}

cv::Mat DrawBoard(const CharucoBoard& board, int pixels_per_square) {
  cv::Mat picture;
  MakeBoard(board)->draw({board.columns * pixels_per_square, board.rows * pixels_per_square},
                         picture);
  return picture;
}

std::vector<MarkedPoint> DetectBoard(const cv::Mat& grey, const CharucoBoard& board) {
  const auto target = MakeBoard(board);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids, ids;
  aruco::detectMarkers(grey, target->dictionary, markers, marker_ids);
  std::vector<MarkedPoint> points;
  if (marker_ids.empty()) return points;
  std::vector<cv::Point2f> corners;
  aruco::interpolateCornersCharuco(markers, marker_ids, grey, target, corners, ids);
  for (size_t i = 0; i < ids.size(); ++i) points.push_back({ids[i], {corners[i].x, corners[i].y}});
  return points;
}

std::vector<MarkedPoint> DetectTags(const cv::Mat& grey, const std::string& dictionary) {
  std::vector<std::vector<cv::Point2f>> tags;
  std::vector<int> ids;
  const auto parameters = aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = aruco::CORNER_REFINE_SUBPIX;
  aruco::detectMarkers(grey, DictionaryOf(dictionary), tags, ids, parameters);
  std::vector<MarkedPoint> points;
  for (size_t i = 0; i < ids.size(); ++i) {
    // Where the diagonals meet: perspective keeps that, unlike the mean of the corners.
    const auto line = [&](size_t a, size_t b) {
      return cv::Point3d(tags[i][a].x, tags[i][a].y, 1)
          .cross(cv::Point3d(tags[i][b].x, tags[i][b].y, 1));
    };
    const cv::Point3d middle = line(0, 2).cross(line(1, 3));
    points.push_back({ids[i], {middle.x / middle.z, middle.y / middle.z}});
  }
  return points;
}

cv::Mat ReadGrey(const std::filesystem::path& file) {
  cv::Mat picture = cv::imread(file.string(), cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw Error(file.string() + ": no picture that can be read");
  if (picture.depth() == CV_8U) return picture;
  std::vector<float> values;
  cv::Mat(picture.reshape(1, 1)).convertTo(values, CV_32F);
  const auto bright = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
  std::nth_element(values.begin(), bright, values.end());
  picture.convertTo(picture, CV_8U, 255 / std::max(1.0f, *bright));
  return picture;
}

std::vector<MarkedFrame> ReadFrames(
    const std::vector<std::string>& paths,
    const std::function<std::vector<MarkedPoint>(const cv::Mat& grey)>& detect) {
  const std::string extension = std::filesystem::path(paths.front()).extension().string();
  if (extension == ".yaml" || extension == ".yml" || extension == ".json")
    return ReadPoints(paths.front());
  std::vector<MarkedFrame> frames;
  for (const auto& file : PictureFiles(paths))
    frames.push_back({file.filename().string(), detect(ReadGrey(file))});
  return frames;
}

}  // namespace sandwright
