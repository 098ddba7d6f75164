#include "robot_model/camera_source.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "data/base/error.h"
#include "data/base/process.h"
#include "data/base/stop.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kPoll = std::chrono::milliseconds(50);
constexpr auto kSettled = std::chrono::milliseconds(200);  // a file that still grows is newer

// Frames in `folder` written after `since` and not touched for a while, oldest first.
std::vector<fs::path> NewFrames(const fs::path& folder, fs::file_time_type since) {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  const auto now = fs::file_time_type::clock::now();
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".png" && extension != ".npy") continue;
    std::error_code gone;
    const auto time = entry.last_write_time(gone);
    if (!gone && time > since && now - time > kSettled) found.emplace_back(time, entry.path());
  }
  std::ranges::sort(found);
  std::vector<fs::path> files;
  for (auto& [time, file] : found) files.push_back(std::move(file));
  return files;
}

std::vector<DepthFrame> Read(const std::vector<fs::path>& files, const CameraSource& source) {
  std::vector<DepthFrame> frames;
  for (const fs::path& file : files) {
    if (std::ssize(frames) == source.frames) break;
    frames.push_back(ReadDepthFrame(file, source.unit));
  }
  return frames;
}

std::vector<DepthFrame> FromCommand(const CameraSource& source) {
  const TemporaryFolder work, frames;
  const auto until = Clock::now() + std::chrono::duration<double>(source.timeout_s);
  const int status = RunProgram(
      {"sh", "-c", fmt::format("SANDWRIGHT_FRAMES='{}'; export SANDWRIGHT_FRAMES; {}",
                               frames.path().string(), source.command)},
      work.path(), [&] { return StopRequested() || Clock::now() > until; });
  if (status != 0)
    throw Error(fmt::format("camera.source.command: exit status {}; needs 0", status));
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(frames.path())) files.push_back(entry.path());
  std::ranges::sort(files);
  if (std::ssize(files) < source.frames)
    throw Error(fmt::format("camera.source.command left {} frames; {} are needed", files.size(),
                            source.frames));
  return Read(files, source);
}

std::vector<DepthFrame> FromFolder(const CameraSource& source) {
  if (!fs::is_directory(source.folder))
    throw Error("camera.source.folder " + source.folder + " is no folder");
  const auto since = fs::file_time_type::clock::now();
  const auto until = Clock::now() + std::chrono::duration<double>(source.timeout_s);
  for (;;) {
    const auto files = NewFrames(source.folder, since);
    if (std::ssize(files) >= source.frames) return Read(files, source);
    if (Clock::now() > until)
      throw Error(fmt::format("camera.source.folder {}: {} new frames in {:.0f} s; {} are needed",
                              source.folder, files.size(), source.timeout_s, source.frames));
    ThrowIfStopRequested();
    std::this_thread::sleep_for(kPoll);
  }
}

}  // namespace

std::vector<DepthFrame> TakeFrames(const CameraSource& source) {
  if (source.command.empty() && source.folder.empty())
    throw Error("camera.source: neither command nor folder is set in the workcell");
  return source.command.empty() ? FromFolder(source) : FromCommand(source);
}

}  // namespace sandwright
