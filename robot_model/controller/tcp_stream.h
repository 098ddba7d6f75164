// A TCP connection whose every call ends by a deadline.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

namespace sandwright {

using Clock = std::chrono::steady_clock;

enum class LinkState {
  kOpen,
  kClosed,   // the other side has ended it
  kReset,    // it broke
  kCorrupt,  // what arrives is not the protocol
};
const char* Name(LinkState link);

// One thread may read while another writes. Never raises SIGPIPE.
class TcpStream {
 public:
  // Throws Error naming host and port where nothing answers within `timeout`.
  TcpStream(const std::string& host, uint16_t port, std::chrono::milliseconds timeout);
  ~TcpStream();
  TcpStream(const TcpStream&) = delete;
  TcpStream& operator=(const TcpStream&) = delete;

  struct Received {
    LinkState link = LinkState::kOpen;
    std::span<const uint8_t> bytes;  // valid until the next Read(); empty: nothing by the deadline
  };
  // What has arrived, waiting for the first byte until `deadline`.
  Received Read(Clock::time_point deadline);
  // False where not everything could be handed over by `deadline`; the stream is then of no use.
  bool Write(std::span<const uint8_t> bytes, Clock::time_point deadline);
  bool Write(std::string_view text, Clock::time_point deadline);
  // Ends both directions and wakes a reader; for any thread.
  void Shutdown();

  const std::string& peer() const { return peer_; }  // "host:port"

 private:
  std::string peer_;
  int socket_ = -1;
  std::array<uint8_t, 16384> buffer_;
};

// Whether a host name or address is this machine itself; false where it cannot be resolved.
bool IsLoopback(const std::string& host);

}  // namespace sandwright
