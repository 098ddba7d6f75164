#include "env/convolution.h"

#include <algorithm>
#include <cstring>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr int kCellBlock = 8;  // cells of a row that are computed together

// What one call of a kernel reads and writes: kCellBlock cells, one or two blocks of channels.
struct Tile {
  const float* in;  // upper left neighbour of the first cell
  int in_channels, size;
  size_t in_cell, in_row;  // strides
  const float* weights;
  size_t weight_block;  // stride between blocks of output channels
  const float* bias;
  bool relu;
  float* out;
  size_t out_cell;
};

// `kLanes` channels in a register, `kBlocks` blocks of output channels, `kCells` cells at a time:
// kBlocks * (kLaneBlock / kLanes) * kCells sums stay in registers.
template <int kLanes, int kBlocks, int kCells>
[[gnu::always_inline]] inline void ConvolveTile(const Tile& t) {
  typedef float Vector [[gnu::vector_size(kLanes * sizeof(float))]];
  constexpr int kVectors = kBlocks * kLaneBlock / kLanes;
  constexpr int kPerBlock = kLaneBlock / kLanes;
  for (int first = 0; first < kCellBlock; first += kCells) {
    Vector sum[kCells][kVectors];
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      Vector bias;
      std::memcpy(&bias, t.bias + v * kLanes, sizeof(Vector));
#pragma GCC unroll 8
      for (int i = 0; i < kCells; ++i) sum[i][v] = bias;
    }
    const float* weights = t.weights;
    for (int ky = 0; ky < t.size; ++ky) {
      for (int kx = 0; kx < t.size; ++kx) {
        const float* in =
            t.in + static_cast<size_t>(ky) * t.in_row + static_cast<size_t>(kx + first) * t.in_cell;
        for (int c = 0; c < t.in_channels; ++c, weights += kLaneBlock) {
          Vector weight[kVectors];
#pragma GCC unroll 8
          for (int v = 0; v < kVectors; ++v)
            std::memcpy(&weight[v],
                        weights + static_cast<size_t>(v / kPerBlock) * t.weight_block +
                            static_cast<size_t>(v % kPerBlock) * kLanes,
                        sizeof(Vector));
#pragma GCC unroll 8
          for (int i = 0; i < kCells; ++i) {
            const float value = in[static_cast<size_t>(i) * t.in_cell + static_cast<size_t>(c)];
#pragma GCC unroll 8
            for (int v = 0; v < kVectors; ++v) sum[i][v] += weight[v] * value;
          }
        }
      }
    }
#pragma GCC unroll 8
    for (int i = 0; i < kCells; ++i) {
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) {
        Vector value = sum[i][v];
        if (t.relu) value = value > 0 ? value : Vector{};
        std::memcpy(t.out + static_cast<size_t>(first + i) * t.out_cell + v * kLanes, &value,
                    sizeof(Vector));
      }
    }
  }
}

// Kernels for one block of channels and for two of them, by instruction set.
using Kernel = void (*)(const Tile&);

template <Kernel kOneBlock>
void Twice(const Tile& t) {
  Tile second = t;
  second.weights += t.weight_block;
  second.bias += kLaneBlock;
  second.out += kLaneBlock;
  kOneBlock(t);
  kOneBlock(second);
}

void OneBlock(const Tile& t) { ConvolveTile<4, 1, 2>(t); }
#ifdef __x86_64__
#define SAND_AVX512 "avx512f,avx512vl,avx512dq,avx512bw,fma"
[[gnu::target("avx2,fma")]] void OneBlockAvx2(const Tile& t) { ConvolveTile<8, 1, 4>(t); }
[[gnu::target(SAND_AVX512)]] void OneBlockAvx512(const Tile& t) { ConvolveTile<16, 1, 8>(t); }
[[gnu::target(SAND_AVX512)]] void TwoBlocksAvx512(const Tile& t) { ConvolveTile<16, 2, 8>(t); }
#endif

struct Kernels {
  Kernel one, two;
};

Kernels ChooseKernels() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw"))
    return {OneBlockAvx512, TwoBlocksAvx512};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return {OneBlockAvx2, Twice<OneBlockAvx2>};
#endif
  return {OneBlock, Twice<OneBlock>};
}

int RoundUp(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

}  // namespace

ActiveCells::ActiveCells(int rows_, int columns_)
    : ActiveCells(
          rows_, columns_,
          std::vector<uint8_t>(static_cast<size_t>(rows_) * static_cast<size_t>(columns_), 1)) {}

ActiveCells::ActiveCells(int rows_, int columns_, std::vector<uint8_t> active)
    : rows(rows_), columns(columns_), cell(std::move(active)) {
  SAND_CHECK(cell.size() == static_cast<size_t>(rows) * static_cast<size_t>(columns));
  for (int row = 0; row < rows; ++row) {
    const uint8_t* begin = cell.data() + static_cast<ptrdiff_t>(row) * columns;
    int first = 0, end = columns;
    while (first < end && !begin[first]) ++first;
    while (end > first && !begin[end - 1]) --end;
    span.emplace_back(first, end);
  }
}

