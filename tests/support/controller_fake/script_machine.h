// What a running program reaches of the controller.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "tests/support/controller_fake/connections.h"
#include "tests/support/controller_fake/controller_state.h"
#include "tests/support/controller_fake/fake_arm.h"

namespace sandwright::fake {

struct Popup {
  std::string text, title;
  bool warning = false, error = false, blocking = false;
};

// A program's wish to be told when an RTDE input is not written often enough.
struct RtdeWatchdog {
  double longest_pause_s = 1, begun_s = 0;
  std::string action = "pause";  // ignore, pause or stop
};

// Opened by a program.
struct ScriptSocket {
  std::shared_ptr<Connection> connection;
  std::string received;
};

struct ScriptMachine {
  ControllerState& state;
  FakeArm& arm;
  std::optional<Popup> popup;  // open on the pendant
  std::map<std::string, RtdeWatchdog> watchdogs;
  std::map<std::string, ScriptSocket> sockets;
  std::function<void(const std::string&)> say;       // textmsg
  std::function<void(const Popup&)> show;            // a popup that opens
  std::function<void(const std::string&)> protect;   // protective stop, with why
};

}  // namespace sandwright::fake
