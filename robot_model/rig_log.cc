#include "robot_model/rig_log.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/utc_time.h"

namespace sandwright {
namespace {

constexpr const char* kEvents = "events.jsonl";

const char* NameOf(GatedMotion::Kind kind) {
  switch (kind) {
    case GatedMotion::Kind::kStroke: return "stroke";
    case GatedMotion::Kind::kTransfer: return "transfer";
    case GatedMotion::Kind::kLift: return "lift";
  }
  return "";
}

std::vector<double> List(const JointAngles& q) { return {q.rad.begin(), q.rad.end()}; }

nlohmann::json Describe(const GatedMotion& motion) {
  nlohmann::json json = {{"kind", NameOf(motion.kind())},
                         {"from_rad", List(motion.start())},
                         {"to_rad", List(motion.end())},
                         {"duration_s", motion.duration_s()}};
  if (motion.kind() != GatedMotion::Kind::kStroke) return json;
  nlohmann::json points = nlohmann::json::array();
  for (const auto& p : motion.stroke().control_points_m) points.push_back({p.x(), p.y(), p.z()});
  json["stroke"] = {{"control_points_m", points},
                    {"degree", motion.stroke().degree},
                    {"speed_mps", motion.stroke().speed_mps}};
  json["branch"] = motion.stroke_motion().branch;
  return json;
}

}  // namespace

bool RigLog::Exists(const std::filesystem::path& folder) {
  const auto events = folder / kEvents;
  return std::filesystem::exists(events) && ReadFile(events).find('\n') != std::string::npos;
}

RigLog::RigLog(std::filesystem::path folder, bool resume) : folder_(std::move(folder)) {
  const auto events = folder_ / kEvents;
  const bool exists = Exists(folder_);
  if (exists && !resume)
    throw Error(folder_.string() + " holds a log: give another folder, or --resume it");
  if (!exists && resume) throw Error(folder_.string() + " holds no log (" + kEvents + ")");
  std::error_code failed;
  for (const char* kind : {"scans", "motions"})
    std::filesystem::create_directories(folder_ / kind, failed);
  if (failed) throw Error(fmt::format("{}: {}", folder_.string(), failed.message()));
  if (std::filesystem::exists(events)) {
    const std::string text = ReadFile(events);
    if (!text.ends_with('\n'))  // a line that a power cut left half-written
      WriteFileAtomically(events, text.substr(0, text.rfind('\n') + 1));
  }
  file_ = ::open(events.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0) throw Error(fmt::format("{}: {}", events.string(), std::strerror(errno)));
}

RigLog::~RigLog() { ::close(file_); }

void RigLog::Add(const std::string& event, const nlohmann::json& content) {
  nlohmann::json line = {{"time", UtcNow()}, {"event", event}};
  line.update(content);
  const std::string text = line.dump() + "\n";
  for (size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file_, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw Error(fmt::format("{}: {}; nothing moves without a log", (folder_ / kEvents).string(),
                              std::strerror(errno)));
    done += static_cast<size_t>(n);
  }
  if (::fsync(file_) != 0)
    throw Error(fmt::format("{}: {}; nothing moves without a log", (folder_ / kEvents).string(),
                            std::strerror(errno)));
}

std::string RigLog::NextFile(const std::string& kind, const std::string& extension) {
  for (int number = 0;; ++number) {
    const std::string name = fmt::format("{}/{:04}.{}", kind, number, extension);
    if (!std::filesystem::exists(folder_ / name)) return name;
  }
}

void RigLog::AddScan(const ScanResult& scan) {
  nlohmann::json event = {{"accepted", scan.accepted},
                          {"reasons", scan.reasons},
                          {"warnings", scan.warnings},
                          {"invalid_share", scan.invalid_share},
                          {"noise_mm", scan.noise_mm}};
  if (scan.accepted) {
    event["file"] = NextFile("scans", "h5");
    WriteHeightMap(scan.map, folder_ / event["file"].get<std::string>());
  }
  Add("scan", event);
}

void RigLog::AddStroke(const StrokeFile& head, StrokeRecord record) {
  const auto file = folder_ / "strokes.h5";
  StrokeFile content = std::filesystem::exists(file) ? ReadStrokeFile(file) : head;
  if (sequence_ < 0)
    sequence_ = content.strokes.empty() ? 0 : content.strokes.back().sequence + 1;
  record.sequence = sequence_;
  record.step = step_++;
  record.time = UtcNow();
  content.strokes.push_back(std::move(record));
  WriteStrokeFile(content, file);
}

std::vector<nlohmann::json> RigLog::ReadEvents(const std::filesystem::path& folder) {
  const auto file = folder / kEvents;
  if (!std::filesystem::exists(file))
    throw Error(folder.string() + " holds no log (" + kEvents + ")");
  const std::string text = ReadFile(file);
  std::istringstream lines(text);
  std::vector<nlohmann::json> events;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (lines.eof() && !text.ends_with('\n')) break;
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (!event.is_object() || !event.contains("event") || !event["event"].is_string())
      throw Error(fmt::format("{}: line {} is no event", file.string(), number));
    events.push_back(event);
  }
  return events;
}

Execution LoggedRig::Execute(const GatedMotion& motion, const ExecuteOptions& options) {
  const std::string file = log_.NextFile("motions", "csv");
  nlohmann::json intention = Describe(motion);
  intention["file"] = file;
  intention["speed_share"] = options.speed_share;
  log_.Add("motion", intention);
  Execution execution = rig_.Execute(motion, options);
  WriteArmRecord(execution.record, log_.folder() / file);
  log_.Add("moved", {{"file", file},
                     {"end", execution.end},
                     {"reason", execution.reason},
                     {"samples", execution.record.size()}});
  return execution;
}

DepthView LoggedRig::Look() {
  DepthView view = rig_.Look();
  log_.Add("look", {{"frames", view.frames.size()}, {"joints_rad", List(rig_.Joints())}});
  return view;
}

}  // namespace sandwright
