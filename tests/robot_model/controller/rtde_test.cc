// RTDE packets: known bytes, streams cut anywhere, and what must be refused.
#include "robot_model/controller/rtde.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/robot_model/controller/packet_bytes.h"

namespace sandwright {
namespace {

ArmState SomeState() {
  ArmState state;
  state.timestamp_s = 1234.5;
  state.actual_q.rad << -1.5, -1.25, 2, -0.5, 0.25, 3;
  state.tcp_force << 1, -2, 3, 0.5, 0, -0.5;
  state.speed_scaling = 0.5;
  state.target_speed_fraction = 0.25;
  state.runtime_state = RuntimeState::kPaused;
  state.robot_mode = RobotMode::kNoController;
  state.safety_mode = SafetyMode::kProtectiveStop;
  state.safety_status_bits = ArmState::kSafetyProtective;
  state.output_registers = {7, -1, 2147483647};
  return state;
}

TEST(Rtde, RequestsAreTheBytesOfTheGuide) {
  EXPECT_EQ(RtdeProtocolRequest(), FromHex("00 05 56 00 02"));
  EXPECT_EQ(RtdeVersionRequest(), FromHex("00 03 76"));
  EXPECT_EQ(RtdeStartRequest(), FromHex("00 03 53"));
  EXPECT_EQ(RtdePauseRequest(), FromHex("00 03 50"));
  EXPECT_EQ(RtdeInputs(1, 2, -1), FromHex("00 0c 55 01 00 00 00 02 ff ff ff ff"));
  const Bytes outputs = RtdeOutputsRequest();
  EXPECT_EQ(Bytes(outputs.begin(), outputs.begin() + 11),
            FromHex("01 12 4f 40 5f 40 00 00 00 00 00"));
  EXPECT_EQ(std::string(outputs.begin() + 11, outputs.begin() + 29), "timestamp,target_q");
  EXPECT_EQ(outputs.size(), 0x112u);
}

TEST(Rtde, SoftwareCannotReachTheSpeedSlider) {
  EXPECT_EQ(std::string(kRtdeInputs).find("slider"), std::string::npos);
}

TEST(Rtde, RepliesAreReadAndLiesRefused) {
  EXPECT_EQ(ParseRtdeAccepted(FromHex("01")), true);
  EXPECT_EQ(ParseRtdeAccepted(FromHex("00")), false);
  for (const char* wrong : {"", "02", "01 01"})
    EXPECT_FALSE(ParseRtdeAccepted(FromHex(wrong))) << wrong;

  const auto version =
      ParseRtdeVersion(FromHex("00 00 00 03 00 00 00 0f 00 00 00 08 00 01 9f 63"));
  ASSERT_TRUE(version);
  EXPECT_EQ(Name(*version), "3.15.8.106339");
  EXPECT_FALSE(ParseRtdeVersion(FromHex("00 00 00 03 00 00 00 0f 00 00 00 08 00 01 9f")));

  const auto packets = Cut(kRtdeFormat, FromHex("00 13 4f 01") + "DOUBLE,VECTOR6D", 64);
  ASSERT_EQ(packets.size(), 1u);
  const auto outputs = ParseRtdeRecipe(packets[0].payload);
  ASSERT_TRUE(outputs);
  EXPECT_EQ(outputs->id, 1);
  EXPECT_EQ(outputs->types, "DOUBLE,VECTOR6D");
  // A size that is one too large takes a byte of the next packet, and the reader loses step.
  const auto lie = Cut(
      kRtdeFormat, FromHex("00 14 4f 01") + "DOUBLE,VECTOR6D" + FromHex("00 03 50 00 03 50"), 64);
  ASSERT_EQ(lie.size(), 1u);
  EXPECT_NE(ParseRtdeRecipe(lie[0].payload)->types, "DOUBLE,VECTOR6D");
  EXPECT_FALSE(ParseRtdeRecipe(FromHex("01")));

  const auto text = ParseRtdeText(FromHex("02 48 69 03 61 62 63 01"));
  ASSERT_TRUE(text);
  EXPECT_EQ(text->message, "Hi");
  EXPECT_EQ(text->source, "abc");
  EXPECT_EQ(text->level, 1);
  EXPECT_FALSE(ParseRtdeText(FromHex("ff 48 69 03 61 62 63 01")));
  EXPECT_FALSE(ParseRtdeText(FromHex("02 48 69 03 61 62 63 01 00")));
}

TEST(Rtde, GoldenDataFrame) {
  const auto packets = Cut(
      kRtdeFormat, FromHex("00 14 55 01 40 d0 07 0d 2f 1a 9f be 3f f0 00 00 00 00 00 00"), 1);
  ASSERT_EQ(packets.size(), 1u);
  BigEndianReader reader(packets[0].payload);
  EXPECT_EQ(reader.U8(), 1);
  EXPECT_DOUBLE_EQ(reader.F64(), 16412.206);
  EXPECT_DOUBLE_EQ(reader.F64(), 1);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.U8(), 0);
  EXPECT_FALSE(reader.ok());
}

TEST(Rtde, StateSurvivesTheWire) {
  const ArmState state = SomeState();
  const Bytes frame = StateFrame(state, 3);
  EXPECT_EQ(frame.size(), 348u);
  const auto read = ParseArmState(std::span(frame).subspan(3), 3);
  ASSERT_TRUE(read);
  EXPECT_EQ(StateFrame(*read, 3), frame);
  EXPECT_EQ(read->actual_q.rad, state.actual_q.rad);
  EXPECT_EQ(read->robot_mode, RobotMode::kNoController);
  EXPECT_EQ(read->safety_mode, SafetyMode::kProtectiveStop);
  EXPECT_EQ(read->output_registers, state.output_registers);
  EXPECT_FALSE(read->is_fit_to_move());
}

TEST(Rtde, StateOfAnotherLengthRecipeOrWithNanIsNone) {
  const Bytes frame = StateFrame(SomeState(), 3);
  const auto payload = std::span(frame).subspan(3);
  EXPECT_FALSE(ParseArmState(payload, 2));
  for (size_t length = 0; length < payload.size(); ++length)
    EXPECT_FALSE(ParseArmState(payload.first(length), 3)) << length;
  Bytes longer(payload.begin(), payload.end());
  longer.push_back(0);
  EXPECT_FALSE(ParseArmState(longer, 3));
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    ArmState state = SomeState();
    state.tcp_force[1] = wrong;
    const Bytes force = StateFrame(state, 3);
    EXPECT_FALSE(ParseArmState(std::span(force).subspan(3), 3));
    state = SomeState();
    state.target_speed_fraction = wrong;
    const Bytes slider = StateFrame(state, 3);
    EXPECT_FALSE(ParseArmState(std::span(slider).subspan(3), 3));
  }
}

