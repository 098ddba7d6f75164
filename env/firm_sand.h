// How a bed lay before a stroke, and where it has been disturbed since. Sand that nobody touched holds
// slopes as steep as it lay at; loose sand holds the angle of repose only.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

class FirmSand {
 public:
  // All sand of `before` is firm, and holds at least `firmness` times the slope of loose sand. `before` must
  // outlive the object.
  FirmSand(const HeightMap& before, double firmness);

  const HeightMap& before() const { return before_; }
  // One cell: 1 = loose, 0 = firm (index into height_m).
  std::vector<uint8_t>& loose() { return loose_; }

  // What the faces of the cells of `window` resist, over the critical rise of `rise_m` a cell: 1 or more.
  // Cell (row, column) of the window goes to element (row + 1) * stride + column + 1.
  void Resist(const CellRect& window, double rise_m, int stride, std::vector<float>& resist_x,
              std::vector<float>& resist_y);

 private:
  void FindSlopes(const CellRect& rect);

  const HeightMap& before_;
  double firmness_;
  std::vector<uint8_t> loose_;
  // [map] rise over a cell of its face towards the next column and the next row [m]; good inside `known_`,
  // which grows with what moves: a large box costs no more than a small one.
  std::unique_ptr<float[]> slope_x_, slope_y_;
  CellRect known_;
};

}  // namespace sandwright
