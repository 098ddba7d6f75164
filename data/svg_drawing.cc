#include "data/svg_drawing.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/svg_transform.h"

namespace sandwright {
namespace {

// What an element hands down to those in it.
struct Style {
  Eigen::Affine2d transform = Eigen::Affine2d::Identity();
  std::string fill = "black", stroke = "none";
  double stroke_width = 1;
  std::optional<double> depth_mm;
};

double Number(const std::string& text, const std::string& name, const std::string& source) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::string unit = end;
  if (text.empty() || end == text.c_str() || !std::isfinite(value) || (!unit.empty() && unit != "px"))
    throw Error(fmt::format("{}: {} = \"{}\"; a number in the drawing's own units is needed", source, name, text));
  return value;
}

// An attribute, or the entry of that name in `style`, which comes first.
std::string Property(const pugi::xml_node& node, const std::string& name) {
  std::istringstream entries(node.attribute("style").value());
  for (std::string entry; std::getline(entries, entry, ';');) {
    const size_t colon = entry.find(':'), begin = entry.find_first_not_of(" \t\n");
    if (colon == std::string::npos || entry.substr(begin, entry.find_last_not_of(" \t", colon - 1) + 1 - begin) != name) continue;
    const size_t value = entry.find_first_not_of(" \t", colon + 1);
    return value == std::string::npos ? "" : entry.substr(value, entry.find_last_not_of(" \t\n") + 1 - value);
  }
  return node.attribute(name.c_str()).value();
}

Style Inherit(const pugi::xml_node& node, Style style, const std::string& source) {
  style.transform = style.transform * ParseSvgTransform(node.attribute("transform").value(), source);
  if (const auto fill = Property(node, "fill"); !fill.empty()) style.fill = fill;
  if (const auto stroke = Property(node, "stroke"); !stroke.empty()) style.stroke = stroke;
  if (const auto width = Property(node, "stroke-width"); !width.empty())
    style.stroke_width = Number(width, "stroke-width", source);
  if (const auto depth = node.attribute("data-depth-mm"))
    style.depth_mm = Number(depth.value(), "data-depth-mm", source);
  return style;
}

std::vector<SvgLine> Outline(const pugi::xml_node& node, const std::string& source) {
  const std::string name = node.name();
  const auto number = [&](const char* key, double missing = 0) {
    const auto attribute = node.attribute(key);
    return attribute ? Number(attribute.value(), key, source) : missing;
  };
  // Every shape as the text of a path: one reader for all.
  std::string d;
  if (name == "path") d = node.attribute("d").value();
  if (name == "line") d = fmt::format("M{} {} L{} {}", number("x1"), number("y1"), number("x2"), number("y2"));
  if (name == "polyline" || name == "polygon")
    d = fmt::format("M{}{}", node.attribute("points").value(), name == "polygon" ? "Z" : "");
  if (name == "rect")
    d = fmt::format("M{} {}h{}v{}h{}Z", number("x"), number("y"), number("width"), number("height"), -number("width"));
  if (name == "circle" || name == "ellipse") {
    const double rx = number(name == "circle" ? "r" : "rx"), ry = number(name == "circle" ? "r" : "ry");
    d = fmt::format("M{0} {1}a{2} {3} 0 1 1 {4} 0a{2} {3} 0 1 1 {5} 0Z", number("cx") - rx, number("cy"), rx, ry, 2 * rx, -2 * rx);
  }
  return ParseSvgPath(d, source);
}

void Collect(const pugi::xml_node& parent, const Style& around, const std::string& file, SvgDrawing& drawing) {
  static const std::set<std::string> kShapes = {"path", "line", "polyline", "polygon", "rect", "circle", "ellipse"};
  static const std::set<std::string> kSilent = {"defs", "title", "desc", "metadata", "style"};
  for (const pugi::xml_node& node : parent.children()) {
    const std::string name = node.name();
    // Names with a colon are notes of drawing programs.
    if (node.type() != pugi::node_element || kSilent.contains(name) || name.find(':') != std::string::npos) continue;
    const std::string source = fmt::format("{}: <{} {}>", file, name, node.attribute("id").value());
    if (Property(node, "display") == "none") continue;
    const Style style = Inherit(node, around, source);
    if (name == "g") {
      Collect(node, style, file, drawing);
      continue;
    }
    if (!kShapes.contains(name))
      throw Error(source + ": this element is not read; allowed: path, line, polyline, polygon, rect, circle, ellipse, g "
                           "(turn text and others into paths)");
    SvgShape shape{.lines = Outline(node, source), .filled = style.fill != "none" && name != "line", .depth_mm = style.depth_mm};
    for (SvgLine& line : shape.lines)
      for (Eigen::Vector2d& p : line.points) p = style.transform * p;
    if (style.stroke != "none")
      shape.stroke_width = style.stroke_width * std::sqrt(std::abs(style.transform.linear().determinant()));
    if (!shape.lines.empty() && (shape.filled || shape.stroke_width > 0)) drawing.shapes.push_back(std::move(shape));
  }
}

// The page and the way of user units into it.
Style Page(const pugi::xml_node& svg, const std::string& file, SvgDrawing& drawing) {
  const std::string width = svg.attribute("width").value(), height = svg.attribute("height").value();
  std::istringstream box(svg.attribute("viewBox").value());
  double x = 0, y = 0;
  Style style;
  if (box >> x >> y >> drawing.width >> drawing.height) {
    style.transform.translate(Eigen::Vector2d(-x, -y));
  } else {
    drawing.width = std::strtod(width.c_str(), nullptr);
    drawing.height = std::strtod(height.c_str(), nullptr);
  }
  if (!(drawing.width > 0 && drawing.height > 0 && std::isfinite(drawing.width + drawing.height)))
    throw Error(file + ": the drawing has no page: a viewBox, or width and height, larger than 0 is needed");
  if (const auto width_mm = SvgLengthMm(width)) drawing.unit_m = *width_mm / 1000 / drawing.width;
  return style;
}

}  // namespace

