#include "tests/support/controller_fake/dashboard_server.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <optional>

namespace sandwright::fake {
namespace {

constexpr size_t kMostClients = 8;

using Answer = std::function<std::string(ControllerCore&, const ControllerFakeOptions&)>;

std::string ModeName(RobotMode mode) {
  switch (mode) {
    case RobotMode::kNoController: return "NO_CONTROLLER";
    case RobotMode::kDisconnected: return "DISCONNECTED";
    case RobotMode::kConfirmSafety: return "CONFIRM_SAFETY";
    case RobotMode::kBooting: return "BOOTING";
    case RobotMode::kPowerOff: return "POWER_OFF";
    case RobotMode::kPowerOn: return "POWER_ON";
    case RobotMode::kIdle: return "IDLE";
    case RobotMode::kBackdrive: return "BACKDRIVE";
    case RobotMode::kRunning: return "RUNNING";
  }
  return "";
}

std::string SafetyName(SafetyMode mode) {
  switch (mode) {
    case SafetyMode::kNormal: return "NORMAL";
    case SafetyMode::kReduced: return "REDUCED";
    case SafetyMode::kProtectiveStop: return "PROTECTIVE_STOP";
    case SafetyMode::kRecovery: return "RECOVERY";
    case SafetyMode::kSafeguardStop: return "SAFEGUARD_STOP";
    case SafetyMode::kSystemEmergencyStop: return "SYSTEM_EMERGENCY_STOP";
    case SafetyMode::kRobotEmergencyStop: return "ROBOT_EMERGENCY_STOP";
    case SafetyMode::kViolation: return "VIOLATION";
    case SafetyMode::kFault: return "FAULT";
  }
  return "";
}

std::string ProgramState(const ControllerState& state) {
  const std::string name = state.program.empty() ? "<unnamed>" : state.program;
  if (!state.ProgramAlive()) return "STOPPED " + name;
  return (state.runtime == RuntimeState::kPaused ? "PAUSED " : "PLAYING ") + name;
}

std::string Try(bool done, const char* answer, const char* command) {
  return done ? answer : std::string("Failed to execute: ") + command;
}

const std::map<std::string, Answer>& Answers() {
  using Core = ControllerCore;
  using Options = ControllerFakeOptions;
  static const std::map<std::string, Answer> answers = {
      {"play", [](Core& c, auto&) { return Try(c.Play(), "Starting program", "play"); }},
      {"stop", [](Core& c, auto&) { return Try(c.StopProgram(), "Stopped", "stop"); }},
      {"pause", [](Core& c, auto&) { return Try(c.Pause(), "Pausing program", "pause"); }},
      {"running",
       [](Core& c, auto&) {
         return fmt::format("Program running: {}", c.state().ProgramAlive());
       }},
      {"robotmode", [](Core& c, auto&) { return "Robotmode: " + ModeName(c.state().robot_mode); }},
      {"safetymode",
       [](Core& c, auto&) { return "Safetymode: " + SafetyName(c.state().safety_mode); }},
      {"programstate", [](Core& c, auto&) { return ProgramState(c.state()); }},
      {"get loaded program",
       [](Core& c, auto&) {
         return c.loaded().empty() ? "No program loaded" : "Loaded program: " + c.loaded();
       }},
      {"issaved", [](Core& c, auto&) { return "true " + c.loaded(); }},
      {"polyscopeversion",
       [](Core&, const Options& o) {
         return fmt::format("URSoftware {}.{}.{}.{} (Jan 01 2020)", o.version[0], o.version[1],
                            o.version[2], o.version[3]);
       }},
      {"power on", [](Core& c, auto&) { return Try(c.PowerOn(), "Powering on", "power on"); }},
      {"power off",
       [](Core& c, auto&) {
         c.PowerOff();
         return std::string("Powering off");
       }},
      {"brake release",
       [](Core& c, auto&) { return Try(c.BrakeRelease(), "Brake releasing", "brake release"); }},
      {"unlock protective stop",
       [](Core& c, auto&) {
         return Try(c.UnlockProtectiveStop(), "Protective stop releasing",
                    "unlock protective stop");
       }},
      {"close popup",
       [](Core& c, auto&) {
         c.AnswerPopup(true);
         return std::string("closing popup");
       }},
      {"close safety popup", [](Core&, auto&) { return std::string("closing safety popup"); }},
      {"restart safety", [](Core&, auto&) { return std::string("Restarting safety"); }},
      {"get robot model", [](Core&, const Options& o) { return o.model; }},
      {"get serial number", [](Core&, const Options& o) { return o.serial; }},
      {"quit", [](Core&, auto&) { return std::string(); }},
  };
  return answers;
}

// What stands behind a command word, none where the line is another command.
std::optional<std::string> After(const std::string& line, const std::string& command) {
  if (!line.starts_with(command + " ")) return std::nullopt;
  return line.substr(command.size() + 1);
}

}  // namespace

std::string AnswerDashboard(const std::string& command, ControllerCore& core,
                            const ControllerFakeOptions& options) {
  std::string lower = command;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (const auto found = Answers().find(lower); found != Answers().end())
    return found->second(core, options);
  if (const auto program = After(command, "load"))
    return (core.Load(*program) ? "Loading program: " : "File not found: ") + *program;
  if (After(command, "popup")) return "showing popup";
  if (After(lower, "addtolog")) return "Added log message";
  return "could not understand: '" + command + "'";
}

DashboardServer::DashboardServer(const ControllerFakeOptions& options, ControllerCore& core)
    : options_(options),
      core_(core),
      sockets_(options.address, options.ports.dashboard, kMostClients) {}

void DashboardServer::Serve() {
  sockets_.Serve(
      [](auto& client) {
        client.connection->Send("Connected: Universal Robots Dashboard Server\n");
      },
      [this](auto& client) {
        std::string& received = client.received;
        for (size_t end; (end = received.find('\n')) != std::string::npos;) {
          std::string line = received.substr(0, end);
          received.erase(0, end + 1);
          if (line.ends_with('\r')) line.pop_back();
          const std::string answer = AnswerDashboard(line, core_, options_);
          client.connection->Send((answer.empty() ? "Disconnected" : answer) + "\n");
          if (answer.empty()) client.connection->CloseWhenSent();
        }
      },
      [](NoSession&) {});
}

}  // namespace sandwright::fake
