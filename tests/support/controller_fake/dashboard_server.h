// The dashboard (port 29999): a line in, a line out.
#pragma once

#include <string>

#include "tests/support/controller_fake/controller_core.h"
#include "tests/support/controller_fake/state_server.h"

namespace sandwright::fake {

// The answer to one command; empty for `quit`, behind which the connection ends.
std::string AnswerDashboard(const std::string& command, ControllerCore& core,
                            const ControllerFakeOptions& options);

class DashboardServer {
 public:
  DashboardServer(const ControllerFakeOptions& options, ControllerCore& core);

  TcpServer<NoSession>& sockets() { return sockets_; }
  void Serve();

 private:
  ControllerFakeOptions options_;
  ControllerCore& core_;
  TcpServer<NoSession> sockets_;
};

}  // namespace sandwright::fake