SvgDrawing ReadSvg(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(bytes.data(), bytes.size());
  if (!parsed) throw Error(fmt::format("{}: not XML, or cut off: {} at byte {}", file.string(), parsed.description(), parsed.offset));
  const pugi::xml_node svg = document.child("svg");
  if (!svg) throw Error(file.string() + ": no SVG drawing: no element svg");
  SvgDrawing drawing;
  const Style page = Page(svg, file.string(), drawing);
  Style inherited = Inherit(svg, page, file.string());
  inherited.transform = page.transform;
  Collect(svg, inherited, file.string(), drawing);
  if (drawing.shapes.empty()) throw Error(file.string() + ": the drawing is empty: nothing is filled or stroked");
  return drawing;
}

HeightMap DrawSvg(const SvgDrawing& drawing, double cell, const std::optional<double>& depth_mm, const std::string& source) {
  constexpr int kShift = 4;  // OpenCV draws at 1/16 px
  const int rows = std::max(1, static_cast<int>(std::lround(drawing.height / cell)));
  const int columns = std::max(2, static_cast<int>(std::lround(drawing.width / cell)));
  cv::Mat image = cv::Mat::zeros(rows, columns, CV_32F);
  for (const SvgShape& shape : drawing.shapes) {
    const auto depth = shape.depth_mm ? shape.depth_mm : depth_mm;
    if (!depth) throw Error(source + ": a shape has no data-depth-mm, and --depth-mm is not given");
    const cv::Scalar height_m(-*depth / 1000);
    std::vector<std::vector<cv::Point>> lines;
    for (const SvgLine& line : shape.lines) {
      lines.emplace_back();
      for (const Eigen::Vector2d& p : line.points) {
        // Pixel centres are at whole numbers.
        const Eigen::Vector2d at = (((p / cell).array() - 0.5) * (1 << kShift)).cwiseMin(1e8).cwiseMax(-1e8);
        lines.back().emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
      }
    }
    if (shape.filled) cv::fillPoly(image, lines, height_m, cv::LINE_8, kShift);
    if (!(shape.stroke_width > 0)) continue;
    // OpenCV's lines are a pixel wider than asked for: both their edges belong to them.
    const int thickness = std::max(1, static_cast<int>(std::lround(shape.stroke_width / cell)) - 1);
    for (size_t i = 0; i < lines.size(); ++i)
      cv::polylines(image, lines[i], shape.lines[i].closed, height_m, thickness, cv::LINE_8, kShift);
  }
  HeightMap map(rows, columns, cell, 0, Datum::kRelative);
  for (int row = 0; row < rows; ++row) std::copy_n(image.ptr<float>(rows - 1 - row), columns, &map.At(row, 0));
  return map;
}

}  // namespace sandwright
