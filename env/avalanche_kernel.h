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
  // Slope that a face resists, over the critical one (>= 1): of a cell's face towards the next column
  // and the next row, read as open_x and open_y are.
  const float* resist_x;
  const float* resist_y;
  float* flux;  // scratch, 3 * stride
  int rows, columns, stride;
  int mask_row0, mask_row1;  // rows of the window where faces may be closed
  float momentum, step;
  float rise_m;  // critical height difference over one cell
};

// One stage over the window (its ring is read, never written).
void AdvanceWindow(const AvalancheWindow& window);

// Largest squared slope [m^2 over one cell] of the faces of each row and of each column; a face counts
// for both its cells, as a share of what it resists. Only y1, resist, rise_m and the masks are read.
void SteepestFaces(const AvalancheWindow& window, float* of_row, float* of_column);

// What the faces of a window resist: 1 where a cell beside is loose (`loose` 1), else the slope at which
// they lay in `firm`, heights before anything moved, and at least a little more than 1. Buffers as above.
void FaceResistance(const float* firm, const float* loose, int rows, int columns, int stride,
                    float rise_m, float* resist_x, float* resist_y);

// Smallest of `count` > 0 heights.
float LowestHeight(const float* heights, int count);

}  // namespace sandwright
