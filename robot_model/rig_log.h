// What happened on a rig, on disk before it goes on.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "data/stroke_dataset.h"
#include "robot_model/rig.h"

namespace sandwright {

// A folder: events.jsonl (one JSON object a line, synced to disk as it is written), scans/NNNN.h5,
// motions/NNNN.csv, strokes.h5 (before and after each stroke: data for `fit`).
class RigLog {
 public:
  // Makes the folder; `resume`: goes on in one that has events. Throws Error where the folder is in
  // the other state, or cannot be written.
  RigLog(std::filesystem::path folder, bool resume);
  ~RigLog();
  // Whether `folder` holds a log that can be gone on with: an event at least.
  static bool Exists(const std::filesystem::path& folder);
  RigLog(const RigLog&) = delete;
  RigLog& operator=(const RigLog&) = delete;

  // Adds `event` and the time (UTC) to `content`. Throws Error when it is not on disk: a full disk
  // stops a run before the next motion.
  void Add(const std::string& event, const nlohmann::json& content = nlohmann::json::object());
  // The next file of a kind, relative to the folder: "scans/0003.h5".
  std::string NextFile(const std::string& kind, const std::string& extension);
  // A scan, with its map where it was accepted.
  void AddScan(const ScanResult& scan);
  // Into strokes.h5; `head` names its source and bed. The strokes of one RigLog are one sequence: what
  // happened to the sand between two of them, nobody knows.
  void AddStroke(const StrokeFile& head, StrokeRecord record);
  const std::filesystem::path& folder() const { return folder_; }

  // The events of a log in order. A last line that a power cut left half-written is left out;
  // Error naming the line where another one is no event.
  static std::vector<nlohmann::json> ReadEvents(const std::filesystem::path& folder);

 private:
  std::filesystem::path folder_;
  int file_ = -1;
  int64_t sequence_ = -1, step_ = 0;  // of the next stroke; -1: before the first one
};

// Any rig, with everything that it does and sees in the log: the intention before each motion, the
// outcome and the 125 Hz record behind it.
class LoggedRig final : public Rig {
 public:
  LoggedRig(Rig& rig, RigLog& log) : rig_(rig), log_(log) {}

  std::string name() const override { return rig_.name(); }
  bool measures_force() const override { return rig_.measures_force(); }
  JointAngles Joints() override { return rig_.Joints(); }
  Execution Execute(const GatedMotion& motion, const ExecuteOptions& options) override;
  DepthView Look() override;

 private:
  Rig& rig_;
  RigLog& log_;
};

}  // namespace sandwright
