#include "robot_model/controller/dashboard.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace sandwright {
namespace {

// Upper case, with blanks and underscores gone: "Safeguard Stop" and "SAFEGUARD_STOP" are one.
std::string Plain(const std::string& text) {
  std::string plain;
  for (const char c : text)
    if (c != ' ' && c != '_' && c != '\t')
      plain += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return plain;
}

// What follows `label` (plain); none where the line begins otherwise.
std::optional<std::string> After(const std::string& line, const std::string& label) {
  const std::string plain = Plain(line);
  if (!plain.starts_with(label)) return std::nullopt;
  return plain.substr(label.size());
}

template <class Mode>
std::optional<Mode> ModeNamed(const std::string& name, int32_t first, int32_t last) {
  for (int32_t value = first; value <= last; ++value)
    if (Plain(Name(static_cast<Mode>(value))) == name) return static_cast<Mode>(value);
  return std::nullopt;
}

}  // namespace

void LineFramer::Feed(std::span<const uint8_t> bytes) {
  if (!broken_) buffer_.append(bytes.begin(), bytes.end());
}

std::optional<std::string> LineFramer::Next() {
  const size_t end = buffer_.find('\n');
  if (std::min(end, buffer_.size()) > kLongest) {
    broken_ = true;
    buffer_.clear();
  }
  if (broken_ || end == std::string::npos) return std::nullopt;
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  if (line.ends_with('\r')) line.pop_back();
  for (char& c : line)
    if (c < 0x20 || c > 0x7e) c = '?';
  return line;
}

bool IsDashboardBanner(const std::string& line) {
  return Plain(line).find("DASHBOARDSERVER") != std::string::npos;
}

std::optional<RobotMode> ParseRobotMode(const std::string& line) {
  const auto name = After(line, "ROBOTMODE:");
  return name ? ModeNamed<RobotMode>(*name, -1, 8) : std::nullopt;
}

std::optional<SafetyMode> ParseSafetyMode(const std::string& line) {
  const auto name = After(line, "SAFETYMODE:");
  return name ? ModeNamed<SafetyMode>(*name, 1, 9) : std::nullopt;
}

std::optional<bool> ParseProgramRunning(const std::string& line) {
  for (const char* label : {"PROGRAMRUNNING:", "ROBOTRUNNING:"})
    if (const auto value = After(line, label)) {
      if (*value == "TRUE") return true;
      if (*value == "FALSE") return false;
    }
  return std::nullopt;
}

std::optional<std::string> ParseProgramState(const std::string& line) {
  for (const char* state : {"STOPPED", "PLAYING", "PAUSED"})
    if (After(line, state)) return state;
  return std::nullopt;
}

std::optional<ControllerVersion> ParsePolyscopeVersion(const std::string& line) {
  // The first number with a dot behind it; names of the software differ.
  ControllerVersion version;
  uint32_t* const parts[] = {&version.major, &version.minor, &version.bugfix, &version.build};
  const char* at = line.data();
  const char* const end = at + line.size();
  at = std::find_if(at, end, [](char c) { return c >= '0' && c <= '9'; });
  int read = 0;
  for (; read < 4; ++read) {
    const auto [next, failure] = std::from_chars(at, end, *parts[read]);
    if (failure != std::errc{}) break;
    at = next;
    if (at == end || *at != '.') {
      ++read;
      break;
    }
    ++at;
  }
  if (read < 2) return std::nullopt;
  return version;
}

bool IsStopped(const std::string& line) { return After(line, "STOPPED").has_value(); }

}  // namespace sandwright