ActiveCells ActiveCells::Coarser(int factor) const {
  SAND_CHECK(rows % factor == 0 && columns % factor == 0, rows, columns, factor);
  const int coarse_columns = columns / factor;
  std::vector<uint8_t> coarse(
      static_cast<size_t>(rows / factor) * static_cast<size_t>(coarse_columns), 0);
  size_t i = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column, ++i) {
      if (cell[i]) coarse[static_cast<size_t>(row / factor * coarse_columns + column / factor)] = 1;
    }
  }
  return {rows / factor, coarse_columns, std::move(coarse)};
}

// Rows are long enough for whole blocks of cells.
CellFeatures::CellFeatures(int rows, int columns, int channels, int border)
    : rows_(rows),
      columns_(columns),
      border_(border),
      cell_stride_(RoundUp(channels, kLaneBlock)),
      row_stride_((columns + 2 * border + kCellBlock) * cell_stride_),
      values_(std::make_unique_for_overwrite<float[]>(static_cast<size_t>(rows + 2 * border) *
                                                      static_cast<size_t>(row_stride_))) {
  for (int row = 0; row < border; ++row) {
    std::fill_n(At(row - border, -border), row_stride_, 0.0f);
    std::fill_n(At(rows + row, -border), row_stride_, 0.0f);
  }
}

void CellFeatures::ClearInactive(const ActiveCells& active, int row) {
  const auto clear = [&](int first, int end) {
    if (end > first)
      std::fill_n(At(row, first), static_cast<ptrdiff_t>(end - first) * cell_stride_, 0.0f);
  };
  const auto [first, end] = active.span[static_cast<size_t>(row)];
  clear(-border_, first);
  for (int column = first; column < end; ++column) {
    if (!active.cell[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                     static_cast<size_t>(column)])
      clear(column, column + 1);
  }
  clear(end, columns_ + border_ + kCellBlock);
}

Convolution::Convolution(int in, int out, int size, const std::vector<float>& weight,
                         const std::vector<float>& bias)
    : in_(in), out_(out), size_(size) {
  const size_t taps = static_cast<size_t>(size) * static_cast<size_t>(size);
  const size_t per_channel = static_cast<size_t>(in) * taps;
  SAND_CHECK(size % 2 == 1 && weight.size() == static_cast<size_t>(out) * per_channel &&
             bias.size() == static_cast<size_t>(out));
  const auto lanes = static_cast<size_t>(RoundUp(out, kLaneBlock));
  weights_.assign(lanes * per_channel, 0.0f);
  bias_.assign(lanes, 0.0f);
  std::ranges::copy(bias, bias_.begin());
  for (size_t i = 0; i < weight.size(); ++i) {
    const size_t o = i / per_channel, c = i % per_channel / taps, tap = i % taps;
    weights_[((o / kLaneBlock * taps + tap) * static_cast<size_t>(in) + c) * kLaneBlock +
             o % kLaneBlock] = weight[i];
  }
}

void Convolution::Apply(const CellFeatures& input, const ActiveCells& active, bool relu,
                        CellFeatures& output) const {
  static const Kernels kernels = ChooseKernels();
  const int half = size_ / 2, blocks = static_cast<int>(bias_.size()) / kLaneBlock;
  SAND_CHECK(input.rows() == output.rows() && input.columns() == output.columns());
  SAND_CHECK(active.rows == output.rows() && active.columns == output.columns());
  SAND_CHECK(input.border() >= half && input.cell_stride() >= in_ &&
             output.cell_stride() >= blocks * kLaneBlock);
  Tile tile{.in = nullptr,
            .in_channels = in_,
            .size = size_,
            .in_cell = static_cast<size_t>(input.cell_stride()),
            .in_row = static_cast<size_t>(input.row_stride()),
            .weights = nullptr,
            .weight_block = static_cast<size_t>(size_) * static_cast<size_t>(size_) *
                            static_cast<size_t>(in_) * kLaneBlock,
            .bias = nullptr,
            .relu = relu,
            .out = nullptr,
            .out_cell = static_cast<size_t>(output.cell_stride())};
  for (int row = 0; row < output.rows(); ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row)];
    for (int block = 0; block < blocks; block += 2) {
      tile.weights = weights_.data() + static_cast<size_t>(block) * tile.weight_block;
      tile.bias = bias_.data() + block * kLaneBlock;
      const Kernel kernel = block + 1 < blocks ? kernels.two : kernels.one;
      for (int column = first; column < end; column += kCellBlock) {
        tile.in = input.At(row - half, column - half);
        tile.out = output.At(row, column) + block * kLaneBlock;
        kernel(tile);
      }
    }
    output.ClearInactive(active, row);
  }
}

}  // namespace sandwright
