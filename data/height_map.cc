#include "data/height_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/hdf5.h"

namespace sandwright {

CellRect Union(const CellRect& a, const CellRect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.row0, b.row0), std::min(a.column0, b.column0), std::max(a.row1, b.row1),
          std::max(a.column1, b.column1)};
}

void CheckHeightMap(const HeightMap& map, const std::string& source, bool nan_allowed) {
  if (map.rows < 1 || map.columns < 1 || map.rows + map.columns < 3)
    throw Error(fmt::format("{}: the map has {} x {} cells; at least 1 x 2 are needed", source,
                            map.rows, map.columns));
  if (!(map.cell_size_m > 0) || !std::isfinite(map.cell_size_m))
    throw Error(fmt::format("{}: cell_size_m = {}; must be > 0", source, map.cell_size_m));
  const size_t count = static_cast<size_t>(map.rows) * static_cast<size_t>(map.columns);
  SAND_CHECK(map.height_m.size() == count, map.height_m.size(), count);
  SAND_CHECK(map.valid.empty() || map.valid.size() == count, map.valid.size(), count);
  SAND_CHECK(map.mask.empty() || map.mask.size() == count, map.mask.size(), count);
  for (size_t i = 0; i < count; ++i) {
    const float h = map.height_m[i];
    if (std::isfinite(h) || (nan_allowed && std::isnan(h))) continue;
    throw Error(fmt::format("{}: height_m at row {}, column {} is {}; heights must be finite",
                            source, i / static_cast<size_t>(map.columns),
                            i % static_cast<size_t>(map.columns), h));
  }
}

double HeightAt(const HeightMap& map, double x_m, double y_m) {
  const double u = std::clamp(x_m / map.cell_size_m - 0.5, 0.0, map.columns - 1.0);
  const double v = std::clamp(y_m / map.cell_size_m - 0.5, 0.0, map.rows - 1.0);
  const int i = std::min(static_cast<int>(u), std::max(map.columns - 2, 0));
  const int j = std::min(static_cast<int>(v), std::max(map.rows - 2, 0));
  const int i1 = std::min(i + 1, map.columns - 1), j1 = std::min(j + 1, map.rows - 1);
  const double a = u - i, b = v - j;
  return (1 - b) * ((1 - a) * map.At(j, i) + a * map.At(j, i1)) +
         b * ((1 - a) * map.At(j1, i) + a * map.At(j1, i1));
}

namespace {

// Cells of the old grid that a new cell covers, with lengths, along one axis.
struct Overlap {
  int first;
  std::vector<double> share;  // sums to 1
};

std::vector<Overlap> Overlaps(int old_count, double old_cell, int new_count, double new_cell) {
  std::vector<Overlap> overlaps(static_cast<size_t>(new_count));
  for (int n = 0; n < new_count; ++n) {
    const double low = n * new_cell / old_cell, high = (n + 1) * new_cell / old_cell;
    const int first = std::clamp(static_cast<int>(low + 1e-9), 0, old_count - 1);
    const int last = std::clamp(static_cast<int>(std::ceil(high - 1e-9)), first + 1, old_count);
    Overlap& o = overlaps[static_cast<size_t>(n)];
    o.first = first;
    double sum = 0;
    for (int k = first; k < last; ++k) {
      o.share.push_back(std::max(1e-12, std::min<double>(high, k + 1) - std::max<double>(low, k)));
      sum += o.share.back();
    }
    for (double& share : o.share) share /= sum;
  }
  return overlaps;
}

int WholeCells(double extent_m, double cell_size_m) {
  const double count = extent_m / cell_size_m;
  if (!(cell_size_m > 0) || std::abs(count - std::round(count)) > 1e-6 || std::round(count) < 1)
    throw Error(fmt::format("cell_size_m = {} does not divide the map's {} m into whole cells",
                            cell_size_m, extent_m));
  return static_cast<int>(std::round(count));
}

template <class T, class Combine>
std::vector<T> ResampleLayer(const std::vector<T>& layer, int columns,
                             const std::vector<Overlap>& ys, const std::vector<Overlap>& xs,
                             Combine combine) {
  std::vector<T> out;
  out.reserve(ys.size() * xs.size());
  for (const Overlap& y : ys) {
    for (const Overlap& x : xs) {
      double sum = 0;
      for (size_t b = 0; b < y.share.size(); ++b) {
        const size_t row = (static_cast<size_t>(y.first) + b) * static_cast<size_t>(columns);
        for (size_t a = 0; a < x.share.size(); ++a)
          sum += y.share[b] * x.share[a] * layer[row + static_cast<size_t>(x.first) + a];
      }
      out.push_back(combine(sum));
    }
  }
  return out;
}

}  // namespace

int WholeCells(double extent_m, double cell_size_m, const char* key) {
  const double cells = extent_m / cell_size_m;
  if (std::abs(cells - std::round(cells)) > 1e-6)
    throw Error(fmt::format("{} = {} m; must be a whole number of cells of cell_size_m = {} m", key,
                            extent_m, cell_size_m));
  return static_cast<int>(std::round(cells));
}

