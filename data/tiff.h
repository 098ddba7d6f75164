// TIFF files with one number a pixel and, where they have it, their place on the ground (GeoTIFF).
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace sandwright {

// Row 0 is at the top, as in any picture.
struct TiffImage {
  int rows = 0, columns = 0;
  std::vector<float> values;         // [rows x columns]; NaN: no data
  std::optional<double> pixel_size;  // GeoTIFF ModelPixelScale, in the unit of its maker
};

// One channel of 32-bit float, or of 8 or 16 bits without sign. What GDAL_NODATA names becomes NaN. Error
// naming the file and the fault: missing, cut off, tiled, another form of pixels, pixels that are not square.
TiffImage ReadTiff(const std::filesystem::path& file);

// 32-bit float, deflated, whole or not at all. A pixel size is written as GeoTIFF: ModelPixelScale and a
// ModelTiepoint that puts the lower left corner at (0, 0), pixels as areas.
void WriteTiff(const TiffImage& image, const std::filesystem::path& file);

}  // namespace sandwright
