// All scans of a folder that are sand.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "data/scan.h"

namespace sandwright {

// What the files of a folder do not say themselves.
struct ScanFolderConfig {
  CameraModel camera;
  double heights_unit_m = 0.001;
  double heights_cell_m = 0.0038;
  ScanConfig scan;

  void Fields(FieldList& f) {
    f.Section("camera", camera);
    f.Add("heights_unit_m", heights_unit_m, "unit of height arrays [m]", 1e-6, 1);
    f.Add("heights_cell_m", heights_cell_m,
          "cell of height arrays; a Kinect v2's pixel 1.4 m away [m]", 0.0005, 0.1);
    f.Section("scan", scan);
  }
};

struct ScanFolder {
  std::vector<HeightMap> maps;        // of accepted scans, by file name
  std::vector<std::string> files;     // their names
  std::vector<std::string> refusals;  // of the others: name and first reason
};

// Height map files (.h5), depth frames in millimetres (16-bit .png; u2 .npy, .npz) and height arrays (other
// .npy, .npz). Throws Error where the folder is missing or none is accepted.
ScanFolder ReadScanFolder(const std::filesystem::path& folder, const ScanFolderConfig& config);

}  // namespace sandwright
