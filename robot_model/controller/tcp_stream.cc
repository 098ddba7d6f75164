#include "robot_model/controller/tcp_stream.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "data/base/error.h"

namespace sandwright {
namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses Resolve(const std::string& host, const std::string& port) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), port.c_str(), &wanted, &found) != 0) found = nullptr;
  return {found, &freeaddrinfo};
}

// Whether `events` came true before the deadline; a signal in between changes nothing.
bool Wait(int socket, short events, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd entry{socket, events, 0};
    const int ready =
        poll(&entry, 1, static_cast<int>(std::clamp<int64_t>(left.count(), 0, 60'000)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return true;  // the call that follows reports what is wrong
    if (Clock::now() >= deadline) return false;
  }
}

// The errno of the attempt; 0 where connected.
int TryConnect(int socket, const addrinfo& address, Clock::time_point deadline) {
  if (connect(socket, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!Wait(socket, POLLOUT, deadline)) return ETIMEDOUT;
  int failure = 0;
  socklen_t size = sizeof failure;
  getsockopt(socket, SOL_SOCKET, SO_ERROR, &failure, &size);
  return failure;
}

}  // namespace

const char* Name(LinkState link) {
  switch (link) {
    case LinkState::kOpen: return "open";
    case LinkState::kClosed: return "closed by the controller";
    case LinkState::kReset: return "broken";
    case LinkState::kCorrupt: return "sending what is not its protocol";
  }
  return "unknown";
}

TcpStream::TcpStream(const std::string& host, uint16_t port, std::chrono::milliseconds timeout)
    : peer_(fmt::format("{}:{}", host, port)) {
  const auto deadline = Clock::now() + timeout;
  const Addresses addresses = Resolve(host, std::to_string(port));
  if (!addresses) throw Error("controller " + peer_ + ": no such host");
  int failure = 0;
  for (const addrinfo* address = addresses.get(); address; address = address->ai_next) {
    socket_ = socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (socket_ < 0) {
      failure = errno;
      continue;
    }
    failure = TryConnect(socket_, *address, deadline);
    if (failure == 0) break;
    close(socket_);
    socket_ = -1;
  }
  if (socket_ < 0)
    throw Error(fmt::format("controller {}: cannot connect: {}", peer_, std::strerror(failure)));
  // A beat must not wait for the next one to fill a segment.
  const int on = 1;
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

TcpStream::~TcpStream() { close(socket_); }

TcpStream::Received TcpStream::Read(Clock::time_point deadline) {
  for (;;) {
    const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), 0);
    if (count > 0)
      return {LinkState::kOpen, std::span(buffer_).first(static_cast<size_t>(count))};
    if (count == 0) return {LinkState::kClosed, {}};
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return {LinkState::kReset, {}};
    if (!Wait(socket_, POLLIN, deadline)) return {};
  }
}

bool TcpStream::Write(std::span<const uint8_t> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count > 0) {
      bytes = bytes.subspan(static_cast<size_t>(count));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!Wait(socket_, POLLOUT, deadline)) return false;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

bool TcpStream::Write(std::string_view text, Clock::time_point deadline) {
  return Write(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()), deadline);
}

void TcpStream::Shutdown() { shutdown(socket_, SHUT_RDWR); }

bool IsLoopback(const std::string& host) {
  const Addresses addresses = Resolve(host, "0");
  if (!addresses) return false;
  for (const addrinfo* address = addresses.get(); address; address = address->ai_next) {
    if (address->ai_family == AF_INET) {
      const auto* ip = reinterpret_cast<const sockaddr_in*>(address->ai_addr);
      if (ntohl(ip->sin_addr.s_addr) >> 24 != 127) return false;
    } else {
      const auto* ip = reinterpret_cast<const sockaddr_in6*>(address->ai_addr);
      if (!IN6_IS_ADDR_LOOPBACK(&ip->sin6_addr)) return false;
    }
  }
  return true;
}

}  // namespace sandwright
