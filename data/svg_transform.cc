#include "data/svg_transform.h"

#include <spdlog/fmt/fmt.h>

#include <map>
#include <numbers>
#include <regex>
#include <vector>

#include "data/base/error.h"

namespace sandwright {
namespace {

std::vector<double> Numbers(const std::string& text) {
  static const std::regex number(R"([-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it)
    numbers.push_back(std::stod(it->str()));
  return numbers;
}

}  // namespace

Eigen::Affine2d ParseSvgTransform(const std::string& text, const std::string& source) {
  static const std::regex call(R"(([a-zA-Z]+)\s*\(([^)]*)\))");
  Eigen::Affine2d all = Eigen::Affine2d::Identity();
  for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
    const std::string name = (*it)[1];
    const std::vector<double> n = Numbers((*it)[2]);
    Eigen::Affine2d one = Eigen::Affine2d::Identity();
    if (name == "translate" && (n.size() == 1 || n.size() == 2)) {
      one.translate(Eigen::Vector2d(n[0], n.size() == 2 ? n[1] : 0));
    } else if (name == "scale" && (n.size() == 1 || n.size() == 2)) {
      one.scale(Eigen::Vector2d(n[0], n.back()));
    } else if (name == "rotate" && (n.size() == 1 || n.size() == 3)) {
      const Eigen::Vector2d about = n.size() == 3 ? Eigen::Vector2d(n[1], n[2]) : Eigen::Vector2d(0, 0);
      one.translate(about).rotate(n[0] * std::numbers::pi / 180).translate(-about);
    } else if (name == "matrix" && n.size() == 6) {
      one.matrix().topRows<2>() << n[0], n[2], n[4], n[1], n[3], n[5];
    } else {
      throw Error(fmt::format("{}: transform \"{}\"; allowed: translate, scale, rotate, matrix", source, it->str()));
    }
    all = all * one;
  }
  return all;
}

std::optional<double> SvgLengthMm(const std::string& text) {
  static const std::regex form(R"(\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([a-z]+)\s*)");
  static const std::map<std::string, double> kUnits = {{"mm", 1},          {"cm", 10},        {"in", 25.4},
                                                       {"pt", 25.4 / 72}, {"pc", 25.4 / 6}, {"px", 25.4 / 96}};
  std::smatch match;
  if (!std::regex_match(text, match, form) || !kUnits.contains(match[2])) return std::nullopt;
  return std::stod(match[1]) * kUnits.at(match[2]);
}

}  // namespace sandwright
