#include "data/svg_path.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "data/base/error.h"

namespace sandwright {
namespace {

using Eigen::Vector2d;

constexpr int kPieces = 32;

class PathReader {
 public:
  PathReader(const std::string& d, const std::string& source) : d_(d), source_(source) {}

  std::vector<SvgLine> Read() {
    while (SkipBlanks(), at_ < d_.size()) {
      if (std::isalpha(static_cast<unsigned char>(d_[at_]))) {
        command_ = d_[at_++];
      } else if (command_ == 0 || Upper() == 'Z') {
        Fail();
      }
      Step();
    }
    return std::move(lines_);
  }

 private:
  [[noreturn]] void Fail() const {
    throw Error(fmt::format("{}: the path cannot be read at \"{}\"", source_, d_.substr(std::min(at_, d_.size()), 20)));
  }
  void SkipBlanks() {
    while (at_ < d_.size() && (std::isspace(static_cast<unsigned char>(d_[at_])) || d_[at_] == ',')) ++at_;
  }
  char Upper() const { return static_cast<char>(std::toupper(command_)); }
  bool relative() const { return command_ >= 'a'; }

  double Number() {
    SkipBlanks();
    char* end = nullptr;
    const double value = std::strtod(d_.c_str() + at_, &end);
    const size_t next = static_cast<size_t>(end - d_.c_str());
    if (next == at_ || !std::isfinite(value)) Fail();
    at_ = next;
    return value;
  }
  // The flags of an arc may stand without blanks between them.
  bool Flag() {
    SkipBlanks();
    if (at_ >= d_.size() || (d_[at_] != '0' && d_[at_] != '1')) Fail();
    return d_[at_++] == '1';
  }
  Vector2d Point() {
    const double x = Number(), y = Number();
    return relative() ? Vector2d(here_ + Vector2d(x, y)) : Vector2d(x, y);
  }

  void Step() {
    const bool goes_on = (Upper() == 'S' && handle_of_ == 'C') || (Upper() == 'T' && handle_of_ == 'Q');
    const Vector2d mirrored = goes_on ? Vector2d(2 * here_ - handle_) : here_;
    handle_of_ = Upper() == 'S' ? 'C' : Upper() == 'T' ? 'Q' : Upper();
    switch (Upper()) {
      case 'M': {
        here_ = Point();
        lines_.push_back({{here_}, false});
        command_ = relative() ? 'l' : 'L';  // further pairs are lines
        break;
      }
      case 'L': LineTo(Point()); break;
      case 'H': LineTo({Number() + (relative() ? here_.x() : 0), here_.y()}); break;
      case 'V': LineTo({here_.x(), Number() + (relative() ? here_.y() : 0)}); break;
      case 'C':
      case 'S': {
        const Vector2d a = Upper() == 'C' ? Point() : mirrored, b = Point(), end = Point();
        handle_ = b;
        Cubic(a, b, end);
        break;
      }
      case 'Q':
      case 'T': {
        const Vector2d a = Upper() == 'Q' ? Point() : mirrored, end = Point();
        handle_ = a;
        Cubic(here_ + 2.0 / 3 * (a - here_), end + 2.0 / 3 * (a - end), end);
        break;
      }
      case 'A': {
        const double rx = std::abs(Number()), ry = std::abs(Number()), turn = Number() * std::numbers::pi / 180;
        const bool large = Flag(), sweep = Flag();
        Arc(rx, ry, turn, large, sweep, Point());
        break;
      }
      case 'Z':
        Open().closed = true;
        here_ = lines_.back().points.front();
        break;
      default: --at_; Fail();
    }
  }

  // The line that is being drawn; after a Z a new one begins where that ended.
  SvgLine& Open() {
    if (lines_.empty()) Fail();
    if (lines_.back().closed) lines_.push_back({{here_}, false});
    return lines_.back();
  }
  void LineTo(const Vector2d& p) {
    Open().points.push_back(p);
    here_ = p;
  }
  void Cubic(const Vector2d& a, const Vector2d& b, const Vector2d& end) {
    const Vector2d start = here_;
    for (int i = 1; i <= kPieces; ++i) {
      const double t = static_cast<double>(i) / kPieces, s = 1 - t;
      LineTo(s * s * s * start + 3 * s * s * t * a + 3 * s * t * t * b + t * t * t * end);
    }
  }
  // From ends to centre as SVG 1.1, appendix F.6.5.
  void Arc(double rx, double ry, double turn, bool large, bool sweep, const Vector2d& end) {
    if (rx == 0 || ry == 0 || end == here_) return LineTo(end);
    Eigen::Matrix2d rotation;
    rotation << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
    const Vector2d half = rotation.transpose() * (here_ - end) / 2;
    const double stretch = std::hypot(half.x() / rx, half.y() / ry);
    if (stretch > 1) rx *= stretch, ry *= stretch;
    const Vector2d unit(half.x() / rx, half.y() / ry);
    const double length = std::min(1.0, unit.norm());
    const double away = std::sqrt(std::max(0.0, 1 / (length * length) - 1)) * (large == sweep ? -1 : 1);
    const Vector2d centre = away * Vector2d(unit.y(), -unit.x());  // in units of the radii
    const double first = std::atan2(unit.y() - centre.y(), unit.x() - centre.x());
    double way = std::atan2(-unit.y() - centre.y(), -unit.x() - centre.x()) - first;
    if (sweep && way < 0) way += 2 * std::numbers::pi;
    if (!sweep && way > 0) way -= 2 * std::numbers::pi;
    const Vector2d middle = (here_ + end) / 2;
    for (int i = 1; i <= kPieces; ++i) {
      const double angle = first + way * i / kPieces;
      const Vector2d on(rx * (centre.x() + std::cos(angle)), ry * (centre.y() + std::sin(angle)));
      LineTo(i == kPieces ? end : Vector2d(middle + rotation * on));
    }
  }

  const std::string& d_;
  const std::string& source_;
  size_t at_ = 0;
  char command_ = 0, handle_of_ = 0;
  Vector2d here_{0, 0}, handle_{0, 0};
  std::vector<SvgLine> lines_;
};

}  // namespace

std::vector<SvgLine> ParseSvgPath(const std::string& d, const std::string& source) {
  return PathReader(d, source).Read();
}

}  // namespace sandwright