HeightMap Resample(const HeightMap& map, double cell_size_m) {
  HeightMap out(WholeCells(map.depth_m(), cell_size_m), WholeCells(map.width_m(), cell_size_m),
                cell_size_m, 0, map.datum);
  const auto xs = Overlaps(map.columns, map.cell_size_m, out.columns, cell_size_m);
  const auto ys = Overlaps(map.rows, map.cell_size_m, out.rows, cell_size_m);
  out.height_m = ResampleLayer(map.height_m, map.columns, ys, xs,
                               [](double mean) { return static_cast<float>(mean); });
  const auto majority = [](double mean) { return static_cast<uint8_t>(mean >= 0.5); };
  if (!map.valid.empty()) out.valid = ResampleLayer(map.valid, map.columns, ys, xs, majority);
  if (!map.mask.empty()) out.mask = ResampleLayer(map.mask, map.columns, ys, xs, majority);
  return out;
}

HeightMap SampleOnto(const HeightMap& map, double x_m, double y_m, int rows, int columns,
                     double cell_size_m) {
  constexpr int kSamples = 4;
  HeightMap out(rows, columns, cell_size_m, 0, map.datum);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double sum = 0;
      for (int j = 0; j < kSamples; ++j)
        for (int i = 0; i < kSamples; ++i)
          sum += HeightAt(map, x_m + (column + (i + 0.5) / kSamples) * cell_size_m,
                          y_m + (row + (j + 0.5) / kSamples) * cell_size_m);
      out.At(row, column) = static_cast<float>(sum / (kSamples * kSamples));
    }
  }
  return out;
}

HeightMap Crop(const HeightMap& map, const CellRect& rect) {
  SAND_CHECK(
      rect.row0 >= 0 && rect.column0 >= 0 && rect.row1 <= map.rows && rect.column1 <= map.columns,
      rect.row0, rect.column0, rect.row1, rect.column1);
  HeightMap out(rect.rows(), rect.columns(), map.cell_size_m, 0, map.datum);
  const auto copy = [&](const auto& from, auto& to) {
    to.clear();
    for (int row = rect.row0; row < rect.row1; ++row) {
      const auto begin = from.begin() + static_cast<std::ptrdiff_t>(map.Index(row, rect.column0));
      to.insert(to.end(), begin, begin + rect.columns());
    }
  };
  copy(map.height_m, out.height_m);
  if (!map.valid.empty()) copy(map.valid, out.valid);
  if (!map.mask.empty()) copy(map.mask, out.mask);
  return out;
}

void Paste(const HeightMap& patch, const CellRect& rect, HeightMap& map) {
  SAND_CHECK(patch.rows == rect.rows() && patch.columns == rect.columns(), patch.rows,
             patch.columns);
  for (int row = 0; row < patch.rows; ++row) {
    const auto begin = patch.height_m.begin() + static_cast<std::ptrdiff_t>(patch.Index(row, 0));
    std::copy(begin, begin + patch.columns,
              map.height_m.begin() +
                  static_cast<std::ptrdiff_t>(map.Index(rect.row0 + row, rect.column0)));
  }
}

HeightMap ReadHeightMap(const std::filesystem::path& file, bool nan_allowed) {
  const std::string where = file.string();
  const H5::H5File h5 = OpenHdf5(file);
  CheckSchema(h5, where, "sandwright-heightmap", 1);
  HeightMap map;
  auto heights = ReadArray<float>(h5, "height_m", where);
  map.rows = static_cast<int>(heights.rows);
  map.columns = static_cast<int>(heights.columns);
  map.height_m = std::move(heights.values);
  map.cell_size_m = ReadNumber(h5, "cell_size_m", where);
  const std::string datum = ReadText(h5, "datum", where);
  if (datum != "floor" && datum != "relative")
    throw Error(where + ": datum is \"" + datum + "\"; allowed: floor, relative");
  map.datum = datum == "floor" ? Datum::kFloor : Datum::kRelative;
  const auto read_layer = [&](const char* name, std::vector<uint8_t>& layer) {
    if (!HasDataset(h5, name)) return;
    auto array = ReadArray<uint8_t>(h5, name, where);
    if (array.values.size() != map.size())
      throw Error(fmt::format("{}: dataset {} is {} x {}; height_m is {} x {}", where, name,
                              array.rows, array.columns, map.rows, map.columns));
    layer = std::move(array.values);
  };
  read_layer("valid", map.valid);
  read_layer("mask", map.mask);
  CheckHeightMap(map, where, nan_allowed);
  return map;
}

void WriteHeightMap(const HeightMap& map, const std::filesystem::path& file) {
  CheckHeightMap(map, file.string(), !map.mask.empty());
  WriteHdf5(file, [&](H5::H5File& h5) {
    const auto rows = static_cast<size_t>(map.rows), columns = static_cast<size_t>(map.columns);
    WriteSchema(h5, "sandwright-heightmap", 1);
    WriteNumber(h5, "cell_size_m", map.cell_size_m);
    WriteText(h5, "datum", map.datum == Datum::kFloor ? "floor" : "relative");
    WriteArray(h5, "height_m", map.height_m.data(), rows, columns);
    if (!map.valid.empty()) WriteArray(h5, "valid", map.valid.data(), rows, columns);
    if (!map.mask.empty()) WriteArray(h5, "mask", map.mask.data(), rows, columns);
  });
}

}  // namespace sandwright
