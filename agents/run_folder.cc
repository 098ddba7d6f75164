#include "agents/run_folder.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr size_t kKeptCheckpoints = 3;

std::filesystem::path CheckpointFile(int64_t steps, const std::filesystem::path& folder) {
  return folder / "checkpoints" / fmt::format("{:012}.safetensors", steps);
}

std::vector<std::filesystem::path> Checkpoints(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "checkpoints", missing))
    if (entry.path().extension() == ".safetensors" &&
        !entry.path().filename().string().starts_with("."))
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

}  // namespace

void MakeRunFolder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder / "checkpoints", failure);
  if (failure) throw Error("cannot make folder " + folder.string() + ": " + failure.message());
}

void WriteCheckpoint(const Safetensors& content, int64_t steps,
                     const std::filesystem::path& folder) {
  WriteSafetensors(content, CheckpointFile(steps, folder));
  const auto files = Checkpoints(folder);
  for (size_t i = 0; i + kKeptCheckpoints < files.size(); ++i) std::filesystem::remove(files[i]);
}

bool HasCheckpoint(int64_t steps, const std::filesystem::path& folder) {
  return std::filesystem::exists(CheckpointFile(steps, folder));
}

std::filesystem::path LastCheckpoint(const std::filesystem::path& folder) {
  const auto files = Checkpoints(folder);
  if (files.empty()) throw Error(folder.string() + ": no checkpoint to resume from");
  return files.back();
}

}  // namespace sandwright
