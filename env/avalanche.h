// Avalanching of a height map: conservative face fluxes with the full gradient magnitude at each
// face, so piles are round, the outcome does not depend on any order, and a slope at the critical
// angle rests. Nonlinear diffusion form of the inertia-free sandpile limit (Prigozhin 1996; lowest
// Raviart-Thomas fluxes as in Barrett and Prigozhin 2013), advanced by RKL1 super time stepping
// (Meyer, Balsara and Aslam, "A stabilized Runge-Kutta-Legendre method", JCP 257, 2014).
#pragma once

#include <vector>

#include "data/height_map.h"

namespace sandwright {

// A face between two cells: (row, column) and its neighbour along x or along y.
struct CellFace {
  int row, column;
  bool along_x;
};

// Moves sand down the slopes of one map, in place. It only ever touches a window around the cells
// it is given, which follows the moving sand. The volume is kept to rounding and no cell falls below
// the lower of the floor and the lowest cell of its window. Not for several threads at once.
class Avalanche {
 public:
  // `map` must outlive the object.
  explicit Avalanche(HeightMap& map) : map_(map) {}

  // Lets the slopes steeper than `tan_angle` in and near `active` flow for `amount` of diffusion,
  // in units of squared cells (1/4: one plain explicit step). No sand passes the `closed` faces.
  // Returns where the slopes were steeper than the angle by more than a share of 1e-2 before (empty: at rest).
  CellRect Flow(const CellRect& active, double tan_angle, double amount,
                const std::vector<CellFace>& closed);

  // Lets the sand in and near `active` come to rest: no slope steeper than `tan_angle` by more than
  // a share of 1e-3.
  void Settle(const CellRect& active, double tan_angle);

  // Everything that may have changed so far.
  const CellRect& touched() const { return touched_; }

 private:
  // Where faces are steeper than asked, and the steepest slope of all [squared rise per cell, m^2].
  struct Steepness {
    CellRect where;
    float steepest = 0;
  };

  void Load(const CellRect& active, const std::vector<CellFace>& closed);
  void Store();
  Steepness FindSteep(double rise_m);
  void Advance(double rise_m, double amount);
  void PlainSteps(double rise_m, double amount);
  void SuperStep(double rise_m, double amount);
  void Stage(const std::vector<float>& y1, const std::vector<float>& y2, float momentum, float step,
             double rise_m, std::vector<float>& out);
  void MirrorWalls(std::vector<float>& y) const;

  HeightMap& map_;
  CellRect touched_;
  CellRect window_;
  int stride_ = 0;                      // of the buffers: the window with a ring of one cell
  std::vector<float> start_, y1_, y2_, out_;
  int mask_row0_ = 0, mask_row1_ = 0;   // rows of the window near closed faces
  std::vector<float> open_x_, open_y_;  // 1 = open, 0 = closed; only valid on those rows
  std::vector<float> flux_;             // scratch rows
};

// Smallest rectangle that holds both (an empty one holds nothing).
CellRect Union(const CellRect& a, const CellRect& b);

// Brings a whole map to rest at the angle of repose (5..60 degrees, else Error).
void RelaxToRepose(HeightMap& map, double repose_deg);

}  // namespace sandwright
