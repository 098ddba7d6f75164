// socket_*: connections that a program opens to the PC.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/controller_fake/byte_packing.h"
#include "tests/support/controller_fake/connections.h"
#include "tests/support/controller_fake/script_functions.h"

namespace sandwright::fake {
namespace {

using Evaluator = ScriptEvaluator;

std::string SocketName(const Arguments& a, size_t position) {
  const Value* name = a.Find(position, "socket_name");
  return name ? name->String() : "socket_0";
}

ScriptSocket& Find(Evaluator& e, const std::string& name) {
  const auto found = e.machine().sockets.find(name);
  if (found == e.machine().sockets.end() || !found->second.connection->open())
    throw ScriptError("socket " + name + " is not open");
  return found->second;
}

Value Open(Evaluator& e, const Arguments& a) {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<uint16_t>(a.At(1, "port").Integer()));
  if (inet_pton(AF_INET, a.At(0, "address").String().c_str(), &where.sin_addr) != 1) return false;
  const int handle = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(handle, reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0) {
    close(handle);
    return false;
  }
  e.machine().sockets[SocketName(a, 2)] = {std::make_shared<Connection>(handle), ""};
  return true;
}

Value Send(Evaluator& e, const Arguments& a, const std::string& bytes) {
  Find(e, SocketName(a, 1)).connection->Send(bytes);
  return true;
}

// A list of how many came, then the numbers; a timeout of 0 waits for ever.
Value ReadIntegers(Evaluator& e, const Arguments& a) {
  const int32_t count = a.At(0, "number").Integer();
  const double timeout_s = a.Number(2, "timeout", 2), begin_s = e.machine().state.time_s;
  const size_t size = static_cast<size_t>(count) * 4;
  Value::List numbers(static_cast<size_t>(count) + 1, int32_t{-1});
  numbers[0] = int32_t{0};
  for (;;) {
    ScriptSocket& socket = Find(e, SocketName(a, 1));
    socket.received += socket.connection->Receive();
    if (socket.received.size() >= size) {
      ByteReader reader(socket.received);
      for (int32_t i = 1; i <= count; ++i) numbers[i] = reader.I32();
      numbers[0] = count;
      socket.received.erase(0, size);
      return numbers;
    }
    if (timeout_s > 0 && e.machine().state.time_s - begin_s > timeout_s) return numbers;
    if (!socket.connection->open()) return numbers;
    e.Yield();
  }
}

}  // namespace

void AddSocketFunctions(BuiltIns& functions) {
  functions["socket_open"] = Open;
  functions["socket_close"] = [](Evaluator& e, const Arguments& a) -> Value {
    e.machine().sockets.erase(SocketName(a, 0));
    return {};
  };
  functions["socket_send_string"] = [](Evaluator& e, const Arguments& a) {
    return Send(e, a, a.At(0, "str").ToText());
  };
  functions["socket_send_line"] = [](Evaluator& e, const Arguments& a) {
    return Send(e, a, a.At(0, "str").ToText() + "\n");
  };
  functions["socket_send_int"] = [](Evaluator& e, const Arguments& a) {
    return Send(e, a, ByteWriter().I32(a.At(0, "value").Integer()).bytes());
  };
  functions["socket_read_binary_integer"] = ReadIntegers;
}

}  // namespace sandwright::fake