TEST(Rtde, FramesComeOutWhereverTheStreamIsCut) {
  Bytes stream;
  for (int i = 0; i < 4; ++i) stream = stream + StateFrame(SomeState(), 3) + RtdeStartRequest();
  for (size_t piece = 1; piece <= 700; ++piece) {
    const auto packets = Cut(kRtdeFormat, stream, piece);
    ASSERT_EQ(packets.size(), 8u) << piece;
    for (size_t i = 0; i < packets.size(); i += 2) {
      ASSERT_TRUE(ParseArmState(packets[i].payload, 3)) << piece;
      ASSERT_EQ(packets[i + 1].type, 'S');
      ASSERT_TRUE(packets[i + 1].payload.empty());
    }
  }
}

TEST(Rtde, SizesAndTypesThatCannotBeBreakTheFramer) {
  for (const char* wrong : {"00 00 55", "00 02 55 01", "00 05 00 00 02", "00 05 5a 00 02"}) {
    PacketFramer framer(kRtdeFormat);
    framer.Feed(FromHex(wrong));
    EXPECT_FALSE(framer.Next());
    EXPECT_TRUE(framer.broken()) << wrong;
    framer.Feed(RtdeStartRequest());
    EXPECT_FALSE(framer.Next());
    EXPECT_EQ(framer.held_bytes(), 0u);
  }
}

}  // namespace
}  // namespace sandwright
