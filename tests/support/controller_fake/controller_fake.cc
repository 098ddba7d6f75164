#include "tests/support/controller_fake/controller_fake.h"


#include <poll.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "tests/support/controller_fake/dashboard_server.h"
#include "tests/support/controller_fake/rtde_server.h"
#include "tests/support/controller_fake/state_server.h"

namespace sandwright {
namespace {

using Clock = std::chrono::steady_clock;
using fake::ControllerCore;

// A machine that was busy for longer catches up no more.
constexpr auto kLargestLag = std::chrono::milliseconds(200);

std::chrono::duration<double> Seconds(double seconds) {
  return std::chrono::duration<double>(seconds);
}

}  // namespace

// The controller's thread: sockets as they become ready, a control period when it is due.
class ControllerFake::Servers {
 public:
  explicit Servers(const ControllerFakeOptions& options)
      : options_(options),
        core_(options),
        dashboard_(options, core_),
        primary_(State(options.ports.primary, fake::StatePort::kPrimary)),
        secondary_(State(options.ports.secondary, fake::StatePort::kSecondary)),
        realtime_(State(options.ports.realtime, fake::StatePort::kRealtime)),
        rtde_(options.address, options.ports.rtde, options.version, core_.state(),
              [this](double fraction) { core_.SetSlider(fraction); }),
        ports_{dashboard_.sockets().port(), primary_.sockets().port(), secondary_.sockets().port(),
               realtime_.sockets().port(), rtde_.sockets().port()},
        thread_([this] { Run(); }) {}

  ~Servers() {
    ended_ = true;
    thread_.join();
  }

  const ControllerPorts& ports() const { return ports_; }

  template <class Act>
  auto Locked(Act&& act) {
    const std::lock_guard lock(mutex_);
    return act(*this);
  }

  ControllerCore& core() { return core_; }
  fake::RtdeServer& rtde() { return rtde_; }

  void CloseAll(bool reset) {
    for (auto* server : {&primary_, &secondary_, &realtime_}) server->sockets().CloseAll(reset);
    dashboard_.sockets().CloseAll(reset);
    rtde_.sockets().CloseAll(reset);
  }

  void Split(bool split) {
    for (auto* server : {&primary_, &secondary_, &realtime_}) server->SendSplit(split);
    rtde_.faults().manner.split = split;
  }

 private:
  fake::StateServer State(uint16_t port, fake::StatePort kind) {
    return {options_.address, port, kind, options_.version, options_.dh, core_.state(),
            [this](const std::string& script) { core_.Upload(script); }};
  }

  void Run() {
    const auto period = std::chrono::duration_cast<Clock::duration>(
        Seconds(fake::kControlPeriod_s / options_.time_factor));
    auto due = Clock::now() + period;
    std::vector<pollfd> polls;
    while (!ended_) {
      polls.clear();
      Locked([&](auto&) { AddPolls(polls); });
      const auto left = std::chrono::ceil<std::chrono::microseconds>(due - Clock::now()).count();
      const timespec wait{0, std::max<int64_t>(left, 0) * 1000};
      ppoll(polls.data(), polls.size(), &wait, nullptr);
      const std::lock_guard lock(mutex_);
      Serve();
      if (Clock::now() < due) continue;
      Tick();
      due = std::max(due + period, Clock::now() - kLargestLag);
    }
  }

  void AddPolls(std::vector<pollfd>& polls) {
    dashboard_.sockets().AddPolls(polls);
    for (auto* server : {&primary_, &secondary_, &realtime_}) server->sockets().AddPolls(polls);
    rtde_.sockets().AddPolls(polls);
  }

  void Serve() {
    dashboard_.Serve();
    for (auto* server : {&primary_, &secondary_, &realtime_}) server->Serve();
    rtde_.Serve();
  }

  void Tick() {
    core_.Tick();
    for (const std::string& packet : core_.TakePackets()) primary_.Broadcast(packet);
    for (auto* server : {&primary_, &secondary_, &realtime_}) server->Publish();
    rtde_.Publish();
  }

