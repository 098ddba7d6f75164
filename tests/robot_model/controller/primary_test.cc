// Primary packets, the rules for scripts, and what the events say about one.
#include "robot_model/controller/primary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot_model/controller/script_progress.h"
#include "robot_model/controller/script_rules.h"
#include "tests/robot_model/controller/packet_bytes.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::optional<std::vector<PrimaryItem>> Parse(const Bytes& bytes) {
  const auto packets = Cut(kPrimaryFormat, bytes, 1);
  EXPECT_EQ(packets.size(), 1u);
  if (packets.size() != 1) return std::nullopt;
  return ParsePrimaryPacket({packets[0].type, packets[0].payload});
}

template <class Kind>
Kind Only(const Bytes& bytes) {
  const auto items = Parse(bytes);
  EXPECT_TRUE(items && items->size() == 1 && std::holds_alternative<Kind>(items->front()));
  return items && !items->empty() ? std::get<Kind>(items->front()) : Kind{};
}

Bytes ErrorBody(int32_t code, int32_t argument, int32_t level, const std::string& text) {
  BigEndianWriter body;
  body.I32(code);
  body.I32(argument);
  body.I32(level);
  body.U32(0);
  body.U32(0);
  body.Text(text);
  return body.bytes();
}

Bytes ExceptionBody(int32_t line, int32_t column, const std::string& text) {
  BigEndianWriter body;
  body.I32(line);
  body.I32(column);
  body.Text(text);
  return body.bytes();
}

TEST(Primary, MessagesAreRead) {
  const auto key = Only<KeyMessage>(PrimaryMessage(7, KeyBody("PROGRAM_XXX_STARTED", "stroke_1")));
  EXPECT_EQ(key.title, "PROGRAM_XXX_STARTED");
  EXPECT_EQ(key.text, "stroke_1");
  const auto error = Only<ErrorCodeMessage>(PrimaryMessage(6, ErrorBody(153, 5, 3, "Position\n")));
  EXPECT_EQ(error.code, 153);
  EXPECT_EQ(error.argument, 5);
  EXPECT_TRUE(error.is_serious());
  EXPECT_EQ(error.text, "Position?");
  EXPECT_FALSE((ErrorCodeMessage{1, 0, 2, ""}).is_serious());
  EXPECT_FALSE((ErrorCodeMessage{1, 0, 130, ""}).is_serious());
  EXPECT_TRUE((ErrorCodeMessage{1, 0, 132, ""}).is_serious());
  const auto thrown =
      Only<RuntimeExceptionMessage>(PrimaryMessage(10, ExceptionBody(12, 7, "syntax_error")));
  EXPECT_EQ(thrown.line, 12);
  EXPECT_EQ(thrown.column, 7);
  EXPECT_EQ(Only<TextMessage>(PrimaryMessage(0, Bytes{'h', 'i'})).text, "hi");
  const auto version = Only<VersionMessage>(PrimaryMessage(
      3, FromHex("02 55 52 03 0f 00 00 00 08 00 01 9f 63") + "01-03-2022, 10:00:00"));
  EXPECT_EQ(version.project, "UR");
  EXPECT_EQ(version.minor, 15);
  EXPECT_EQ(version.build, 106339);
  const auto safety =
      Only<SafetyModeMessage>(PrimaryMessage(5, FromHex("00 00 00 00 00 00 00 00 07")));
  EXPECT_EQ(safety.mode, SafetyMode::kRobotEmergencyStop);
  const auto popup =
      Only<PopupMessage>(PrimaryMessage(2, FromHex("00 00 00 01 00 01 00 01 02") + "hithere"));
  EXPECT_TRUE(popup.is_warning && popup.is_blocking && !popup.is_error);
  EXPECT_EQ(popup.title, "hi");
  EXPECT_EQ(popup.text, "there");
}

TEST(Primary, StateGivesModeAndCalibration) {
  DhParameters dh;
  dh.d_m = {0.1273, 303.25, -310.5, 0.16, 0.11, 0.09};
  dh.theta_rad[1] = -0.0;
  const auto items = Parse(PrimaryState(dh));
  ASSERT_TRUE(items);
  ASSERT_EQ(items->size(), 2u);
  const auto& mode = std::get<RobotModeData>(items->at(0));
  EXPECT_EQ(mode.mode, RobotMode::kRunning);
  EXPECT_TRUE(mode.is_powered && mode.is_program_running && !mode.is_emergency_stopped);
  const auto& info = std::get<KinematicsInfo>(items->at(1));
  EXPECT_EQ(info.checksums[5], 105u);
  EXPECT_EQ(info.dh.d_m, dh.d_m);
  EXPECT_EQ(info.dh.alpha_rad, dh.alpha_rad);
  EXPECT_FALSE(std::signbit(info.dh.theta_rad[1]));
  EXPECT_EQ(info.status, 2u);
}

TEST(Primary, UnknownKindsArePassedOver) {
  EXPECT_THAT(*Parse(PrimaryMessage(99, Bytes(5, 1))), IsEmpty());
  EXPECT_THAT(*Parse(FromHex("00 00 00 07 19 01 02")), IsEmpty());
}

