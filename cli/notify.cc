#include "cli/notify.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/process.h"

namespace sandwright {
namespace {

constexpr std::chrono::seconds kLongest{30};

}  // namespace

void Notify(const NotifyConfig& config, const std::string& event, const std::string& text,
            const std::string& folder) {
  if (config.command.empty()) return;
  const TemporaryFolder output;
  const auto end = std::chrono::steady_clock::now() + kLongest;
  try {
    const int status =
        RunProgram({"env", "-C", std::filesystem::current_path().string(),
                    "SANDWRIGHT_EVENT=" + event, "SANDWRIGHT_TEXT=" + text,
                    "SANDWRIGHT_FOLDER=" + folder, "sh", "-c", config.command},
                   output.path(), [&] { return std::chrono::steady_clock::now() > end; });
    if (status != 0)
      spdlog::warn("notify.command ended with {}: {}", status,
                   ReadFile(output.path() / "output.txt"));
  } catch (const Error& e) {
    if (e.kind() == ErrorKind::kInterrupted)
      spdlog::warn("notify.command took more than {} s and was ended", kLongest.count());
    else
      spdlog::warn("notify.command: {}", e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    spdlog::warn("notify.command: {}", e.what());
  }
}

}  // namespace sandwright
