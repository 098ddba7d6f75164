#include "robot_model/controller/dashboard_client.h"

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

using namespace std::chrono_literals;

constexpr auto kConnectTime = 5s, kFirstTime = 10s, kLaterTime = 1s;

}  // namespace

DashboardClient::DashboardClient(const std::string& host, uint16_t port)
    : stream_(host, port, kConnectTime) {
  const auto banner = ReadLine(Clock::now() + kFirstTime);
  if (!banner || !IsDashboardBanner(*banner))
    throw Error("dashboard of " + stream_.peer() + ": it answers " +
                (banner ? "'" + *banner + "'" : "nothing") +
                "; expected 'Connected: Universal Robots Dashboard Server'");
}

std::optional<std::string> DashboardClient::ReadLine(Clock::time_point deadline) {
  for (;;) {
    if (auto line = lines_.Next()) return line;
    if (lines_.broken()) return std::nullopt;
    const auto received = stream_.Read(deadline);
    if (received.bytes.empty()) return std::nullopt;
    lines_.Feed(received.bytes);
  }
}

std::optional<std::string> DashboardClient::Exchange(const std::string& line) {
  if (!usable_) return std::nullopt;
  const auto deadline = Clock::now() + (asked_before_ ? kLaterTime : kFirstTime);
  asked_before_ = true;
  std::optional<std::string> answer;
  if (stream_.Write(line + "\n", deadline)) answer = ReadLine(deadline);
  usable_ = answer.has_value();
  return answer;
}

std::string DashboardClient::Ask(const std::string& line) {
  const auto answer = Exchange(line);
  if (!answer) throw Error("dashboard of " + stream_.peer() + ": no answer to '" + line + "'");
  return *answer;
}

template <class Answer>
Answer DashboardClient::AskFor(const std::string& line,
                               std::optional<Answer> (*parse)(const std::string&)) {
  const std::string answer = Ask(line);
  const auto value = parse(answer);
  if (!value) {
    usable_ = false;
    throw Error("dashboard of " + stream_.peer() + ": '" + line + "' is answered '" + answer + "'");
  }
  return *value;
}

RobotMode DashboardClient::AskRobotMode() { return AskFor("robotmode", &ParseRobotMode); }
SafetyMode DashboardClient::AskSafetyMode() { return AskFor("safetymode", &ParseSafetyMode); }
bool DashboardClient::AskProgramRunning() { return AskFor("running", &ParseProgramRunning); }
std::string DashboardClient::AskProgramState() {
  return AskFor("programState", &ParseProgramState);
}
ControllerVersion DashboardClient::AskPolyscopeVersion() {
  return AskFor("PolyscopeVersion", &ParsePolyscopeVersion);
}
std::string DashboardClient::AskRobotModel() { return Ask("get robot model"); }
std::string DashboardClient::AskSerialNumber() { return Ask("get serial number"); }

bool DashboardClient::Stop() {
  const auto answer = Exchange("stop");
  return answer && IsStopped(*answer);
}

bool DashboardClient::ShowPopup(const std::string& text) {
  // A line break in the text would be a command of its own.
  std::string line = text;
  std::replace_if(line.begin(), line.end(), [](char c) { return c < 0x20 || c > 0x7e; }, ' ');
  return Exchange("popup " + line).has_value();
}

bool DashboardClient::ClosePopup() { return Exchange("close popup").has_value(); }

}  // namespace sandwright
