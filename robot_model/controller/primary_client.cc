#include "robot_model/controller/primary_client.h"

#include "data/base/error.h"
#include "robot_model/controller/script_rules.h"

namespace sandwright {
namespace {

using namespace std::chrono_literals;

constexpr auto kConnectTime = 5s, kCalibrationTime = 5s, kSendTime = 2s;
constexpr size_t kEventsKept = 256;

}  // namespace

PrimaryClient::PrimaryClient(const std::string& host, uint16_t port)
    : stream_(host, port, kConnectTime) {
  thread_ = std::thread([this] { Read(); });
  std::unique_lock lock(mutex_);
  calibrated_.wait_for(lock, kCalibrationTime,
                       [this] { return kinematics_ || link_ != LinkState::kOpen; });
  if (kinematics_) return;
  const std::string what = link_ == LinkState::kOpen
                               ? "the arm's calibration (KINEMATICS_INFO) does not come within 5 s"
                               : std::string("connection ") + Name(link_);
  // The destructor does not run for an object that was not finished.
  lock.unlock();
  ends_ = true;
  stream_.Shutdown();
  thread_.join();
  throw Error("primary interface of " + stream_.peer() + ": " + what);
}

PrimaryClient::~PrimaryClient() {
  ends_ = true;
  stream_.Shutdown();
  thread_.join();
}

void PrimaryClient::Read() {
  PacketFramer framer(kPrimaryFormat);
  LinkState link = LinkState::kOpen;
  while (!ends_ && link == LinkState::kOpen) {
    const auto received = stream_.Read(Clock::now() + 100ms);
    link = received.link;
    framer.Feed(received.bytes);
    while (const auto packet = framer.Next()) {
      const auto items = ParsePrimaryPacket(*packet);
      if (!items) link = LinkState::kCorrupt;
      else
        for (const PrimaryItem& item : *items) Keep(item);
    }
    if (framer.broken()) link = LinkState::kCorrupt;
  }
  const std::lock_guard lock(mutex_);
  link_ = link;
  calibrated_.notify_all();
}

void PrimaryClient::Keep(const PrimaryItem& item) {
  const std::lock_guard lock(mutex_);
  if (const auto* info = std::get_if<KinematicsInfo>(&item)) {
    kinematics_ = *info;
    calibrated_.notify_all();
  } else {
    events_.push_back(item);
    if (events_.size() > kEventsKept) events_.pop_front();
  }
}

KinematicsInfo PrimaryClient::kinematics() const {
  const std::lock_guard lock(mutex_);
  return *kinematics_;
}

LinkState PrimaryClient::link() const {
  const std::lock_guard lock(mutex_);
  return link_;
}

std::optional<PrimaryItem> PrimaryClient::TakeEvent() {
  const std::lock_guard lock(mutex_);
  if (events_.empty()) return std::nullopt;
  PrimaryItem item = std::move(events_.front());
  events_.pop_front();
  return item;
}

void PrimaryClient::ClearEvents() {
  const std::lock_guard lock(mutex_);
  events_.clear();
}

bool PrimaryClient::SendScript(const std::string& text, const std::string& name) {
  SAND_CHECK(ScriptFaults(text, name).empty(), name);
  return stream_.Write(text, Clock::now() + kSendTime);
}

}  // namespace sandwright
