// Convolutions for prediction on the CPU, without torch: single precision, one thread, the best
// vector instructions that the machine has. A cell's sum runs in one order whatever is computed
// beside it, so the result does not depend on how work is cut up.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace sandwright {

inline constexpr int kLaneBlock = 16;  // output channels that are computed together

// Which cells of a grid are worked on; the others stay zero.
struct ActiveCells {
  // All of them, or those where `active` [rows, columns] is not 0.
  ActiveCells(int rows, int columns);
  ActiveCells(int rows, int columns, std::vector<uint8_t> active);
  // On cells `factor` times as large: active where any of its cells is. rows and columns must be
  // multiples of the factor.
  ActiveCells Coarser(int factor) const;

  int rows = 0, columns = 0;
  std::vector<uint8_t> cell;              // [rows, columns] 1 = worked on
  std::vector<std::pair<int, int>> span;  // [rows] first and one past the last active column
};

// A grid of cells, the channels of a cell side by side, with zeros around it `border` cells wide.
// What lies inside is not set.
class CellFeatures {
 public:
  CellFeatures(int rows, int columns, int channels, int border);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  int border() const { return border_; }
  int cell_stride() const { return cell_stride_; }  // channels, rounded up to kLaneBlock
  int row_stride() const { return row_stride_; }
  // Rows and columns from -border() on.
  float* At(int row, int column) {
    return values_.get() + static_cast<ptrdiff_t>(row + border_) * row_stride_ +
           static_cast<ptrdiff_t>(column + border_) * cell_stride_;
  }
  const float* At(int row, int column) const {
    return const_cast<CellFeatures*>(this)->At(row, column);
  }
  // Sets every cell of `row` that is not active to zero, the border with it.
  void ClearInactive(const ActiveCells& active, int row);

 private:
  int rows_, columns_, border_, cell_stride_, row_stride_;
  std::unique_ptr<float[]> values_;
};

// One layer: size x size (odd), stride 1, zero padded.
class Convolution {
 public:
  // weight [out, in, size, size] and bias [out], as torch keeps them.
  Convolution(int in, int out, int size, const std::vector<float>& weight,
              const std::vector<float>& bias);

  int in() const { return in_; }
  int out() const { return out_; }
  int size() const { return size_; }

  // Writes channels 0..out of the active cells (rounded up to kLaneBlock with zeros) and zero to
  // all others. `input` has the size of `output` and at least a border of size / 2.
  void Apply(const CellFeatures& input, const ActiveCells& active, bool relu,
             CellFeatures& output) const;

 private:
  int in_, out_, size_;
  std::vector<float> weights_;  // [out / kLaneBlock][size x size][in][kLaneBlock]
  std::vector<float> bias_;     // padded to whole blocks
};

}  // namespace sandwright
