// The dashboard connection: questions, stop, popups.
#pragma once

#include <string>

#include "robot_model/controller/dashboard.h"
#include "robot_model/controller/tcp_stream.h"

namespace sandwright {

// What powers, unlocks or starts an arm (power on, brake release, unlock protective stop, load,
// play) is a person's to do at the pendant, so this class cannot.
//
// Questions throw Error where there is no answer in time (10 s for the banner and the first one,
// then 1 s) or the answer is another one; the connection is then of no use any more, as a late
// answer would be taken for the next one's.
class DashboardClient {
 public:
  // Throws Error where there is no dashboard.
  DashboardClient(const std::string& host, uint16_t port);

  RobotMode AskRobotMode();
  SafetyMode AskSafetyMode();
  bool AskProgramRunning();
  std::string AskProgramState();  // STOPPED, PLAYING or PAUSED
  ControllerVersion AskPolyscopeVersion();
  std::string AskRobotModel();  // "UR10"
  std::string AskSerialNumber();

  // True where the controller confirms; these never throw.
  bool Stop();
  bool ShowPopup(const std::string& text);  // control characters become blanks
  bool ClosePopup();

 private:
  // The answer to one line; none where the connection fails or takes longer than allowed.
  std::optional<std::string> Exchange(const std::string& line);
  std::optional<std::string> ReadLine(Clock::time_point deadline);
  std::string Ask(const std::string& line);
  template <class Answer>
  Answer AskFor(const std::string& line, std::optional<Answer> (*parse)(const std::string&));

  TcpStream stream_;
  LineFramer lines_;
  bool usable_ = true, asked_before_ = false;
};

}  // namespace sandwright
