#include "robot_model/controller/rtde_client.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kConnectTime = 5s, kReplyTime = 5s, kWriteTime = 50ms;
constexpr size_t kFramesKept = 125;
// The beat outlives a watcher by this: less than the 100 ms after which the program stops.
constexpr auto kWatchedFor = 60ms;
constexpr double kBooted_s = 40;

std::vector<std::string> Split(const std::string& list) {
  std::vector<std::string> words(1);
  for (const char c : list) {
    if (c == ',') words.emplace_back();
    else words.back() += c;
  }
  return words;
}

// The names whose type in the controller's answer is `refusal`.
std::string NamesWith(const std::string& names, const std::string& types, const char* refusal) {
  const auto name = Split(names), type = Split(types);
  std::string found;
  for (size_t i = 0; i < std::min(name.size(), type.size()); ++i)
    if (type[i] == refusal) found += (found.empty() ? "" : ", ") + name[i];
  return found;
}

}  // namespace

// The exchange of requests and replies before the stream, in the thread of the constructor.
struct RtdeClient::Negotiation {
  RtdeClient& client;
  Clock::time_point deadline = Clock::now() + kReplyTime;

  [[noreturn]] void Fail(const std::string& what) const {
    const std::string text = client.last_text_.empty() ? "" : "; it says: " + client.last_text_;
    throw Error("RTDE of " + client.stream_.peer() + ": " + what + text);
  }

  void Send(const Bytes& request) const {
    if (!client.stream_.Write(request, deadline)) Fail("cannot send");
  }

  // The payload of the next packet of this type. Texts on the way are kept, data is passed over.
  Bytes Await(RtdeType type, const char* what) const {
    for (;;) {
      while (const auto packet = client.framer_.Next()) {
        if (packet->type == static_cast<uint8_t>(type))
          return {packet->payload.begin(), packet->payload.end()};
        if (const auto text = packet->type == static_cast<uint8_t>(RtdeType::kText)
                                  ? ParseRtdeText(packet->payload)
                                  : std::nullopt)
          client.last_text_ = text->message;
      }
      if (client.framer_.broken()) Fail("what it sends is not RTDE");
      const auto received = client.stream_.Read(deadline);
      if (received.link != LinkState::kOpen)
        Fail(fmt::format("connection {} instead of {}", Name(received.link), what));
      if (received.bytes.empty()) Fail(fmt::format("no {} within {} s", what, kReplyTime / 1s));
      client.framer_.Feed(received.bytes);
    }
  }

  void Accepted(RtdeType type, const char* what, const char* refused) const {
    const auto accepted = ParseRtdeAccepted(Await(type, what));
    if (!accepted) Fail(fmt::format("malformed {}", what));
    if (!*accepted) Fail(refused);
  }

  uint8_t Recipe(RtdeType type, const char* names, const char* types) const {
    const auto recipe = ParseRtdeRecipe(Await(type, "answer to a recipe"));
    if (!recipe) Fail("malformed answer to a recipe");
    if (const auto unknown = NamesWith(names, recipe->types, "NOT_FOUND"); !unknown.empty())
      Fail(fmt::format("the controller does not know {} (NOT_FOUND)", unknown));
    if (const auto taken = NamesWith(names, recipe->types, "IN_USE"); !taken.empty())
      Fail(fmt::format("another client (or a fieldbus) writes {} (IN_USE); end it first", taken));
    if (recipe->types != types)
      Fail(fmt::format("answers {} for {}; expected {}", recipe->types, names, types));
    return recipe->id;
  }

  void Run() const {
    Send(RtdeProtocolRequest());
    Accepted(RtdeType::kProtocol, "answer to the protocol", "it refuses protocol version 2");
    Send(RtdeVersionRequest());
    const auto version = ParseRtdeVersion(Await(RtdeType::kVersion, "version"));
    if (!version) Fail("malformed version");
    if (*version < kOldest || *version >= kBeyond)
      Fail(fmt::format("PolyScope {}; allowed: {} up to, without, {}", Name(*version),
                       Name(kOldest), Name(kBeyond)));
    client.version_ = *version;
    Send(RtdeOutputsRequest());
    client.output_recipe_ = Recipe(RtdeType::kOutputs, kRtdeOutputs, kRtdeOutputTypes);
    Send(RtdeInputsRequest());
    client.input_recipe_ = Recipe(RtdeType::kInputs, kRtdeInputs, kRtdeInputTypes);
    Send(RtdeStartRequest());
    Accepted(RtdeType::kStart, "answer to the start", "it refuses to start the stream");
    const auto state = ParseArmState(Await(RtdeType::kData, "frame"), client.output_recipe_);
    if (!state) Fail("malformed first frame");
    if (state->timestamp_s < kBooted_s)
      Fail(fmt::format("the controller is booting (up for {:.1f} s); wait until {} s",
                       state->timestamp_s, kBooted_s));
    client.latest_ = {*state, Clock::now()};
  }
};