TEST(Primary, WhatIsCutShortOrLiesIsRefused) {
  const Bytes state = PrimaryState({});
  for (size_t length = 6; length < state.size(); ++length) {
    Bytes cut(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(length));
    cut[2] = static_cast<uint8_t>(length >> 8), cut[3] = static_cast<uint8_t>(length);
    const auto items = Parse(cut);
    // Between two sub-packages a shorter state is a whole one.
    EXPECT_EQ(items.has_value(), length == 52 || length == 61) << length;
  }
  for (const uint8_t size : Bytes{0, 4, 255}) {
    Bytes lie = state;
    lie[8] = size;  // of the first sub-package
    EXPECT_FALSE(Parse(lie)) << size;
  }
  EXPECT_FALSE(Parse(PrimaryMessage(7, Bytes(8, 0))));
  EXPECT_FALSE(Parse(PrimaryMessage(10, Bytes(7, 0))));
  Bytes long_title = KeyBody("PROGRAM_XXX_STARTED", "");
  long_title[8] = 200;
  EXPECT_FALSE(Parse(PrimaryMessage(7, long_title)));
  DhParameters dh;
  dh.a_m[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Parse(PrimaryState(dh)));
  for (const char* size : {"00 00 00 04 14", "ff ff ff ff 14", "7f ff ff ff 10"}) {
    PacketFramer framer(kPrimaryFormat);
    framer.Feed(FromHex(size));
    EXPECT_FALSE(framer.Next());
    EXPECT_TRUE(framer.broken()) << size;
  }
}

TEST(Primary, PacketsComeOutWhereverTheStreamIsCut) {
  const Bytes stream = PrimaryState({}) +
                       PrimaryMessage(7, KeyBody("PROGRAM_XXX_STARTED", "a")) + PrimaryState({}) +
                       PrimaryMessage(10, ExceptionBody(1, 2, "x"));
  for (size_t piece = 1; piece <= stream.size(); ++piece) {
    size_t items = 0;
    for (const auto& packet : Cut(kPrimaryFormat, stream, piece))
      items += ParsePrimaryPacket({packet.type, packet.payload}).value().size();
    ASSERT_EQ(items, 6u) << piece;
  }
}

TEST(ScriptRules, AGoodScriptHasNoFaults) {
  EXPECT_THAT(ScriptFaults("def go():\n  sync()\n\tif (True):\n  end\nend\n", "go"), IsEmpty());
}

TEST(ScriptRules, EachRuleIsNamed) {
  EXPECT_THAT(ScriptFaults("def go():\nsync()\nend\n", "go"),
              ElementsAre(HasSubstr("line 2 begins in column 0")));
  EXPECT_THAT(ScriptFaults("def go():\n\nend\n", "go"),
              ElementsAre(HasSubstr("line 2 begins in column 0")));
  EXPECT_THAT(ScriptFaults("def go():\n  sync()\nend", "go"),
              ElementsAre(HasSubstr("'end' with a newline")));
  EXPECT_THAT(ScriptFaults("def other():\n  sync()\nend\n", "go"),
              ElementsAre(HasSubstr("line 1 is not 'def go():'")));
  EXPECT_THAT(ScriptFaults("def go():\n  # 20 \xc2\xb0\nend\n", "go"),
              ElementsAre(HasSubstr("not printable ASCII")));
  const std::string name(32, 'a');
  EXPECT_THAT(ScriptFaults("def " + name + "():\n  sync()\nend\n", name),
              ElementsAre(HasSubstr("at most 31")));
  for (const char* wrong : {"", "1go", "go go", "_go", "g\n"})
    EXPECT_FALSE(ScriptFaults("def go():\nend\n", wrong).empty()) << wrong;
  // A second program behind the first would run unwatched.
  EXPECT_FALSE(ScriptFaults("def go():\n  sync()\nend\ndef b():\n  sync()\nend\n", "go").empty());
}

TEST(ScriptProgress, FollowsOneProgram) {
  ScriptProgress progress("go");
  progress.Take(KeyMessage{0, 0, "PROGRAM_XXX_STOPPED", "go"});  // of an earlier one
  EXPECT_FALSE(progress.started() || progress.stopped());
  progress.Take(KeyMessage{0, 0, "PROGRAM_XXX_STARTED", "go"});
  EXPECT_TRUE(progress.started() && !progress.stopped());
  progress.Take(KeyMessage{0, 0, "PROGRAM_XXX_STOPPED", "other"});
  EXPECT_FALSE(progress.stopped());
  progress.Take(KeyMessage{0, 0, "PROGRAM_XXX_STOPPED", "go"});
  EXPECT_TRUE(progress.stopped());
  EXPECT_FALSE(progress.foreign() || progress.exception() || progress.controller_error());
}

TEST(ScriptProgress, NamesWhatWentWrong) {
  ScriptProgress progress("go");
  progress.Take(ErrorCodeMessage{100, 1, 2, "warning"});
  EXPECT_FALSE(progress.controller_error());
  progress.Take(ErrorCodeMessage{153, 5, 3, "deviates"});
  EXPECT_EQ(progress.controller_error(), "C153A5: deviates");
  progress.Take(RuntimeExceptionMessage{12, 7, "syntax_error"});
  EXPECT_EQ(progress.exception(), "line 12, column 7: syntax_error");
  progress.Take(KeyMessage{0, 0, "PROGRAM_XXX_STARTED", "other"});
  EXPECT_EQ(progress.foreign(), "other");
  ScriptProgress read_only("go");
  read_only.Take(ErrorCodeMessage{210, 0, 0, ""});
  EXPECT_THAT(read_only.controller_error().value_or(""), HasSubstr("read-only"));
}

}  // namespace
}  // namespace sandwright
