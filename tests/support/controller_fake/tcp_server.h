// A listening port with its clients; `Session` is what a server remembers of each.
#pragma once

#include <poll.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/controller_fake/connections.h"

namespace sandwright::fake {

template <class Session>
struct Client {
  std::unique_ptr<Connection> connection;
  std::string received;  // not yet understood
  Session session;
};

template <class Session>
class TcpServer {
 public:
  TcpServer(const std::string& address, uint16_t port, size_t most_clients)
      : listener_(address, port), most_clients_(most_clients) {}

  uint16_t port() const { return listener_.port(); }
  std::vector<Client<Session>>& clients() { return clients_; }

  void AddPolls(std::vector<pollfd>& polls) const {
    polls.push_back({listener_.socket(), POLLIN, 0});
    for (const auto& client : clients_) {
      const bool sends = client.connection->wants_to_send();
      polls.push_back(
          {client.connection->socket(), static_cast<short>(POLLIN | (sends ? POLLOUT : 0)), 0});
    }
  }

  // on_connect(client) for each new one, on_data(client) for each that has sent something,
  // on_gone(session) for each that has left. One too many is closed at once.
  template <class OnConnect, class OnData, class OnGone>
  void Serve(OnConnect&& on_connect, OnData&& on_data, OnGone&& on_gone) {
    while (auto connection = listener_.Accept()) {
      if (clients_.size() >= most_clients_) continue;
      clients_.push_back({std::move(connection), {}, {}});
      on_connect(clients_.back());
    }
    for (auto& client : clients_) {
      client.connection->Flush();
      const std::string bytes = client.connection->Receive();
      if (bytes.empty()) continue;
      client.received += bytes;
      on_data(client);
    }
    for (auto& client : clients_) {
      if (!client.connection->open()) on_gone(client.session);
    }
    std::erase_if(clients_, [](const auto& client) { return !client.connection->open(); });
  }

  // The next Serve() forgets them.
  void CloseAll(bool reset) {
    for (auto& client : clients_) client.connection->Close(reset);
  }

 private:
  Listener listener_;
  size_t most_clients_;
  std::vector<Client<Session>> clients_;
};

}  // namespace sandwright::fake