RtdeClient::RtdeClient(const std::string& host, uint16_t port) : stream_(host, port, kConnectTime) {
  Negotiation{*this}.Run();
  thread_ = std::thread([this] { Read(); });
}

RtdeClient::~RtdeClient() {
  ends_ = true;
  stream_.Write(RtdePauseRequest(), Clock::now() + kWriteTime);
  stream_.Shutdown();
  thread_.join();
}

void RtdeClient::Read() {
  LinkState link = LinkState::kOpen;
  while (!ends_ && link == LinkState::kOpen) {
    while (const auto packet = framer_.Next()) {
      if (packet->type == static_cast<uint8_t>(RtdeType::kData)) {
        if (const auto state = ParseArmState(packet->payload, output_recipe_)) TakeState(*state);
        else ++lost_frames_;
      } else if (packet->type == static_cast<uint8_t>(RtdeType::kText)) {
        const auto text = ParseRtdeText(packet->payload);
        const std::lock_guard lock(mutex_);
        if (text) last_text_ = text->message;
      }
    }
    if (framer_.broken()) {
      link = LinkState::kCorrupt;
      break;
    }
    const auto received = stream_.Read(Clock::now() + 100ms);
    link = received.link;
    framer_.Feed(received.bytes);
  }
  const std::lock_guard lock(mutex_);
  link_ = link;
  arrived_.notify_all();
}

void RtdeClient::TakeState(const ArmState& state) {
  bool watched = false;
  {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    // A repeated or older timestamp is no news: the frame neither counts as fresh nor keeps the
    // beat, so that program and watcher both see the loss.
    if (state.timestamp_s <= latest_.state.timestamp_s) return;
    if (now - latest_.arrival >= kGap) ++gaps_;
    latest_ = {state, now};
    frames_.push_back(latest_);
    if (frames_.size() > kFramesKept) {
      frames_.pop_front();
      if (now - watched_at_ < kDeadAfter) ++lost_frames_;
    }
    watched = now - watched_at_ < kWatchedFor;
  }
  arrived_.notify_all();
  if (!watched) return;
  const std::lock_guard lock(write_mutex_);
  beat_ = beat_ == INT32_MAX ? 0 : beat_ + 1;
  SendInputs();
}

bool RtdeClient::SendInputs() {
  return stream_.Write(RtdeInputs(input_recipe_, beat_, command_), Clock::now() + kWriteTime);
}

bool RtdeClient::SendCommand(int32_t command) {
  const std::lock_guard lock(write_mutex_);
  command_ = command;
  return SendInputs();
}

std::optional<ArmFrame> RtdeClient::TakeFrame(Clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  watched_at_ = Clock::now();
  arrived_.wait_until(lock, deadline,
                      [this] { return !frames_.empty() || link_ != LinkState::kOpen; });
  watched_at_ = Clock::now();
  if (frames_.empty()) return std::nullopt;
  const ArmFrame frame = frames_.front();
  frames_.pop_front();
  return frame;
}

void RtdeClient::ClearFrames() {
  const std::lock_guard lock(mutex_);
  frames_.clear();
}

ArmFrame RtdeClient::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

Freshness RtdeClient::freshness() const {
  const std::lock_guard lock(mutex_);
  const auto age = Clock::now() - latest_.arrival;
  return age > kDeadAfter ? Freshness::kDead
         : age > kStaleAfter ? Freshness::kStale
                             : Freshness::kFresh;
}

LinkState RtdeClient::link() const {
  const std::lock_guard lock(mutex_);
  return link_;
}

std::string RtdeClient::last_text() const {
  const std::lock_guard lock(mutex_);
  return last_text_;
}

}  // namespace sandwright
