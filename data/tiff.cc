#include "data/tiff.h"

#include <spdlog/fmt/fmt.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr uint32_t kPixelScale = 33550, kTiepoint = 33922, kGeoKeys = 34735, kNoData = 42113;
constexpr size_t kMaxPixels = 16'000'000;

TIFFExtendProc parent_extender = nullptr;

// libtiff reads and writes tags beyond its own once it knows their form.
void KnowGeoTags(TIFF* tiff) {
  static char scale[] = "ModelPixelScale", tie[] = "ModelTiepoint", keys[] = "GeoKeyDirectory",
              none[] = "GDAL_NODATA";
  static const TIFFFieldInfo fields[] = {
      {kPixelScale, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, scale},
      {kTiepoint, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, tie},
      {kGeoKeys, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, keys},
      {kNoData, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, none}};
  TIFFMergeFieldInfo(tiff, fields, std::size(fields));
  if (parent_extender != nullptr) parent_extender(tiff);
}

using TiffFile = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

TiffFile Open(const std::filesystem::path& file, const char* mode) {
  static const bool known = [] {
    TIFFSetErrorHandler(nullptr);  // our errors name the file
    TIFFSetWarningHandler(nullptr);
    parent_extender = TIFFSetTagExtender(KnowGeoTags);
    return true;
  }();
  SAND_CHECK(known);
  return {TIFFOpen(file.c_str(), mode), &TIFFClose};
}

// The numbers of a row, by the form of its pixels.
void Widen(const std::vector<unsigned char>& row, int bits, float* out, int columns) {
  for (int i = 0; i < columns; ++i) {
    if (bits == 32) out[i] = reinterpret_cast<const float*>(row.data())[i];
    if (bits == 16) out[i] = reinterpret_cast<const uint16_t*>(row.data())[i];
    if (bits == 8) out[i] = row[static_cast<size_t>(i)];
  }
}

void ReadPlace(TIFF* tiff, TiffImage& image, const std::string& where) {
  uint16_t count = 0;
  const double* scale = nullptr;
  if (TIFFGetField(tiff, kPixelScale, &count, &scale) && count >= 2) {
    if (!(scale[0] > 0) || std::abs(scale[0] - scale[1]) > 1e-6 * scale[0])
      throw Error(fmt::format("{}: its pixels are {:g} x {:g}; they must be square and larger than 0", where, scale[0], scale[1]));
    image.pixel_size = scale[0];
  }
  const char* none = nullptr;
  if (!TIFFGetField(tiff, kNoData, &none)) return;
  const auto no_data = static_cast<float>(std::atof(none));
  std::ranges::replace(image.values, no_data, std::numeric_limits<float>::quiet_NaN());
}

}  // namespace

TiffImage ReadTiff(const std::filesystem::path& file) {
  const std::string where = file.string();
  if (!std::filesystem::exists(file)) throw Error("cannot read " + where + ": no such file");
  const TiffFile tiff = Open(file, "r");
  if (!tiff) throw Error(where + ": not a TIFF file, or cut off");
  uint32_t columns = 0, rows = 0;
  uint16_t bits = 1, channels = 1, form = SAMPLEFORMAT_UINT;
  TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &columns);
  TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &rows);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &channels);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &form);
  const bool known = bits == 32 ? form == SAMPLEFORMAT_IEEEFP : (bits == 8 || bits == 16) && form == SAMPLEFORMAT_UINT;
  if (channels != 1 || !known || TIFFIsTiled(tiff.get()))
    throw Error(fmt::format("{}: {} channels of {} bits, form {}{}; allowed: one channel of 32-bit float or of 8 "
                            "or 16 bits without sign, in strips",
                            where, channels, bits, form, TIFFIsTiled(tiff.get()) ? ", in tiles" : ""));
  if (rows == 0 || columns == 0 || size_t{rows} * columns > kMaxPixels)
    throw Error(fmt::format("{}: {} x {} pixels; allowed: 1 to 16 million", where, columns, rows));
  TiffImage image{static_cast<int>(rows), static_cast<int>(columns), std::vector<float>(size_t{rows} * columns), {}};
  std::vector<unsigned char> row(static_cast<size_t>(TIFFScanlineSize64(tiff.get())));
  if (row.size() < size_t{columns} * bits / 8) throw Error(where + ": its rows are damaged");
  for (uint32_t j = 0; j < rows; ++j) {
    if (TIFFReadScanline(tiff.get(), row.data(), j) < 0)
      throw Error(fmt::format("{}: the file is damaged or cut off at row {}", where, j));
    Widen(row, bits, &image.values[size_t{j} * columns], image.columns);
  }
  ReadPlace(tiff.get(), image, where);
  return image;
}

void WriteTiff(const TiffImage& image, const std::filesystem::path& file) {
  SAND_CHECK(image.values.size() == static_cast<size_t>(image.rows) * static_cast<size_t>(image.columns));
  AtomicFile target(file);
  TiffFile tiff = Open(target.temporary(), "w");
  const auto check = [&](bool good) {
    if (!good) throw Error("cannot write " + file.string() + ": is the disk full?");
  };
  check(tiff != nullptr);
  const auto set = [&](uint32_t tag, auto... value) { check(TIFFSetField(tiff.get(), tag, value...) == 1); };
  set(TIFFTAG_IMAGEWIDTH, image.columns);
  set(TIFFTAG_IMAGELENGTH, image.rows);
  set(TIFFTAG_BITSPERSAMPLE, 32);
  set(TIFFTAG_SAMPLESPERPIXEL, 1);
  set(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  set(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  set(TIFFTAG_ROWSPERSTRIP, image.rows);
  if (image.pixel_size) {
    const double scale[3] = {*image.pixel_size, *image.pixel_size, 0};
    const double tie[6] = {0, 0, 0, 0, image.rows * *image.pixel_size, 0};
    const uint16_t keys[8] = {1, 1, 0, 1, 1025, 0, 1, 1};  // GTRasterType: pixel is area
    set(kPixelScale, 3, scale);
    set(kTiepoint, 6, tie);
    set(kGeoKeys, 8, keys);
  }
  for (int j = 0; j < image.rows; ++j) {
    auto* row = const_cast<float*>(&image.values[static_cast<size_t>(j) * static_cast<size_t>(image.columns)]);
    check(TIFFWriteScanline(tiff.get(), row, static_cast<uint32_t>(j)) == 1);
  }
  check(TIFFFlush(tiff.get()) == 1);
  tiff.reset();
  target.Commit();
}

}  // namespace sandwright
