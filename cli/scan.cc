// sandwright scan: depth frames or a height array to a height map in the box frame, or a refusal.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "cli/command.h"
#include "cli/scan_pose.h"
#include "data/picture.h"
#include "data/scan.h"

namespace sandwright {
namespace {

class ScanCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--depth", depth_, "depth frames, .npy or 16-bit .png, 0 = invalid; several are fused");
    app.add_option("--depth-unit", depth_unit_, "unit of their numbers: mm (default), m or 0.1mm");
    app.add_option("--heights", heights_, "or: an array of heights, .npy or .npz");
    app.add_option("--unit", unit_, "unit of its numbers: mm (default) or m");
    app.add_option("--camera", camera_file_, "camera model (YAML); not given: the nominal Kinect v2");
    app.add_option("--workcell", workcell_, "workcell; with --joints it gives the camera's pose");
    app.add_option("--joints", joints_, "YAML with joints_rad: the arm's six joint angles at the scan");
    app.add_option("--box", box_, "inner size of the box, WxH in m, the longer side first; found if not given");
    app.add_option("--level", level_, "made level: rim, sand or none (key scan.level)");
    app.add_option("--sand-depth-m", sand_depth_m_, "mean depth of the sand; sets the zero to the floor");
    app.add_option("--cell-size", cell_size_m_, "cell of the map, or the height array's own [m] (key scan.cell_size_m)");
    app.add_option("--out", out_, "height map file to write");
    app.add_option("--picture", picture_, "PNG of the heights to write");
  }
  void Fields(FieldList& f) override { f.Section("scan", config_); }

  int Run() override {
    if (depth_.empty() == heights_.empty()) throw Error("scan needs either --depth FRAME... or --heights FILE");
    FieldList fields;
    fields.Section("scan", config_);
    if (!level_.empty()) SetField(fields, "scan.level", level_);
    if (!cell_size_m_.empty()) SetField(fields, "scan.cell_size_m", cell_size_m_);
    const ScanResult result = heights_.empty() ? FromDepth() : FromHeights();
    for (const auto& warning : result.warnings) spdlog::warn("{}", warning);
    for (const auto& reason : result.reasons) spdlog::error("refused: {}", reason);
    if (result.accepted) WriteFiles(result.map);
    WriteResult(ToJson(result));
    if (result.accepted)
      fmt::print("{} x {} cells of {:.1f} mm, tilt removed {:.2f} degrees, noise {:.2f} mm, {:.2f} s\n",
                 result.map.columns, result.map.rows, 1000 * result.map.cell_size_m, result.tilt_removed_deg,
                 result.noise_mm, result.seconds);
    return result.accepted ? 0 : 3;
  }

 private:
  ScanResult FromDepth() const {
    CameraModel camera;
    if (!camera_file_.empty()) LoadYaml(FieldsOf(camera), camera_file_);
    std::vector<DepthFrame> frames;
    for (const auto& file : depth_) frames.push_back(ReadDepthFrame(file, depth_unit_));
    return ScanDepth(frames, camera, config_, PlaceOfScan(box_, workcell_, joints_, sand_depth_m_));
  }

  ScanResult FromHeights() const {
    if (!box_.empty() || !workcell_.empty() || !joints_.empty() || !camera_file_.empty())
      throw Error("--box, --camera, --workcell and --joints belong to depth frames, not to --heights");
    if (unit_ != "mm" && unit_ != "m") throw Error("--unit " + unit_ + " is not known; allowed: mm, m");
    return ScanHeights(ReadNumpy(heights_), unit_ == "mm" ? 1e-3 : 1, config_, sand_depth_m_);
  }

  void WriteFiles(const HeightMap& map) const {
    const auto [low, high] = std::ranges::minmax(map.height_m);
    if (!out_.empty()) WriteHeightMap(map, out_);
    if (!picture_.empty()) WritePicture(DrawHeights(map, low, high, std::max(1, 900 / map.columns)), picture_);
  }

  static nlohmann::json ToJson(const ScanResult& result) {
    nlohmann::json json = {{"accepted", result.accepted}, {"reasons", result.reasons},
                           {"warnings", result.warnings},
                           {"datum", result.map.datum == Datum::kFloor ? "floor" : "relative"},
                           {"cell_size_m", result.map.cell_size_m},
                           {"rows", result.map.rows}, {"columns", result.map.columns},
                           {"invalid_share", result.invalid_share},
                           {"interpolated_share", result.interpolated_share},
                           {"tilt_removed_deg", result.tilt_removed_deg},
                           {"noise_mm", result.noise_mm}, {"seconds", result.seconds}};
    for (const Eigen::Vector3d& p : result.corners_C) json["corners_camera_m"].push_back({p.x(), p.y(), p.z()});
    if (result.registration_error_m) json["registration_error_mm"] = 1000 * *result.registration_error_m;
    return json;
  }

  ScanConfig config_;
  std::vector<std::string> depth_;
  std::string depth_unit_ = "mm", heights_, unit_ = "mm", camera_file_, workcell_, joints_, box_, level_;
  std::string cell_size_m_, out_, picture_;
  std::optional<double> sand_depth_m_;
};

}  // namespace

std::unique_ptr<Command> MakeScanCommand() { return std::make_unique<ScanCommand>(); }

}  // namespace sandwright
