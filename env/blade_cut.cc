#include "env/blade_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandwright {
namespace {

// Cells exactly on the blade's front count as behind it, whatever the rounding of its heading.
constexpr double kTie = 1e-6;  // [cells]; also the share of a cell that is nothing

// Share of a cell [x - cell/2, x + cell/2] that lies within [low, high].
double Overlap(double x, double low, double high, double cell, double per_cell) {
  return std::max(0.0, std::min(x + cell / 2, high) - std::max(x - cell / 2, low)) * per_cell;
}

}  // namespace

void BladeCut::Strips::Reset(size_t count) {
  for (std::vector<double>* values : {&volume, &bottom, &length, &room}) values->assign(count, 0);
}

BladeCut::BladeCut(HeightMap& map, const Blade& blade, const CutLaw& law, double floor_m)
    : map_(map),
      law_(law),
      floor_m_(floor_m),
      cell_(map.cell_size_m),
      half_width_(blade.width_m / 2),
      half_thickness_(blade.thickness_m / 2),
      strip_count_(std::max(1, static_cast<int>(blade.width_m / cell_ + 1e-6))),
      strip_width_(blade.width_m / strip_count_),
      per_cell_(1 / cell_),
      per_strip_(1 / strip_width_) {}

BladeCut::Placed BladeCut::Place(const BladePose& pose) {
  return {pose, std::cos(pose.yaw_rad), std::sin(pose.yaw_rad)};
}

// Visits the cells whose centres lie in [u_low, u_high] along the blade's normal and within s_half
// across it: visit(row, column, index, u, s).
template <class Visit>
void BladeCut::ForEachCell(const Placed& at, double u_low, double u_high, double s_half,
                           Visit visit) const {
  const auto [low_y, high_y] = [&] {
    const double a = std::min(u_low * at.s, u_high * at.s),
                 b = std::max(u_low * at.s, u_high * at.s);
    const double half = s_half * std::abs(at.c);
    return std::pair(at.pose.y_m + a - half, at.pose.y_m + b + half);
  }();
  const int row0 = static_cast<int>(std::ceil(std::max(low_y / cell_ - 0.5, 0.0)));
  const int row1 = static_cast<int>(std::floor(std::min(high_y / cell_ - 0.5, map_.rows - 1.0)));
  for (int row = row0; row <= row1; ++row) {
    const double y = (row + 0.5) * cell_ - at.pose.y_m;
    // low <= slope * x + offset <= high, twice.
    double x_low = -at.pose.x_m, x_high = map_.width_m() - at.pose.x_m;
    const auto clip = [&](double slope, double offset, double low, double high) {
      if (std::abs(slope) < 1e-12) {
        if (offset < low || offset > high) x_high = x_low - 1;
        return;
      }
      const double a = (low - offset) / slope, b = (high - offset) / slope;
      x_low = std::max(x_low, std::min(a, b));
      x_high = std::min(x_high, std::max(a, b));
    };
    clip(at.c, y * at.s, u_low, u_high);
    clip(-at.s, y * at.c, -s_half, s_half);
    if (x_high < x_low) continue;
    const int column0 =
        std::max(0, static_cast<int>(std::ceil((x_low + at.pose.x_m) / cell_ - 0.5)));
    const int column1 = std::min(
        map_.columns - 1, static_cast<int>(std::floor((x_high + at.pose.x_m) / cell_ - 0.5)));
    for (int column = column0; column <= column1; ++column) {
      const double x = (column + 0.5) * cell_ - at.pose.x_m;
      visit(row, column, map_.Index(row, column), x * at.c + y * at.s, y * at.c - x * at.s);
    }
  }
}

double BladeCut::Across(double s) const {
  return Overlap(s, -half_width_, half_width_, cell_, per_cell_);
}

BladeCut::Between BladeCut::Find(double s) const {
  const double at = std::clamp((s + half_width_) * per_strip_ - 0.5, 0.0, strip_count_ - 1.0);
  const int strip = std::min(static_cast<int>(at), std::max(strip_count_ - 2, 0));
  return {static_cast<size_t>(strip), static_cast<size_t>(std::min(strip + 1, strip_count_ - 1)),
          at - strip};
}

