// The fake's sockets: listeners and connections that never block, for one polling thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace sandwright::fake {

// How bytes leave a connection.
struct SendManner {
  bool split = false;     // one byte a packet
  bool coalesce = false;  // several frames at once, late
  bool drop = false;      // leave out what a slow client has no room for, instead of cutting it off
};

class Connection {
 public:
  explicit Connection(int socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int socket() const { return socket_; }
  bool open() const { return socket_ >= 0; }
  // What has come since the last call; the connection closes itself where the peer has gone.
  std::string Receive();
  // Queues and sends what the peer takes now. A peer that leaves more than kMostUnread unread is
  // cut off, as a controller does.
  void Send(std::string_view bytes, SendManner manner = {});
  // With FIN, or with RST where `reset`.
  void Close(bool reset = false);
  // After what is queued has gone out.
  void CloseWhenSent();
  void Flush();
  bool wants_to_send() const { return !unsent_.empty(); }

 private:
  static constexpr size_t kMostUnread = 64 * 1024;
  static constexpr int kCoalescedFrames = 5;

  int socket_;
  std::string unsent_, held_back_;
  int held_frames_ = 0;
  bool split_ = false, closing_ = false;
};

// One listening port.
class Listener {
 public:
  // Port 0: any free one. Throws Error where the port cannot be had.
  Listener(const std::string& address, uint16_t port);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int socket() const { return socket_; }
  uint16_t port() const { return port_; }
  // The next client that waits; none otherwise.
  std::unique_ptr<Connection> Accept();

 private:
  int socket_;
  uint16_t port_;
};

}  // namespace sandwright::fake
