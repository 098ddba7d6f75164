// NumPy's array files: .npy (format 1.0 to 3.0) and .npz (a zip of them).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sandwright {

// An array of any of the element types u1, u2, i4, f4, f8, widened to double (exact for all five).
struct NpyArray {
  std::string dtype;          // as in the file, without byte order: "u2"
  std::vector<size_t> shape;  // C order
  std::vector<double> values;
};

// Reads a `.npy` file, or the member `member` of a `.npz` file (stored or deflated; an empty name
// means "arr_0", or the only member). Throws Error naming the file, the fault and what is allowed:
// a cut-off file, another format, another element type, Fortran order, a big-endian array.
NpyArray ReadNumpy(const std::filesystem::path& file, const std::string& member = "");

// Writes format 1.0, whole or not at all. T is uint8_t, uint16_t, float or double; the product of
// `shape` must be the number of values.
template <class T>
void WriteNpy(const std::filesystem::path& file, std::span<const T> values,
              const std::vector<size_t>& shape);

}  // namespace sandwright
