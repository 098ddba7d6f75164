// Each parser over a million random and mutated packets: no crash, no hang, bounded memory. What a
// sanitizer sees in it is a failure too.
#include <gtest/gtest.h>

#include "data/base/random.h"
#include "robot_model/controller/dashboard.h"
#include "robot_model/controller/primary.h"
#include "robot_model/controller/rtde.h"
#include "tests/robot_model/controller/packet_bytes.h"

namespace sandwright {
namespace {

constexpr int kPackets = 1'000'000;

uint8_t RandomByte(RandomStream& random) { return static_cast<uint8_t>(random.Index(256)); }

Bytes RandomBytes(RandomStream& random, size_t most) {
  Bytes bytes(random.Index(most + 1));
  for (uint8_t& byte : bytes) byte = RandomByte(random);
  return bytes;
}

// A known packet with a few bytes changed, cut off, doubled or set to extremes.
Bytes Mutated(Bytes bytes, RandomStream& random) {
  for (uint64_t i = random.Index(4); i > 0 && !bytes.empty(); --i) {
    const size_t at = random.Index(bytes.size());
    const auto where = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random.Index(5)) {
      case 0: bytes[at] = RandomByte(random); break;
      case 1: bytes[at] = random.Index(2) ? 0xff : 0; break;
      case 2: bytes.erase(where, bytes.end()); break;
      case 3: bytes.insert(where, bytes[at]); break;
      case 4: bytes[at] = static_cast<uint8_t>(bytes[at] ^ 1u << random.Index(8)); break;
    }
  }
  return bytes;
}

// Feeds `kPackets` packets in random pieces; a stream that breaks is followed by a new one.
template <class Framer, class Take>
void Fuzz(const std::vector<Bytes>& known, size_t largest, const Framer& fresh, Take take) {
  RandomStream random(20240229);
  Framer framer = fresh;
  size_t most_held = 0;
  for (int i = 0; i < kPackets; ++i) {
    const Bytes bytes = random.Index(4) == 0
                            ? RandomBytes(random, 64)
                            : Mutated(known[random.Index(known.size())], random);
    const size_t piece = 1 + random.Index(bytes.size() + 1);
    for (size_t at = 0; at < bytes.size(); at += piece) {
      framer.Feed(std::span(bytes).subspan(at, std::min(piece, bytes.size() - at)));
      while (const auto out = framer.Next()) take(*out);
    }
    most_held = std::max(most_held, framer.held_bytes());
    if (framer.broken() || random.Index(64) == 0) framer = fresh;
  }
  EXPECT_LE(most_held, largest);
}

TEST(ParserFuzz, Rtde) {
  const std::vector<Bytes> known = {
      StateFrame({}, 1), RtdeStartRequest() + StateFrame({}, 1), FromHex("00 04 56 01"),
      FromHex("00 13 76 00 00 00 03 00 00 00 0f 00 00 00 08 00 01 9f 63"),
      FromHex("00 13 4f 01") + "DOUBLE,VECTOR6D", FromHex("00 0a 4d 02 48 69 01 61 01 02")};
  int states = 0, parsed = 0;
  const auto take = [&](const Packet& packet) {
    states += ParseArmState(packet.payload, 1).has_value();
    parsed += ParseRtdeAccepted(packet.payload).has_value();
    parsed += ParseRtdeVersion(packet.payload).has_value();
    parsed += ParseRtdeRecipe(packet.payload).has_value();
    parsed += ParseRtdeText(packet.payload).has_value();
  };
  Fuzz(known, kRtdeFormat.largest, PacketFramer(kRtdeFormat), take);
  EXPECT_GT(states, 1000);
  EXPECT_GT(parsed, 1000);
}

TEST(ParserFuzz, Primary) {
  const std::vector<Bytes> known = {
      PrimaryState({}), PrimaryMessage(7, KeyBody("PROGRAM_XXX_STARTED", "stroke")),
      PrimaryMessage(10, FromHex("00 00 00 01 00 00 00 02") + "syntax error"),
      PrimaryMessage(6, Bytes(20, 0) + "text"),
      PrimaryMessage(3, FromHex("02 55 52 03 0f 00 00 00 08 00 01 9f 63")),
      PrimaryMessage(2, FromHex("00 00 00 01 00 01 00 01 02") + "hithere"),
      PrimaryMessage(5, Bytes(9, 7))};
  int whole = 0, refused = 0;
  const auto take = [&](const Packet& packet) {
    const auto items = ParsePrimaryPacket(packet);
    items ? ++whole : ++refused;
    // No packet can make more items than it has bytes for.
    EXPECT_LE(items ? items->size() : 0, packet.payload.size() / 5 + 1);
  };
  Fuzz(known, kPrimaryFormat.largest, PacketFramer(kPrimaryFormat), take);
  EXPECT_GT(whole, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(ParserFuzz, Dashboard) {
  std::vector<Bytes> known;
  for (const char* line :
       {"Connected: Universal Robots Dashboard Server\n", "Robotmode: RUNNING\n",
        "Safetymode: NORMAL\r\n", "Program running: true\n", "STOPPED a.urp\n",
        "URSoftware 3.15.8.106339 (Mar 01 2022)\n", "Stopped\n"})
    known.push_back(Bytes{} + line);
  int parsed = 0;
  const auto take = [&](const std::string& line) {
    parsed += IsDashboardBanner(line) + IsStopped(line) + ParseRobotMode(line).has_value() +
              ParseSafetyMode(line).has_value() + ParseProgramRunning(line).has_value() +
              ParseProgramState(line).has_value() + ParsePolyscopeVersion(line).has_value();
  };
  Fuzz(known, LineFramer::kLongest + 128, LineFramer(), take);
  EXPECT_GT(parsed, 1000);
}

}  // namespace
}  // namespace sandwright