// Reads the sand just off the blade on one side (+1 ahead, -1 behind), strip by strip.
void BladeCut::Probe(const Placed& at, double side, Strips& strips) const {
  strips.Reset(static_cast<size_t>(strip_count_));
  const double u = side * (half_thickness_ + cell_);
  for (int k = 0; k < strip_count_; ++k) {
    const double s = (k + 0.5) * strip_width_ - half_width_;
    const double height =
        HeightAt(map_, at.pose.x_m + u * at.c - s * at.s, at.pose.y_m + u * at.s + s * at.c);
    const double depth = std::max(0.0, height - at.pose.z_m);
    strips.length[static_cast<size_t>(k)] = std::max(cell_, law_.rupture_ratio * depth);
    strips.bottom[static_cast<size_t>(k)] =
        std::max(floor_m_, at.pose.z_m - std::min(law_.bite_m, depth));
  }
}

// The cells on one side that take cut sand, with their weights.
void BladeCut::FindRoom(const Placed& at, double side, Strips& strips,
                        std::vector<Receiver>& receivers) const {
  Probe(at, side, strips);
  receivers.clear();
  const double longest = *std::ranges::max_element(strips.length);
  const double near = half_thickness_, far = half_thickness_ + longest + cell_ / 2;
  const double widening = law_.spread / half_width_;
  ForEachCell(at, side > 0 ? near : -far, side > 0 ? far : -near,
              half_width_ + law_.spread * longest + cell_ / 2,
              [&](int, int, size_t cell, double u, double widened_s) {
                if (side * u <= near + kTie * cell_) return;
                const double s = widened_s / (1 + widening * (side * u - near));
                const double across = Across(s);
                if (across <= 0) return;
                const Between place = Find(s);
                const double weight =
                    across *
                    Overlap(side * u, near, near + place.Mix(strips.length), cell_, per_cell_);
                if (weight <= 0) return;
                place.Add(weight, strips.room);
                receivers.push_back({cell, place, weight});
              });
}

void BladeCut::Lay(const std::vector<Receiver>& receivers, Strips& strips) {
  if (receivers.empty()) return;
  const size_t count = strips.volume.size();
  // A strip without room (at a wall) hands its sand to the nearest one that has some.
  for (size_t k = 0; k < count; ++k) {
    if (strips.room[k] > 0 || strips.volume[k] == 0) continue;
    for (size_t away = 1; away < count; ++away) {
      const bool low = k >= away && strips.room[k - away] > 0;
      const bool high = k + away < count && strips.room[k + away] > 0;
      if (!low && !high) continue;
      const double part = strips.volume[k] / (low + high);
      if (low) strips.volume[k - away] += part;
      if (high) strips.volume[k + away] += part;
      break;
    }
    strips.volume[k] = 0;
  }
  for (size_t k = 0; k < count; ++k) {
    if (strips.room[k] > 0) strips.volume[k] /= strips.room[k];
  }
  for (const Receiver& r : receivers) {
    const double rise = r.weight * r.place.Mix(strips.volume);
    map_.height_m[r.cell] = static_cast<float>(map_.height_m[r.cell] + rise);
    if (rise > 0) changed_.push_back(r.cell);
  }
}

