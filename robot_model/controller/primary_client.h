// The primary connection: a thread of its own keeps it drained, scripts go out on it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "robot_model/controller/primary.h"
#include "robot_model/controller/tcp_stream.h"

namespace sandwright {

// The controller drops a script whose sender does not read, and stops sending to one that falls
// behind; so the thread reads whatever the owner does. Once lost, a connection stays lost.
class PrimaryClient {
 public:
  // Connects and waits for the calibration, which comes with the first state. Throws Error where
  // either does not come.
  PrimaryClient(const std::string& host, uint16_t port);
  ~PrimaryClient();

  const std::string& peer() const { return stream_.peer(); }
  KinematicsInfo kinematics() const;  // the last one that was sent
  LinkState link() const;

  // The oldest item that was not taken yet, calibrations aside; none where there is none. At most
  // 256 wait, older ones are dropped.
  std::optional<PrimaryItem> TakeEvent();
  void ClearEvents();

  // Hands a script over, once. False where it could not be sent whole. Whether it runs is told by
  // events (ScriptProgress). `text` must be in order (ScriptFaults; SAND_CHECK).
  bool SendScript(const std::string& text, const std::string& name);

 private:
  void Read();
  void Keep(const PrimaryItem& item);

  TcpStream stream_;

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable calibrated_;
  std::deque<PrimaryItem> events_;
  std::optional<KinematicsInfo> kinematics_;
  LinkState link_ = LinkState::kOpen;

  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace sandwright
