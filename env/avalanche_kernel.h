// The inner loops of the avalanche, in a form that compilers turn into vector code.
#pragma once

namespace sandwright {

// Cells that vector code takes at a time. Faces are computed up to a whole number of lanes and the
// surplus is ignored: square roots one by one at the end of each row would cost more than the row.
inline constexpr int kLanes = 8;
constexpr int WholeLanes(int columns) { return (columns + kLanes - 1) / kLanes * kLanes; }

// A window of heights [m] with a ring of one cell around it: element (row, column) of the window is
// at (row + 1) * stride + column + 1 of each buffer; stride is at least WholeLanes(columns) + 2 and
// the surplus holds finite numbers. No sand passes the window's edge.
struct AvalancheWindow {
  const float* y1;      // heights whose slopes drive the fluxes
  const float* y2;      // heights one stage earlier
  float* out;           // y1 + momentum * (y1 - y2) + step * (net inflow)
  const float* open_x;  // 1 = open, 0 = closed: the face of a cell towards the next column
  const float* open_y;  // the same towards the next row
  const float* resist;  // of each cell: 1 = loose, kFirm = lies as it is
  float* flux;          // scratch, 3 * stride
  int rows, columns, stride;
  int mask_row0, mask_row1;  // rows of the window where faces may be closed
  float momentum, step;
  float rise_m;  // critical height difference over one cell
};

// Resistance of a cell whose sand nobody has touched: a face flows where one of its cells is loose.
inline constexpr float kFirm = 1e6f;

// One stage over the window (its ring is read, never written).
void AdvanceWindow(const AvalancheWindow& window);

// Largest squared slope [m^2 over one cell] of the faces of each row and of each column; a face counts
// for both its cells, one between firm cells not at all. Only y1, resist, rise_m and
// the masks are read.
void SteepestFaces(const AvalancheWindow& window, float* of_row, float* of_column);

// Smallest of `count` > 0 heights.
float LowestHeight(const float* heights, int count);

}  // namespace sandwright
