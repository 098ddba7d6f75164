// The RTDE connection: a thread of its own takes every frame and keeps the beat.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "robot_model/controller/rtde.h"
#include "robot_model/controller/tcp_stream.h"

namespace sandwright {

struct ArmFrame {
  ArmState state;
  Clock::time_point arrival;
};

// How old the newest news of the arm is, judged by the controller's own clock going on: a
// connection that is open, or frames that repeat, say nothing.
enum class Freshness {
  kFresh,
  kStale,  // nothing new for 100 ms: stop
  kDead,   // for 2.5 s
};

// Once lost, a connection stays lost: there is no reconnection, so nothing can be sent twice.
class RtdeClient {
 public:
  static constexpr std::chrono::milliseconds kStaleAfter{100}, kDeadAfter{2500};
  // Three frames missing in a row.
  static constexpr std::chrono::milliseconds kGap{32};

  // Connects, agrees on the recipes and waits for the first frame. Throws Error where there is
  // none, protocol 2 or a name is refused, an input is in use by another client, the version is not
  // one of ours (see kOldest), or the controller has been up for less than 40 s.
  RtdeClient(const std::string& host, uint16_t port);
  ~RtdeClient();

  // 3.14.3 is the oldest CB3 version that a client kept by the maker is tested on; what we ask the
  // dashboard needs 3.12. Version 4 was never an arm's, 5 is the e-Series: another arm.
  static constexpr ControllerVersion kOldest{3, 14, 3, 0}, kBeyond{4, 0, 0, 0};
  const ControllerVersion& version() const { return version_; }

  // The oldest frame that was not taken yet, in the order of arrival; none by `deadline`. Frames
  // wait here for a second at most, older ones are dropped and counted.
  // The beat goes on only while somebody takes frames: it tells the arm that it is being watched.
  std::optional<ArmFrame> TakeFrame(Clock::time_point deadline);
  // Forgets what was not taken.
  void ClearFrames();
  ArmFrame latest() const;
  Freshness freshness() const;
  LinkState link() const;
  // Gaps of kGap or more, and frames that were dropped, malformed or not finite, so far.
  int gaps() const { return gaps_; }
  int lost_frames() const { return lost_frames_; }
  std::string last_text() const;  // of the controller's text messages; "" for none

  // ProgramRegisters::kCommand, sent at once and with every beat. False where it did not get out.
  bool SendCommand(int32_t command);

 private:
  struct Negotiation;
  void Read();
  void TakeState(const ArmState& state);
  bool SendInputs();

  TcpStream stream_;
  PacketFramer framer_{kRtdeFormat};
  ControllerVersion version_;
  uint8_t output_recipe_ = 0, input_recipe_ = 0;

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable arrived_;
  std::deque<ArmFrame> frames_;
  ArmFrame latest_;  // the last one whose timestamp was greater than the one before
  Clock::time_point watched_at_{};
  LinkState link_ = LinkState::kOpen;
  std::string last_text_;

  std::mutex write_mutex_;  // of the two numbers below and the order in which they are sent
  int32_t beat_ = 0, command_ = 0;

  std::atomic<int> gaps_ = 0, lost_frames_ = 0;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace sandwright