void BladeCut::Cut(const Placed& from, const Placed& to) {
  changed_.clear();
  const double sunk = from.pose.z_m - to.pose.z_m, h = half_thickness_, front = h + kTie * cell_;
  FindRoom(to, 1, ahead_, receivers_ahead_);
  receivers_behind_.clear();
  if (sunk > 0 || from.pose.yaw_rad != to.pose.yaw_rad)
    FindRoom(to, -1, behind_, receivers_behind_);
  const auto take = [&](size_t cell, double amount, const Between& place, Strips& strips) {
    const float before = map_.height_m[cell];
    map_.height_m[cell] = static_cast<float>(std::max(before - amount, floor_m_));
    const double taken = static_cast<double>(before) - map_.height_m[cell];
    place.Add(taken, strips.volume);
  };
  const bool room_ahead = !receivers_ahead_.empty(), room_behind = !receivers_behind_.empty();
  ForEachCell(
      to, -h - cell_, h + cell_, half_width_ + cell_ / 2,
      [&](int row, int column, size_t cell, double u, double s) {
        const double across = Across(s);
        const Between place = Find(s);
        const double excess = map_.height_m[cell] - place.Mix(ahead_.bottom);
        if (excess <= kTie * cell_ || across <= 0) return;
        const double x = (column + 0.5) * cell_ - from.pose.x_m,
                     y = (row + 0.5) * cell_ - from.pose.y_m;
        const double u_from = x * from.c + y * from.s;
        // The front takes a cell when it passes its centre, as sand flows round the blade: a cell that is
        // half taken would stand for sand ahead of the blade and for sand behind it.
        const bool taken = u <= front && u_from > front;
        const double by_front = room_ahead && taken ? excess * across : 0;
        // What the back of a turning or sinking blade newly sweeps of a cell.
        const auto back = [&](double at) { return std::clamp((h + at) / cell_ + 0.5, 0.0, 1.0); };
        const double left = 1 - across * back(u_from), newly = back(u) - back(u_from);
        const double by_back =
            room_behind && newly > 0 && left > kTie ? excess * across * newly / left : 0;
        // A blade that goes down also presses out what stands below it.
        const double pressed =
            sunk > 0 ? across * Overlap(u, -h, h, cell_, per_cell_) * std::min(sunk, excess) : 0;
        const double halves = pressed / std::max(1, room_ahead + room_behind);
        double ahead = by_front + (room_ahead ? halves : 0),
               behind = by_back + (room_behind ? halves : 0);
        if (ahead + behind <= 0) return;
        const double scale = std::min(1.0, excess / (ahead + behind));
        if (ahead > 0) take(cell, scale * ahead, place, ahead_);
        if (behind > 0) take(cell, scale * behind, place, behind_);
        changed_.push_back(cell);
      });
  if (changed_.empty()) return;
  Lay(receivers_ahead_, ahead_);
  Lay(receivers_behind_, behind_);
}

std::span<const size_t> BladeCut::Plunge(const BladePose& pose) {
  const Placed at = Place(pose);
  Placed above = at;
  above.pose.z_m = std::numeric_limits<double>::max();
  Cut(above, at);
  return changed_;
}

std::span<const size_t> BladeCut::Advance(const BladePose& from, const BladePose& to) {
  Cut(Place(from), Place(to));
  return changed_;
}

std::vector<CellFace> BladeCut::ClosedFaces(const BladePose& pose) const {
  const Placed at = Place(pose);
  const double front = half_thickness_ + kTie * cell_;
  const double reach = half_width_ + kTie * cell_;
  std::vector<CellFace> closed;
  ForEachCell(at, front - 1.5 * cell_, front + 1.5 * cell_, half_width_ + 1.5 * cell_,
              [&](int row, int column, size_t cell, double u, double s) {
                const auto test = [&](bool along_x) {
                  const int next_row = row + !along_x, next_column = column + along_x;
                  if (next_row >= map_.rows || next_column >= map_.columns) return;
                  const double next_u = u + (along_x ? at.c : at.s) * cell_;
                  const double next_s = s + (along_x ? -at.s : at.c) * cell_;
                  if ((u > front) == (next_u > front)) return;
                  const double crossing = s + (next_s - s) * (front - u) / (next_u - u);
                  if (std::abs(crossing) > reach) return;
                  if (std::max(map_.height_m[cell], map_.At(next_row, next_column)) <= at.pose.z_m)
                    return;
                  closed.push_back({row, column, along_x});
                };
                test(true);
                test(false);
              });
  return closed;
}

}  // namespace sandwright
