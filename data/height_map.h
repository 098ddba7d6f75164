// The terrain: heights above the floor of the sand box on a regular grid.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "data/base/error.h"

namespace sandwright {

// What the zero of the heights is.
enum class Datum {
  kFloor,     // the box floor: absolute
  kRelative,  // unknown: good for goals by difference and training, refused by the gate
};

// Row-major heights in frame B of the box (x along columns, y along rows, z up). The cell in row j,
// column i has its centre at ((i + 1/2) cell, (j + 1/2) cell); the map's edges are the box walls.
struct HeightMap {
  HeightMap() = default;
  HeightMap(int rows_, int columns_, double cell_size_m_, float fill_m = 0,
            Datum datum_ = Datum::kFloor)
      : rows(rows_),
        columns(columns_),
        cell_size_m(cell_size_m_),
        datum(datum_),
        height_m(static_cast<size_t>(rows_) * static_cast<size_t>(columns_), fill_m) {}

  float& At(int row, int column) { return height_m[Index(row, column)]; }
  float At(int row, int column) const { return height_m[Index(row, column)]; }
  size_t Index(int row, int column) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
  size_t size() const { return height_m.size(); }
  double width_m() const { return columns * cell_size_m; }  // extent along x
  double depth_m() const { return rows * cell_size_m; }     // extent along y
  bool SameGrid(const HeightMap& other) const {
    return rows == other.rows && columns == other.columns && cell_size_m == other.cell_size_m;
  }

  int rows = 0;
  int columns = 0;
  double cell_size_m = 0;
  Datum datum = Datum::kFloor;
  std::vector<float> height_m;  // [rows x columns]
  std::vector<uint8_t> valid;   // [rows x columns] 0 = not seen by the camera; empty = all seen
  std::vector<uint8_t> mask;    // [rows x columns] of a goal: 1 = counts; empty = all count
};

// A rectangle of cells, half open: rows [row0, row1), columns [column0, column1).
struct CellRect {
  int row0 = 0, column0 = 0, row1 = 0, column1 = 0;
  bool empty() const { return row1 <= row0 || column1 <= column0; }
  int rows() const { return row1 - row0; }
  int columns() const { return column1 - column0; }
};

// The smallest rectangle that holds both; an empty one adds nothing.
CellRect Union(const CellRect& a, const CellRect& b);

// Throws Error naming `source` and the first bad cell: at least 1 x 2 cells, a positive cell size,
// finite heights (NaN is allowed where `nan_allowed`: goals), sizes of valid and mask.
void CheckHeightMap(const HeightMap& map, const std::string& source, bool nan_allowed = false);

// Bilinear height [m] at (x, y) [m] in B, held constant beyond the outer cell centres.
double HeightAt(const HeightMap& map, double x_m, double y_m);

// The map on cells of another size, same walls: area-weighted mean, so volume is kept.
// The extent must be a whole number of new cells (to 1e-6), else Error.
HeightMap Resample(const HeightMap& map, double cell_size_m);

// A piece of the map on cells of its own: its corner at (x, y) [m] in B, each cell the mean of 4 x 4
// bilinear heights. Beyond the map's edge as HeightAt; valid and mask are left behind.
HeightMap SampleOnto(const HeightMap& map, double x_m, double y_m, int rows, int columns,
                     double cell_size_m);

// How many cells of `cell_size_m` an extent holds. Error naming the configuration's `key` where that is
// no whole number (to 1e-6).
int WholeCells(double extent_m, double cell_size_m, const char* key);

// A whole-cell crop and its inverse. `rect` must lie inside.
HeightMap Crop(const HeightMap& map, const CellRect& rect);
void Paste(const HeightMap& patch, const CellRect& rect, HeightMap& map);

// Height map file, schema "sandwright-heightmap" version 1 (HDF5). Goals may hold NaN and a mask.
HeightMap ReadHeightMap(const std::filesystem::path& file, bool nan_allowed = false);
void WriteHeightMap(const HeightMap& map, const std::filesystem::path& file);

}  // namespace sandwright