  ControllerFakeOptions options_;
  std::mutex mutex_;
  ControllerCore core_;
  fake::DashboardServer dashboard_;
  fake::StateServer primary_, secondary_, realtime_;
  fake::RtdeServer rtde_;
  ControllerPorts ports_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

ControllerFake::ControllerFake(const ControllerFakeOptions& options)
    : servers_(std::make_unique<Servers>(options)) {}
ControllerFake::~ControllerFake() = default;

const ControllerPorts& ControllerFake::ports() const { return servers_->ports(); }

void ControllerFake::WithCore(const std::function<void(ControllerCore&)>& act) {
  servers_->Locked([&](auto& servers) { act(servers.core()); });
}

JointAngles ControllerFake::joints() const { return state().q; }
fake::ControllerState ControllerFake::state() const {
  return servers_->Locked([](auto& servers) { return servers.core().state(); });
}
bool ControllerFake::ProgramRunning() const {
  return servers_->Locked([](auto& servers) { return servers.core().ProgramRunning(); });
}
std::vector<std::string> ControllerFake::scripts() const {
  return servers_->Locked([](auto& servers) { return servers.core().scripts(); });
}
std::vector<std::string> ControllerFake::messages() const {
  return servers_->Locked([](auto& servers) { return servers.core().messages(); });
}
std::vector<fake::TracePoint> ControllerFake::trace() const {
  return servers_->Locked([](auto& servers) { return servers.core().trace(); });
}
std::optional<fake::ScriptFault> ControllerFake::last_fault() const {
  return servers_->Locked([](auto& servers) { return servers.core().last_fault(); });
}
uint64_t ControllerFake::rtde_frames_sent() const {
  return servers_->Locked([](auto& servers) { return servers.rtde().frames_sent(); });
}

void ControllerFake::SetSlider(double fraction) {
  WithCore([&](ControllerCore& core) { core.SetSlider(fraction); });
}
void ControllerFake::PausePendant() {
  WithCore([](ControllerCore& core) { core.Pause(); });
}
void ControllerFake::ResumePendant() {
  WithCore([](ControllerCore& core) { core.Play(); });
}
void ControllerFake::StopPendant() {
  WithCore([](ControllerCore& core) { core.StopProgram(); });
}
void ControllerFake::AnswerPopup(bool go_on) {
  WithCore([&](ControllerCore& core) { core.AnswerPopup(go_on); });
}
void ControllerFake::StartForeignProgram(const std::string& name) {
  WithCore([&](ControllerCore& core) {
    core.Upload("def " + name + "():\n  while True:\n    sync()\n  end\nend\n");
  });
}
void ControllerFake::SafeguardStop(bool active) {
  WithCore([&](ControllerCore& core) { core.SafeguardStop(active); });
}
void ControllerFake::EmergencyStop(bool pressed) {
  WithCore([&](ControllerCore& core) { core.EmergencyStop(pressed); });
}
void ControllerFake::ProtectiveStop() {
  WithCore([](ControllerCore& core) { core.ProtectiveStop("collision"); });
}
void ControllerFake::ForceSpike(double newton, double duration_s) {
  WithCore([&](ControllerCore& core) { core.ForceSpike(newton, duration_s); });
}
void ControllerFake::RejectScripts(bool reject) {
  WithCore([&](ControllerCore& core) { core.RejectScripts(reject); });
}
void ControllerFake::SwallowKeyMessages(bool swallow) {
  WithCore([&](ControllerCore& core) { core.key_faults().swallow = swallow; });
}
void ControllerFake::DelayKeyMessages(double delay_s) {
  WithCore([&](ControllerCore& core) { core.key_faults().delay_s = delay_s; });
}
void ControllerFake::JogTo(const JointAngles& q) {
  WithCore([&](ControllerCore& core) { core.arm().Place(q); });
}
void ControllerFake::StallRtde(double duration_s) {
  servers_->Locked([&](auto& servers) {
    servers.rtde().faults().silent_until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(Seconds(duration_s));
  });
}
void ControllerFake::CloseConnections(bool reset) {
  servers_->Locked([&](auto& servers) { servers.CloseAll(reset); });
}
void ControllerFake::SplitBytes(bool split) {
  servers_->Locked([&](auto& servers) { servers.Split(split); });
}
void ControllerFake::CoalesceFrames(bool coalesce) {
  servers_->Locked([&](auto& servers) { servers.rtde().faults().manner.coalesce = coalesce; });
}
void ControllerFake::HideVariable(const std::string& name) {
  servers_->Locked([&](auto& servers) { servers.rtde().faults().not_found.insert(name); });
}
void ControllerFake::OccupyInput(const std::string& name) {
  servers_->Locked([&](auto& servers) { servers.rtde().faults().in_use.insert(name); });
}
void ControllerFake::SpeakOnlyProtocol1() {
  servers_->Locked([](auto& servers) { servers.rtde().faults().newest_protocol = 1; });
}

}  // namespace sandwright
