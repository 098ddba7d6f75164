// The dashboard's lines as values. Wording and case changed between versions of PolyScope, so that
// they are matched loosely, by what cannot be mistaken.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "robot_model/controller/arm_state.h"
#include "robot_model/controller/rtde.h"

namespace sandwright {

// Lines out of a byte stream, without their ends (\n or \r\n). Bytes that are not printable ASCII
// become '?'. A line beyond kLongest breaks the framer for good.
class LineFramer {
 public:
  static constexpr size_t kLongest = 4096;

  void Feed(std::span<const uint8_t> bytes);
  std::optional<std::string> Next();
  bool broken() const { return broken_; }
  size_t held_bytes() const { return buffer_.size(); }

 private:
  std::string buffer_;
  bool broken_ = false;
};

// Each gives none where the line is not an answer to that question.
bool IsDashboardBanner(const std::string& line);
std::optional<RobotMode> ParseRobotMode(const std::string& line);      // "Robotmode: RUNNING"
std::optional<SafetyMode> ParseSafetyMode(const std::string& line);    // "Safetymode: NORMAL"
std::optional<bool> ParseProgramRunning(const std::string& line);      // "Program running: false"
std::optional<std::string> ParseProgramState(const std::string& line);  // "STOPPED name" -> STOPPED
// "URSoftware 3.15.8.106339 (Mar 01 2022)"; numbers that are missing are 0.
std::optional<ControllerVersion> ParsePolyscopeVersion(const std::string& line);
bool IsStopped(const std::string& line);  // the answer to `stop`

}  // namespace sandwright
