#include "agents/rank_guard.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "agents/run_folder.h"

namespace sandwright {
namespace {

// FNV-1a, 64 bit.
template <class T>
std::string Fingerprint(std::span<const T> values) {
  uint64_t hash = 14695981039346656037ull;
  for (const std::byte b : std::as_bytes(values))
    hash = (hash ^ static_cast<uint64_t>(b)) * 1099511628211ull;
  return fmt::format("{:016x}", hash);
}

}  // namespace

void RankGuard::Keep(Safetensors complete, int64_t steps) {
  if (ranks_.size() == 1) return;
  std::map<std::string, std::string> fingerprints;
  for (const auto& [name, tensor] : complete.tensors)
    fingerprints[name] = Fingerprint<float>(tensor.values);
  for (const auto& [name, text] : complete.metadata) fingerprints[name] = Fingerprint<char>(text);
  CheckAlike(ranks_, fingerprints, fmt::format("after {} steps", steps));
  complete_ = std::move(complete);
  steps_ = steps;
}

void RankGuard::Rescue(const Error& fault) const {
  if (ranks_.size() == 1 || steps_ < 0) throw fault;
  // One after the other, so that the first writes and the rest find it there: which of them are left,
  // none can know. All of them wait less than the second that launchers give.
  std::this_thread::sleep_for(std::chrono::milliseconds(std::min(20 * ranks_.rank(), 400)));
  const bool there = HasCheckpoint(steps_, folder_);
  if (!there) {
    MakeRunFolder(folder_);
    WriteCheckpoint(complete_, steps_, folder_);
  }
  if (there && !ranks_.leads()) spdlog::set_level(spdlog::level::off);
  throw Error(fmt::format("{}; the last complete update is kept: continue after {} steps with --resume {}",
                          fault.what(), steps_, folder_.string()),
              fault.kind());
}

}  // namespace sandwright
