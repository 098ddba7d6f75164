#include "env/convolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/base/random.h"

namespace sandwright {
namespace {

std::vector<float> Noise(size_t count, uint64_t seed) {
  RandomStream stream(seed);
  std::vector<float> values(count);
  for (float& v : values) v = static_cast<float>(stream.Normal());
  return values;
}

// in [rows, columns, channels] -> features, zero where not active.
CellFeatures Place(const std::vector<float>& in, int channels, const ActiveCells& active,
                   int border) {
  CellFeatures features(active.rows, active.columns, channels, border);
  for (int row = 0; row < active.rows; ++row) {
    for (int column = 0; column < active.columns; ++column) {
      for (int c = 0; c < channels; ++c)
        features.At(row, column)[c] =
            in[static_cast<size_t>((row * active.columns + column) * channels + c)];
    }
    features.ClearInactive(active, row);
  }
  return features;
}

// The sum of the definition, in double.
double Expected(const CellFeatures& in, int channels, int size, const std::vector<float>& weight,
                float bias, int out, int row, int column) {
  double sum = bias;
  const int half = size / 2;
  for (int c = 0; c < channels; ++c) {
    for (int ky = 0; ky < size; ++ky) {
      for (int kx = 0; kx < size; ++kx) {
        const int y = row + ky - half, x = column + kx - half;
        if (y < 0 || x < 0 || y >= in.rows() || x >= in.columns()) continue;
        sum += static_cast<double>(
                   weight[static_cast<size_t>(((out * channels + c) * size + ky) * size + kx)]) *
               in.At(y, x)[c];
      }
    }
  }
  return sum;
}

TEST(Convolution, IsTheSumOfItsDefinitionOnActiveCellsAndZeroElsewhere) {
  const int rows = 7, columns = 21;  // more than whole blocks of cells
  std::vector<uint8_t> mask;
  for (int i = 0; i < rows * columns; ++i) mask.push_back(i / columns != 2 && i % 5 != 0);
  const ActiveCells active(rows, columns, mask);
  for (const int size : {1, 3, 5}) {
    for (const int out : {4, 16, 40}) {  // less than a block, one, two and a half
      const int channels = 13;
      const auto weight = Noise(static_cast<size_t>(out * channels * size * size), 1);
      const auto bias = Noise(static_cast<size_t>(out), 2);
      const auto in =
          Place(Noise(static_cast<size_t>(rows * columns * channels), 3), channels, active, 2);
      for (const bool relu : {false, true}) {
        CellFeatures result(rows, columns, out, 1);
        Convolution(channels, out, size, weight, bias).Apply(in, active, relu, result);
        for (int i = 0; i < rows * columns; ++i) {
          const int row = i / columns, column = i % columns;
          for (int o = 0; o < out; ++o) {
            double expected = 0;
            if (mask[static_cast<size_t>(i)])
              expected = Expected(in, channels, size, weight, bias[static_cast<size_t>(o)], o, row,
                                  column);
            if (relu) expected = std::max(expected, 0.0);
            ASSERT_NEAR(result.At(row, column)[o], expected, 2e-4)
                << size << ' ' << out << ' ' << i;
          }
        }
        for (int column = -1; column <= columns; ++column) {
          ASSERT_EQ(result.At(-1, column)[0], 0);
          ASSERT_EQ(result.At(rows, column)[0], 0);
        }
        for (int row = 0; row < rows; ++row) {
          ASSERT_EQ(result.At(row, -1)[0], 0);
          ASSERT_EQ(result.At(row, columns)[0], 0);
        }
      }
    }
  }
}

TEST(Convolution, ACellDoesNotDependOnWhatIsComputedBesideIt) {
  const int rows = 6, columns = 24, channels = 20, out = 32;
  const auto weight = Noise(out * channels * 9, 1), bias = Noise(out, 2);
  const Convolution layer(channels, out, 3, weight, bias);
  const ActiveCells all(rows, columns);
  const auto in = Place(Noise(rows * columns * channels, 3), channels, all, 1);
  CellFeatures whole(rows, columns, out, 1), part(rows, columns, out, 1);
  layer.Apply(in, all, true, whole);
  std::vector<uint8_t> mask(rows * columns, 0);
  for (const int column : {3, 4, 13}) mask[static_cast<size_t>(2 * columns + column)] = 1;
  layer.Apply(in, ActiveCells(rows, columns, mask), true, part);
  for (const int column : {3, 4, 13}) {
    for (int c = 0; c < out; ++c) ASSERT_EQ(part.At(2, column)[c], whole.At(2, column)[c]);
  }
  EXPECT_EQ(part.At(2, 5)[0], 0);
  EXPECT_EQ(part.At(3, 3)[0], 0);
}

TEST(ActiveCells, CoarserCellsAreActiveWhereAnyOfTheirsIs) {
  std::vector<uint8_t> mask(4 * 8, 0);
  mask[0 * 8 + 5] = mask[3 * 8 + 2] = 1;
  const ActiveCells fine(4, 8, mask), coarse = fine.Coarser(2);
  EXPECT_EQ(coarse.rows, 2);
  EXPECT_EQ(coarse.columns, 4);
  EXPECT_EQ(coarse.cell, (std::vector<uint8_t>{0, 0, 1, 0, 0, 1, 0, 0}));
  EXPECT_EQ(fine.span[0], std::make_pair(5, 6));
  EXPECT_EQ(fine.span[1].first, fine.span[1].second);
}

}  // namespace
}  // namespace sandwright
