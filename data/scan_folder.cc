#include "data/scan_folder.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

// The map, or an Error with the first reason.
HeightMap ReadScan(const std::filesystem::path& file, const ScanFolderConfig& config) {
  const std::string kind = file.extension().string();
  if (kind == ".h5") return ReadHeightMap(file);
  ScanResult result;
  if (kind == ".png" || ReadNumpy(file).dtype == "u2") {
    const DepthFrame frame = ReadDepthFrame(file);
    result = ScanDepth({&frame, 1}, config.camera, config.scan);
  } else {
    ScanConfig scan = config.scan;
    scan.cell_size_m = config.heights_cell_m;
    result = ScanHeights(ReadNumpy(file), config.heights_unit_m, scan);
  }
  if (!result.accepted) throw Error(result.reasons.front());
  return std::move(result.map);
}

}  // namespace

ScanFolder ReadScanFolder(const std::filesystem::path& folder, const ScanFolderConfig& config) {
  if (!std::filesystem::is_directory(folder)) throw Error(folder.string() + ": no such folder");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".h5" || kind == ".png" || kind == ".npy" || kind == ".npz")
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  ScanFolder found;
  for (const auto& file : files) {
    try {
      found.maps.push_back(ReadScan(file, config));
      found.files.push_back(file.filename().string());
    } catch (const Error& refused) {
      found.refusals.push_back(fmt::format("{}: {}", file.filename().string(), refused.what()));
    }
  }
  if (found.maps.empty())
    throw Error(fmt::format("{}: none of {} scans (.h5, .png, .npy, .npz) is accepted{}",
                            folder.string(), files.size(),
                            files.empty() ? "" : "; " + found.refusals.front()));
  return found;
}

}  // namespace sandwright
