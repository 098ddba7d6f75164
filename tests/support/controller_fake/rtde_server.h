// RTDE (port 30004), protocol versions 2 and 1, at 125 Hz.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/controller_fake/rtde_variables.h"
#include "tests/support/controller_fake/tcp_server.h"

namespace sandwright::fake {

// How this server deviates from a healthy one.
struct RtdeFaults {
  std::set<std::string> not_found;  // variables that it says it does not have
  std::set<std::string> in_use;     // inputs that it says another client holds
  int newest_protocol = 2;
  SendManner manner;
  std::chrono::steady_clock::time_point silent_until{};  // no data before
};

struct RtdeSession {
  int protocol = 1;
  std::vector<const RtdeOutput*> outputs;
  bool outputs_valid = false, started = false;
  double frequency_Hz = 125, due = 0;  // share of a frame since the last one was sent
  std::map<uint8_t, std::vector<std::string>> inputs;  // by recipe
};

class RtdeServer {
 public:
  // `version`: major, minor, bugfix, build. `set_slider` is called for a client's slider input.
  RtdeServer(const std::string& address, uint16_t port, std::array<uint32_t, 4> version,
             ControllerState& state, std::function<void(double)> set_slider);

  TcpServer<RtdeSession>& sockets() { return sockets_; }
  RtdeFaults& faults() { return faults_; }

  void Serve();
  // Once a control period: a frame to every client that has started and is due.
  void Publish();
  uint64_t frames_sent() const { return frames_sent_; }

 private:
  using RtdeClient = Client<RtdeSession>;

  void TakeFrames(RtdeClient& client);
  void Answer(RtdeClient& client, uint8_t type, std::string_view body);
  std::string SetUpOutputs(RtdeSession& session, std::string_view body);
  std::string SetUpInputs(RtdeClient& client, std::string_view body);
  void TakeInputs(RtdeSession& session, std::string_view body);
  bool HeldByAnother(const RtdeClient& client, const std::string& name);
  void SendFrame(RtdeClient& client, uint8_t type, std::string_view body);

  TcpServer<RtdeSession> sockets_;
  std::array<uint32_t, 4> version_;
  ControllerState& state_;
  std::function<void(double)> set_slider_;
  RtdeFaults faults_;
  uint64_t frames_sent_ = 0;
};

}  // namespace sandwright::fake
