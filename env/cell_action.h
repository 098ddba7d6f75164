// Strokes for policies that choose among cells: whole numbers instead of the seven of env/action.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "data/base/config.h"
#include "env/agent.h"

namespace sandwright {

// How finely each choice is divided. Ends of a range are levels, but for the heading, which goes round.
struct CellActionConfig {
  int64_t rows = 16, columns = 16;
  int64_t headings = 16, lengths = 4, depths = 4, bends = 3;

  void Fields(FieldList& f) {
    f.Add("rows", rows, "cells for the start over the region's depth (y)", 2, 256);
    f.Add("columns", columns, "cells for the start over the region's width (x)", 2, 256);
    f.Add("headings", headings, "directions, the first along x", 2, 360);
    f.Add("lengths", lengths, "levels of the length", 2, 100);
    f.Add("depths", depths, "levels of the depth at the start, and of that at the end", 2, 100);
    f.Add("bends", bends, "levels of the bend; odd: with lines", 2, 99);
  }
};

inline constexpr int kCellActionSize = 6;
using CellAction = std::array<int64_t, kCellActionSize>;

// How many values each entry has: start cell (row by row), heading, length, depth at the start, depth
// at the end, bend.
CellAction CellActionSizes(const CellActionConfig& config);

// The same stroke in the numbers of kActionSpec; it starts in the middle of its cell. Error where a
// choice is not below its CellActionSizes.
Action ActionOf(const CellAction& choice, const CellActionConfig& config);

// [rows x columns] 1 where a stroke can start: inside the walls and, with a gate, in reach of its arm.
std::vector<uint8_t> StartMask(const TaskView& view, const CellActionConfig& config);

}  // namespace sandwright
