// Dashboard lines in the wordings of several versions, and lines that answer something else.
#include "robot_model/controller/dashboard.h"

#include <gtest/gtest.h>

namespace sandwright {
namespace {

std::vector<std::string> Lines(const std::string& stream, size_t piece) {
  LineFramer framer;
  std::vector<std::string> lines;
  for (size_t at = 0; at < stream.size(); at += piece) {
    const std::string part = stream.substr(at, piece);
    framer.Feed(std::span(reinterpret_cast<const uint8_t*>(part.data()), part.size()));
    while (const auto line = framer.Next()) lines.push_back(*line);
  }
  return lines;
}

TEST(Dashboard, LinesComeOutWhereverTheStreamIsCut) {
  const std::string stream = "Stopped\nRobotmode: RUNNING\r\n\nlate\x01\nunfinished";
  const std::vector<std::string> expected = {"Stopped", "Robotmode: RUNNING", "", "late?"};
  for (size_t piece = 1; piece <= stream.size(); ++piece) EXPECT_EQ(Lines(stream, piece), expected);
}

TEST(Dashboard, ALineWithoutEndIsNotKeptForever) {
  LineFramer framer;
  const std::vector<uint8_t> bytes(LineFramer::kLongest + 1, 'x');
  framer.Feed(bytes);
  EXPECT_FALSE(framer.Next());
  EXPECT_TRUE(framer.broken());
  framer.Feed(bytes);
  EXPECT_EQ(framer.held_bytes(), 0u);
}

TEST(Dashboard, BannerIsRecognised) {
  EXPECT_TRUE(IsDashboardBanner("Connected: Universal Robots Dashboard Server"));
  EXPECT_FALSE(IsDashboardBanner("SSH-2.0-OpenSSH_6.0"));
}

TEST(Dashboard, ModesAreReadInAnyCase) {
  EXPECT_EQ(ParseRobotMode("Robotmode: RUNNING"), RobotMode::kRunning);
  EXPECT_EQ(ParseRobotMode("robotmode: Power_off"), RobotMode::kPowerOff);
  EXPECT_EQ(ParseRobotMode("Robotmode: NO_CONTROLLER"), RobotMode::kNoController);
  EXPECT_EQ(ParseSafetyMode("Safetymode: NORMAL"), SafetyMode::kNormal);
  EXPECT_EQ(ParseSafetyMode("Safetymode: PROTECTIVE_STOP"), SafetyMode::kProtectiveStop);
  EXPECT_EQ(ParseSafetyMode("Safetymode: ROBOT_EMERGENCY_STOP"), SafetyMode::kRobotEmergencyStop);
  for (const char* wrong : {"", "Robotmode:", "Robotmode: RUNNING WILD", "RUNNING",
                            "could not understand: 'robotmode'", "Safetymode: NORMAL"})
    EXPECT_FALSE(ParseRobotMode(wrong)) << wrong;
  EXPECT_FALSE(ParseSafetyMode("Robotmode: RUNNING"));
}

TEST(Dashboard, RunningIsReadInBothWordings) {
  EXPECT_EQ(ParseProgramRunning("Program running: true"), true);
  EXPECT_EQ(ParseProgramRunning("Robot running: False"), false);
  EXPECT_FALSE(ParseProgramRunning("Program running: maybe"));
  EXPECT_FALSE(ParseProgramRunning("true"));
  EXPECT_EQ(ParseProgramState("STOPPED stroke.urp"), "STOPPED");
  EXPECT_EQ(ParseProgramState("PLAYING"), "PLAYING");
  EXPECT_FALSE(ParseProgramState("Failed"));
  EXPECT_TRUE(IsStopped("Stopped"));
  EXPECT_FALSE(IsStopped("Failed to execute: stop"));
}

TEST(Dashboard, VersionIsTheFirstDottedNumber) {
  EXPECT_EQ(ParsePolyscopeVersion("URSoftware 3.15.8.106339 (Mar 01 2022)"),
            (ControllerVersion{3, 15, 8, 106339}));
  EXPECT_EQ(ParsePolyscopeVersion("3.14"), (ControllerVersion{3, 14, 0, 0}));
  for (const char* wrong : {"", "URSoftware", "4711", "99999999999.1.1.1"})
    EXPECT_FALSE(ParsePolyscopeVersion(wrong)) << wrong;
}

}  // namespace
}  // namespace sandwright
