// A run that nobody sits beside: its state as files, and what was warned of in them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "data/base/run_status.h"

namespace spdlog::sinks {
class sink;
}

namespace sandwright {

// Keeps status.json and live.html up to date while it lives.
class Watch {
 public:
  // In the folder `output`, or beside the file `output` as OUTPUT.status.json and OUTPUT.live.html.
  Watch(const std::string& command, const std::filesystem::path& output, bool folder);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  RunStatus& status() { return status_; }
  const std::filesystem::path& output() const { return output_; }

 private:
  void Write(const RunReport& report) const;

  std::filesystem::path output_;
  bool folder_;
  RunStatus status_;
  std::shared_ptr<spdlog::sinks::sink> warnings_;
};

}  // namespace sandwright
