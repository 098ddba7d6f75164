// The inner loops of the avalanche, in a form that compilers turn into vector code.
#pragma once

#include <cstdint>

namespace sandwright {

// Cells that vector code takes at a time. Faces are computed up to a whole number of lanes and the
// surplus is ignored: square roots one by one at the end of each row would cost more than the row.
inline constexpr int kLanes = 8;
constexpr int WholeLanes(int columns) { return (columns + kLanes - 1) / kLanes * kLanes; }

// The same for marks, one byte a cell.
inline constexpr int kMarkLanes = 32;
constexpr int WholeMarks(int columns) {
  return (columns + kMarkLanes - 1) / kMarkLanes * kMarkLanes;
}
constexpr int MarkStride(int columns) { return WholeMarks(columns) + kMarkLanes; }

// Cells [first, last) of a row; none where first >= last.
struct CellSpan {
  int first, last;
  bool empty() const { return first >= last; }
};

// A window of cells with a ring of one around it: element (row, column) of the window is at
// (row + 1) * stride + column + 1 of each buffer, and buffers have rows + 2 such rows. The surplus
// holds finite numbers.
struct AvalancheWindow {
  int rows, columns, stride;
  const float* open_x;       // 1 = open, 0 = closed: the face of a cell towards the next column
  const float* open_y;       // the same towards the next row
  int mask_row0, mask_row1;  // rows of the window where faces may be closed
  // Slope that a face resists, over the critical one (>= 1): of a cell's face towards the next column
  // and the next row, read as open_x and open_y are.
  float* resist_x;
  float* resist_y;
  float rise_m;  // critical height difference over one cell
  float* flux;   // scratch, 3 * stride
  static constexpr int Stride(int columns) { return WholeMarks(columns) + kLanes + 2; }
};

// Squared slope [m^2 over one cell] of each cell's steepest face, as a share of what the face resists.
// Faces at the window's edge do not count. Returns the greatest.
float FeltSlopes(const AvalancheWindow& window, const float* heights, float* felt);

// Which cells may move: those within kMargin rows and columns of one that feels more than `limit`. Writes
// 1 and 0 into `moving`, the span of each row, and shuts all faces but those between two moving cells
// (resist). Uses up `felt`.
inline constexpr int kMargin = 3;
void FindMoving(const AvalancheWindow& window, const float* felt, float limit, uint8_t* near,
                uint8_t* moving, CellSpan* spans);

// out = y1 + momentum * (y1 - y2) + step * (net inflow) over the spans; the slopes of y1 drive the fluxes.
void AdvanceWindow(const AvalancheWindow& window, const CellSpan* spans, const float* y1,
                   const float* y2, float momentum, float step, float* out);

// Slopes [rise over a cell, m] of the faces of cells [first, last) of a row towards the next column and
// the next row; the rows below and above it count, at a wall the row itself.
void RowSlopes(const float* below, const float* row, const float* above, int columns,
               CellSpan cells, float* slope_x, float* slope_y);

// What the faces of a row resist: 1 where a cell beside is loose, else the slope at which they lay, and at
// least a little more than `firmness`. `loose_above`: the next row's.
void RowResistance(const float* slope_x, const float* slope_y, const uint8_t* loose,
                   const uint8_t* loose_above, int count, float firmness, float rise_m,
                   float* resist_x, float* resist_y);

// Smallest of `count` > 0 heights.
float LowestHeight(const float* heights, int count);

}  // namespace sandwright
