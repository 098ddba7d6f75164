// The ports that stream the controller's state and take scripts: primary (30001), secondary
// (30002), both at 10 Hz, and real-time (30003) at 125 Hz.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "tests/support/controller_fake/controller_state.h"
#include "tests/support/controller_fake/tcp_server.h"

namespace sandwright::fake {

enum class StatePort { kPrimary, kSecondary, kRealtime };

struct NoSession {};

class StateServer {
 public:
  StateServer(const std::string& address, uint16_t port, StatePort kind,
              std::array<uint32_t, 4> version, const DhParameters& dh,
              const ControllerState& state, std::function<void(const std::string&)> on_script);

  TcpServer<NoSession>& sockets() { return sockets_; }
  void SendSplit(bool split) { manner_.split = split; }

  void Serve();
  // Once a control period.
  void Publish();
  // A robot message to all clients (primary only; the others do not send them).
  void Broadcast(const std::string& packet);

 private:
  TcpServer<NoSession> sockets_;
  StatePort kind_;
  std::array<uint32_t, 4> version_;
  DhParameters dh_;
  const ControllerState& state_;
  std::function<void(const std::string&)> on_script_;
  SendManner manner_;
  int periods_ = 0;
};

}  // namespace sandwright::fake
