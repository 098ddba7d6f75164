#include "tests/support/controller_fake/rtde_server.h"

#include <algorithm>

namespace sandwright::fake {
namespace {

constexpr size_t kMostClients = 3;
constexpr size_t kHeader = 3;

enum Type : uint8_t {
  kProtocol = 'V',
  kVersion = 'v',
  kText = 'M',
  kData = 'U',
  kOutputs = 'O',
  kInputs = 'I',
  kStart = 'S',
  kPause = 'P',
};

// A comma behind the last name, as some clients write it, names nothing.
std::vector<std::string> SplitNames(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const size_t comma = text.find(',');
    names.emplace_back(text.substr(0, comma));
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  }
  return names;
}

void Append(std::string& list, const std::string& item) {
  if (!list.empty()) list += ',';
  list += item;
}

}  // namespace

RtdeServer::RtdeServer(const std::string& address, uint16_t port, std::array<uint32_t, 4> version,
                       ControllerState& state, std::function<void(double)> set_slider)
    : sockets_(address, port, kMostClients),
      version_(version),
      state_(state),
      set_slider_(std::move(set_slider)) {}

void RtdeServer::Serve() {
  sockets_.Serve([](RtdeClient&) {}, [this](RtdeClient& client) { TakeFrames(client); },
                 [](RtdeSession&) {});
}

void RtdeServer::TakeFrames(RtdeClient& client) {
  std::string& received = client.received;
  while (received.size() >= kHeader && client.connection->open()) {
    ByteReader header(received);
    const size_t size = header.U16();
    const uint8_t type = header.U8();
    if (size < kHeader) return client.connection->Close(true);
    if (received.size() < size) return;
    const std::string body = received.substr(kHeader, size - kHeader);
    received.erase(0, size);
    Answer(client, type, body);
  }
}

void RtdeServer::Answer(RtdeClient& client, uint8_t type, std::string_view body) {
  RtdeSession& session = client.session;
  ByteReader reader(body);
  ByteWriter reply;
  switch (type) {
    case kProtocol: {
      const int wanted = reader.U16();
      const bool accepted = reader.ok() && wanted >= 1 && wanted <= faults_.newest_protocol;
      if (accepted) session.protocol = wanted;
      return SendFrame(client, type, reply.U8(accepted).bytes());
    }
    case kVersion:
      for (const uint32_t number : version_) reply.U32(number);
      return SendFrame(client, type, reply.bytes());
    case kOutputs: return SendFrame(client, type, SetUpOutputs(session, body));
    case kInputs: return SendFrame(client, type, SetUpInputs(client, body));
    case kStart:
      session.started = session.outputs_valid;
      return SendFrame(client, type, reply.U8(session.started).bytes());
    case kPause:
      session.started = false;
      return SendFrame(client, type, reply.U8(1).bytes());
    case kData: return TakeInputs(session, body);
    default: {
      constexpr uint8_t kWarning = 2;
      const std::string text = "unknown package type " + std::to_string(type);
      if (session.protocol == 1)
        reply.U8(kWarning).Text(text);
      else
        reply.ShortText(text).ShortText("RTDE").U8(kWarning);
      SendFrame(client, kText, reply.bytes());
    }
  }
}

std::string RtdeServer::SetUpOutputs(RtdeSession& session, std::string_view body) {
  ByteReader reader(body);
  session.frequency_Hz = session.protocol == 1 ? 125 : std::clamp(reader.F64(), 1.0, 125.0);
  session.outputs.clear();
  session.outputs_valid = true;
  session.started = false;
  std::string types;
  for (const std::string& name : SplitNames(reader.Rest())) {
    const auto found = RtdeOutputs().find(name);
    if (found == RtdeOutputs().end() || faults_.not_found.contains(name)) {
      session.outputs_valid = false;
      Append(types, "NOT_FOUND");
    } else {
      session.outputs.push_back(&found->second);
      Append(types, found->second.type);
    }
  }
  ByteWriter reply;
  if (session.protocol >= 2) reply.U8(session.outputs_valid ? 1 : 0);
  return reply.Text(types).bytes();
}

bool RtdeServer::HeldByAnother(const RtdeClient& client, const std::string& name) {
  return std::ranges::any_of(sockets_.clients(), [&](const RtdeClient& other) {
    return &other != &client && std::ranges::any_of(other.session.inputs, [&](const auto& recipe) {
      return std::ranges::find(recipe.second, name) != recipe.second.end();
    });
  });
}

std::string RtdeServer::SetUpInputs(RtdeClient& client, std::string_view body) {
  bool valid = true;
  std::string types;
  const auto names = SplitNames(body);
  for (const std::string& name : names) {
    const auto found = RtdeInputs().find(name);
    if (found == RtdeInputs().end() || faults_.not_found.contains(name)) {
      Append(types, "NOT_FOUND");
      valid = false;
    } else if (faults_.in_use.contains(name) || HeldByAnother(client, name)) {
      Append(types, "IN_USE");
      valid = false;
    } else {
      Append(types, found->second.type);
    }
  }
  const auto id = static_cast<uint8_t>(valid ? client.session.inputs.size() + 1 : 0);
  if (valid) client.session.inputs[id] = names;
  return ByteWriter().U8(id).Text(types).bytes();
}

void RtdeServer::TakeInputs(RtdeSession& session, std::string_view body) {
  ByteReader reader(body);
  const uint8_t id = session.protocol == 1 ? 1 : reader.U8();
  const auto recipe = session.inputs.find(id);
  if (recipe == session.inputs.end()) return;
  RtdePackage package{.registers = state_.inputs};
  for (const std::string& name : recipe->second) RtdeInputs().at(name).read(reader, package);
  // A package of the wrong size changes nothing.
  if (!reader.ok() || !reader.AtEnd()) return;
  state_.inputs = package.registers;
  for (const std::string& name : recipe->second) state_.input_written_s[name] = state_.time_s;
  if (package.slider_mask & 1) set_slider_(package.slider_fraction);
}

void RtdeServer::Publish() {
  if (std::chrono::steady_clock::now() < faults_.silent_until) return;
  for (RtdeClient& client : sockets_.clients()) {
    RtdeSession& session = client.session;
    if (!session.started) continue;
    session.due += session.frequency_Hz * kControlPeriod_s;
    if (session.due < 1 - 1e-9) continue;
    session.due -= 1;
    ByteWriter frame;
    if (session.protocol >= 2) frame.U8(1);
    for (const RtdeOutput* output : session.outputs) output->write(state_, frame);
    SendFrame(client, kData, frame.bytes());
    ++frames_sent_;
  }
}

void RtdeServer::SendFrame(RtdeClient& client, uint8_t type, std::string_view body) {
  ByteWriter frame;
  frame.U16(static_cast<uint16_t>(kHeader + body.size())).U8(type).Text(body);
  // Answers are not held back: a client waits for each.
  client.connection->Send(frame.bytes(),
                          {faults_.manner.split, faults_.manner.coalesce && type == kData});
}

}  // namespace sandwright::fake
