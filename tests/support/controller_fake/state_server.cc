#include "tests/support/controller_fake/state_server.h"

#include "tests/support/controller_fake/primary_packets.h"
#include "tests/support/controller_fake/script_text.h"

namespace sandwright::fake {
namespace {

constexpr size_t kMostClients = 16;
constexpr double kSlowPeriod_s = 0.1;

}  // namespace

StateServer::StateServer(const std::string& address, uint16_t port, StatePort kind,
                         std::array<uint32_t, 4> version, const DhParameters& dh,
                         const ControllerState& state,
                         std::function<void(const std::string&)> on_script)
    : sockets_(address, port, kMostClients),
      kind_(kind),
      version_(version),
      dh_(dh),
      state_(state),
      on_script_(std::move(on_script)) {
  // Clients that only upload scripts never read; sending to them is discontinued.
  manner_.drop = true;
}

void StateServer::Serve() {
  sockets_.Serve(
      [this](auto& client) {
        if (kind_ == StatePort::kRealtime) return;
        client.connection->Send(VersionPacket(state_.time_s, version_), manner_);
      },
      [this](auto& client) {
        for (const std::string& program : TakePrograms(client.received)) on_script_(program);
      },
      [](NoSession&) {});
}

void StateServer::Publish() {
  if (kind_ != StatePort::kRealtime) {
    // 12.5 periods make a tenth of a second: 12 and 13 in turn.
    const double before = periods_ * kControlPeriod_s, now = ++periods_ * kControlPeriod_s;
    if (static_cast<int64_t>(before / kSlowPeriod_s) == static_cast<int64_t>(now / kSlowPeriod_s))
      return;
  }
  if (sockets_.clients().empty()) return;
  const std::string packet =
      kind_ == StatePort::kRealtime ? RealtimePacket(state_) : RobotStatePacket(state_, dh_);
  for (auto& client : sockets_.clients()) client.connection->Send(packet, manner_);
}

void StateServer::Broadcast(const std::string& packet) {
  for (auto& client : sockets_.clients()) client.connection->Send(packet, manner_);
}

}  // namespace sandwright::fake
