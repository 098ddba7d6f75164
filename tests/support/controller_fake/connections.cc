#include "tests/support/controller_fake/connections.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "data/base/error.h"

namespace sandwright::fake {
namespace {

void NeverBlock(int socket) { fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK); }

}  // namespace

Connection::Connection(int socket) : socket_(socket) {
  NeverBlock(socket);
  const int on = 1, buffer = 32 * 1024;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  // Small, so that a client that does not read is noticed within a second or two.
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &buffer, sizeof buffer);
}

Connection::~Connection() { Close(); }

std::string Connection::Receive() {
  std::string received;
  char chunk[4096];
  while (open()) {
    const ssize_t count = recv(socket_, chunk, sizeof chunk, 0);
    if (count > 0) {
      received.append(chunk, static_cast<size_t>(count));
    } else if (count < 0 && errno == EINTR) {
      continue;
    } else {
      if (count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK)) Close();
      break;
    }
  }
  return received;
}

void Connection::Send(std::string_view bytes, SendManner manner) {
  if (!open() || closing_) return;
  split_ = manner.split;
  if (manner.drop && unsent_.size() + bytes.size() > kMostUnread) return;
  held_back_ += bytes;
  if (manner.coalesce && ++held_frames_ < kCoalescedFrames) return;
  held_frames_ = 0;
  unsent_ += std::exchange(held_back_, {});
  Flush();
  if (unsent_.size() > kMostUnread) Close(true);
}

void Connection::Flush() {
  while (open() && !unsent_.empty()) {
    const size_t size = split_ ? 1 : unsent_.size();
    const ssize_t count = send(socket_, unsent_.data(), size, MSG_NOSIGNAL);
    if (count > 0) {
      unsent_.erase(0, static_cast<size_t>(count));
    } else if (errno != EINTR) {
      if (errno != EAGAIN && errno != EWOULDBLOCK) Close();
      break;
    }
  }
  if (closing_ && unsent_.empty()) Close();
}

void Connection::Close(bool reset) {
  if (!open()) return;
  if (reset) {
    const linger at_once{1, 0};
    setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }
  close(socket_);
  socket_ = -1;
  unsent_.clear();
}

void Connection::CloseWhenSent() {
  closing_ = true;
  Flush();
}

Listener::Listener(const std::string& address, uint16_t port) : socket_(-1), port_(port) {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &where.sin_addr) != 1)
    throw Error("controller fake: address '" + address + "' is not of the form a.b.c.d");
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof where;
  if (bind(socket_, reinterpret_cast<sockaddr*>(&where), size) != 0 || listen(socket_, 8) != 0) {
    const std::string why = std::strerror(errno);
    close(socket_);
    throw Error("controller fake: port " + std::to_string(port) + " of " + address + ": " + why);
  }
  getsockname(socket_, reinterpret_cast<sockaddr*>(&where), &size);
  port_ = ntohs(where.sin_port);
  NeverBlock(socket_);
}

Listener::~Listener() { close(socket_); }

std::unique_ptr<Connection> Listener::Accept() {
  const int client = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
  return client < 0 ? nullptr : std::make_unique<Connection>(client);
}

}  // namespace sandwright::fake
