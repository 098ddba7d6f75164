// Avalanching of a height map: conservative face fluxes with the full gradient magnitude at each
// face, so piles are round, the outcome does not depend on any order, and a slope at the critical
// angle rests. Nonlinear diffusion form of the inertia-free sandpile limit (Prigozhin 1996; lowest
// Raviart-Thomas fluxes as in Barrett and Prigozhin 2013), advanced by RKL1 super time stepping
// (Meyer, Balsara and Aslam, "A stabilized Runge-Kutta-Legendre method", JCP 257, 2014).
#pragma once

#include <span>
#include <vector>

#include "data/height_map.h"
#include "env/avalanche_kernel.h"
#include "env/firm_sand.h"

namespace sandwright {

// A face between two cells: (row, column) and its neighbour along x or along y.
struct CellFace {
  int row, column;
  bool along_x;
};

// Moves loose sand down the slopes of one map, in place. Sand is loose where it was disturbed, and
// becomes so where an avalanche moves it; other sand lies as steep as it lay, and flows only where it gets
// steeper than that and than repose. Only a window
// around loose sand on the move is ever touched. The volume is kept to rounding and no cell falls
// below the lower of the floor and the lowest cell of its window. Not for several threads at once.
class Avalanche {
 public:
  // `map` moves; its sand is firm where it is as in `before`, the same grid, and then holds slopes `firmness`
  // (>= 1) times as steep as loose sand does, or as steep as it lay. Both maps must outlive the object.
  Avalanche(const HeightMap& before, HeightMap& map, double firmness);

  // Makes the sand of these cells (indices into height_m) loose.
  void Disturb(std::span<const size_t> cells);

  // Lets loose sand steeper than `tan_angle` flow for `amount` of diffusion, in units of squared
  // cells (1/4: one plain explicit step). No sand passes the `closed` faces.
  void Flow(double tan_angle, double amount, std::span<const CellFace> closed);

  // Lets all loose sand come to rest: no slope steeper than `tan_angle` by more than a share of 1e-3.
  void Settle(double tan_angle);

  // Everything that may have changed so far, disturbed cells included.
  const CellRect& touched() const { return touched_; }

 private:
  AvalancheWindow Window(double rise_m);
  void Load(std::span<const CellFace> closed, double rise_m);
  float FindMoving(double rise_m);
  void Store(double rise_m);
  void Advance(double rise_m, double amount);
  void PlainSteps(double rise_m, double amount);
  void SuperStep(double rise_m, double amount);
  void Stage(const std::vector<float>& y1, const std::vector<float>& y2, float momentum, float step,
             double rise_m, std::vector<float>& out);
  void MirrorWalls(std::vector<float>& y) const;

  HeightMap& map_;
  FirmSand firm_;
  CellRect active_, touched_;  // where sand is steep or was disturbed; where it ever moved
  CellRect window_, reach_;    // what is loaded; what may move of it
  int stride_ = 0;             // of the buffers: the window with a ring of one cell
  std::vector<float> start_, y1_, y2_, out_, resist_x_, resist_y_;
  std::vector<uint8_t> near_, moving_;
  std::vector<CellSpan> spans_;         // of each row of the window: what may move
  int mask_row0_ = 0, mask_row1_ = 0;   // rows of the window near closed faces
  std::vector<float> open_x_, open_y_;  // 1 = open, 0 = closed; only valid on those rows
  std::vector<float> flux_;             // scratch rows
};

// Lets the sand of `rect` that lies steeper than `tan_angle` flow until none does, by more than a share of
// 1e-3; other sand holds what it lay at. Returns the cells that may have changed, `rect` included.
CellRect LimitSlopes(HeightMap& map, const CellRect& rect, double tan_angle);

// Brings a whole map to rest at the angle of repose (5..60 degrees, else Error).
void RelaxToRepose(HeightMap& map, double repose_deg);

}  // namespace sandwright
