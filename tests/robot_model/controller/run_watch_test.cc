// The judge of a run, fed with made-up frames and events: each way to end, and each way not to.
#include "robot_model/controller/run_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_model/arm_program.h"
#include "robot_model/controller/arm_identity.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr size_t kKnots = 251;  // 2 s

JointAngles Planned(size_t knot) {
  JointAngles q;
  q.rad[0] = 0.4 * static_cast<double>(knot) / (kKnots - 1);
  return q;
}

RunPlan TwoSeconds() {
  RunPlan plan{"go", {}, 50, 75, 2.0};
  for (size_t i = 0; i < kKnots; ++i) plan.knots.push_back(Planned(i));
  return plan;
}

ArmState Ready() {
  ArmState state;
  state.timestamp_s = 600;
  state.robot_mode = RobotMode::kRunning;
  state.safety_mode = SafetyMode::kNormal;
  state.speed_scaling = state.target_speed_fraction = 1;
  // What an earlier program has left.
  state.output_registers = {3, static_cast<int32_t>(ProgramPhase::kFinished), 77};
  return state;
}

// A program that runs along the plan, one knot a frame.
struct Trial {
  RunWatch watch{TwoSeconds(), MotionLimits{}, {}, Ready()};
  ArmState state = Ready();
  size_t knot = 0;

  void Start() {
    watch.Take(KeyMessage{0, 0, "PROGRAM_XXX_STARTED", "go"});
    state.runtime_state = RuntimeState::kPlaying;
    state.output_registers = {0, static_cast<int32_t>(ProgramPhase::kRunning), 0};
  }
  RunSample Frame() {
    state.timestamp_s += 0.008;
    if (state.runtime_state == RuntimeState::kPlaying) {
      ++state.output_registers[2];
      knot = std::min(knot + 1, kKnots - 1);
    }
    state.actual_q = Planned(knot);
    return watch.Take(state);
  }
  void Frames(int count) {
    for (int i = 0; i < count; ++i) Frame();
  }
  void SetPhase(ProgramPhase phase) { state.output_registers[1] = static_cast<int32_t>(phase); }
  void Stopped() {
    watch.Take(KeyMessage{0, 0, "PROGRAM_XXX_STOPPED", "go"});
    state.runtime_state = RuntimeState::kStopped;
  }
  std::string Verdict() const {
    const auto verdict = watch.Judge();
    return verdict ? Name(verdict->end) : "goes on";
  }
};

TEST(RunWatch, FinishesWhenAllThreeAgree) {
  Trial run;
  run.Frames(20);
  EXPECT_EQ(run.Verdict(), "goes on");
  run.Start();
  run.Frames(260);
  run.SetPhase(ProgramPhase::kFinished);
  run.Frames(2);
  EXPECT_EQ(run.Verdict(), "goes on");
  run.state.runtime_state = RuntimeState::kStopped;
  run.Frames(2);
  EXPECT_EQ(run.Verdict(), "goes on");
  run.Stopped();
  EXPECT_EQ(run.Verdict(), "finished");
}

TEST(RunWatch, TwoOfThreeDoNotAgree) {
  Trial silent;  // the controller does not say that it stopped
  silent.Start();
  silent.Frames(260);
  silent.SetPhase(ProgramPhase::kFinished);
  silent.state.runtime_state = RuntimeState::kStopped;
  silent.Frames(80);
  EXPECT_EQ(silent.Verdict(), "program_ended");
  Trial early;  // the program has not reached its end
  early.Start();
  early.Frames(100);
  early.Stopped();
  early.Frames(10);
  EXPECT_EQ(early.Verdict(), "goes on");
  early.Frames(80);
  EXPECT_EQ(early.Verdict(), "program_ended");
}

TEST(RunWatch, LeftoversOfAnEarlierProgramAreNoSignOfThisOne) {
  Trial run;
  run.watch.Take(KeyMessage{0, 0, "PROGRAM_XXX_STARTED", "go"});
  run.watch.Take(KeyMessage{0, 0, "PROGRAM_XXX_STOPPED", "go"});
  run.Frames(5);
  EXPECT_EQ(run.Verdict(), "goes on");
  run.Frames(80);
  EXPECT_EQ(run.Verdict(), "program_ended");
}

TEST(RunWatch, FinishedElsewhereIsNotFinished) {
  Trial run;
  run.Start();
  run.Frames(200);  // knot 200 of 250
  run.SetPhase(ProgramPhase::kFinished);
  run.Stopped();
  run.Frames(1);
  EXPECT_EQ(run.Verdict(), "left_plan");
}

TEST(RunWatch, SafetyStopsAreTold) {
  const std::pair<SafetyMode, const char*> cases[] = {
      {SafetyMode::kProtectiveStop, "protective_stop"},
      {SafetyMode::kSafeguardStop, "safeguard_stop"},
      {SafetyMode::kSystemEmergencyStop, "emergency_stop"},
      {SafetyMode::kRobotEmergencyStop, "emergency_stop"},
      {SafetyMode::kViolation, "safety_fault"},
      {SafetyMode::kFault, "safety_fault"},
      {SafetyMode::kRecovery, "safety_fault"},
      {static_cast<SafetyMode>(42), "safety_fault"}};
  for (const auto& [mode, expected] : cases) {
    Trial run;
    run.Start();
    run.Frames(10);
    run.state.safety_mode = mode;
    run.watch.Take(ErrorCodeMessage{153, 0, 3, "what comes with it"});
    run.Frames(1);
    EXPECT_EQ(run.Verdict(), expected) << Name(mode);
  }
  const std::pair<int, const char*> bits[] = {
      {2, "protective_stop"}, {4, "safeguard_stop"}, {7, "emergency_stop"}, {9, "safety_fault"}};
  for (const auto& [bit, expected] : bits) {
    Trial run;
    run.Start();
    run.state.safety_status_bits = 1u << bit;
    run.Frames(1);
    EXPECT_EQ(run.Verdict(), expected) << bit;
  }
  Trial reduced;
  reduced.Start();
  reduced.state.safety_mode = SafetyMode::kReduced;
  reduced.Frames(10);
  EXPECT_EQ(reduced.Verdict(), "goes on");
  reduced.state.robot_mode = RobotMode::kPowerOff;
  reduced.Frames(1);
  EXPECT_EQ(reduced.Verdict(), "safety_fault");
  Trial stuck;  // the other connection knows
  stuck.Start();
  stuck.Frames(1);
  RobotModeData mode;
  mode.is_emergency_stopped = true;
  stuck.watch.Take(mode);
  EXPECT_EQ(stuck.Verdict(), "emergency_stop");
}

TEST(RunWatch, ScriptAndForeignFaultsAreTold) {
  Trial rejected;
  rejected.watch.Take(RuntimeExceptionMessage{3, 5, "syntax_error"});
  EXPECT_EQ(rejected.Verdict(), "script_error");
  EXPECT_THAT(rejected.watch.Judge()->reason, HasSubstr("line 3, column 5"));
  Trial foreign;
  foreign.Start();
  foreign.watch.Take(KeyMessage{0, 0, "PROGRAM_XXX_STARTED", "other"});
  EXPECT_EQ(foreign.Verdict(), "foreign_program");
  EXPECT_TRUE(foreign.watch.program_over());
}

TEST(RunWatch, TheProgramsOwnEndsAreTold) {
  const std::pair<ProgramPhase, const char*> cases[] = {
      {ProgramPhase::kNotAtStart, "not_at_start"},
      {ProgramPhase::kOtherTcp, "other_tcp"},
      {ProgramPhase::kOtherPayload, "other_payload"},
      {ProgramPhase::kBeatLost, "beat_lost"},
      {ProgramPhase::kAskedToStop, "program_ended"}};
  for (const auto& [phase, expected] : cases) {
    Trial run;
    run.Start();
    run.SetPhase(phase);
    run.Frames(1);
    EXPECT_EQ(run.Verdict(), expected);
  }
}

TEST(RunWatch, LeavingThePlanIsTold) {
  Trial run;
  run.Start();
  run.Frames(100);
  run.state.timestamp_s += 0.008;
  run.state.actual_q = Planned(100);
  run.state.actual_q.rad[3] += 0.06;
  EXPECT_NEAR(run.watch.Take(run.state).deviation_rad, 0.06, 1e-9);
  EXPECT_EQ(run.Verdict(), "left_plan");
}

TEST(RunWatch, DoesNotStart) {
  Trial run;
  run.Frames(1240);
  EXPECT_EQ(run.Verdict(), "goes on");
  run.Frames(20);
  EXPECT_EQ(run.Verdict(), "did_not_start");
}

TEST(RunWatch, TimeIsThePlansOwn) {
  const auto seconds_until_late = [](double slider, int paused_frames) {
    Trial run;
    run.Start();
    run.state.target_speed_fraction = slider;
    run.Frames(5);
    run.state.runtime_state = RuntimeState::kPaused;
    run.Frames(paused_frames);
    EXPECT_EQ(run.Verdict(), "goes on");
    run.state.runtime_state = RuntimeState::kPlaying;
    int frames = 0;
    while (run.Verdict() == "goes on" && frames < 100'000) run.Frame(), ++frames;
    EXPECT_EQ(run.Verdict(), "took_too_long");
    return frames * 0.008;
  };
  EXPECT_NEAR(seconds_until_late(1, 0), 6, 0.1);
  EXPECT_NEAR(seconds_until_late(0.3, 0), 20, 0.2);
  EXPECT_NEAR(seconds_until_late(1, 10'000), 6, 0.1);
}

TEST(MotionProgress, GoesForwardOnlyAndDoesNotTakeTheWayBack) {
  std::vector<JointAngles> there_and_back;
  for (int i = 0; i <= 200; ++i)
    there_and_back.push_back(Planned(static_cast<size_t>(i <= 100 ? i : 200 - i)));
  MotionProgress progress(there_and_back);
  for (size_t i = 0; i <= 50; ++i) progress.Take(Planned(i));
  EXPECT_EQ(progress.knot(), 50u);
  progress.Take(Planned(40));
  EXPECT_EQ(progress.knot(), 50u);
  EXPECT_GT(progress.deviation_rad(), 0.01);
  for (size_t i = 50; i <= 100; ++i) progress.Take(Planned(i));
  for (size_t i = 100; i > 70; --i) progress.Take(Planned(i));
  EXPECT_EQ(progress.knot(), 129u);
}

TEST(ForceGuard, TripsAtTheThirdSampleAndStaysTripped) {
  const ForceBaseline baseline(100, Eigen::Vector3d(10, 0, 0));
  ForceGuard guard(MotionLimits{}, baseline, 50, 75);
  const auto take = [&](size_t knot, double x) { guard.Take({knot, {x, 0, 0}}); };
  take(80, 51), take(80, 51), take(80, 49), take(80, 51), take(80, -31);
  EXPECT_FALSE(guard.tripped());  // never three in a row
  EXPECT_NEAR(guard.contact_n(), 41, 1e-9);
  take(80, 51);
  EXPECT_TRUE(guard.tripped());
  take(80, 10);
  EXPECT_TRUE(guard.tripped());
}

TEST(ForceGuard, IsCrudeWithoutBaselineAndBeforeTheStroke) {
  ForceGuard without(MotionLimits{}, {}, 50, 75),
      with(MotionLimits{}, ForceBaseline(9, Eigen::Vector3d::Zero()), 50, 75);
  for (int i = 0; i < 10; ++i) {
    without.Take({80, {0, 74, 0}});
    with.Take({49, {0, 74, 0}});
  }
  EXPECT_FALSE(without.tripped() || with.tripped());
  for (int i = 0; i < 3; ++i) without.Take({80, {0, 0, 76}});
  EXPECT_TRUE(without.tripped());
}

TEST(ForceGuard, EntryAndExitUseThePathsEnds) {
  const ForceBaseline baseline = {{10, 0, 0}, {20, 0, 0}, {30, 0, 0}};
  ForceGuard guard(MotionLimits{}, baseline, 50, 75);
  guard.Take({50, {10, 0, 0}});
  EXPECT_NEAR(guard.contact_n(), 0, 1e-12);
  guard.Take({76, {20, 0, 0}});
  EXPECT_NEAR(guard.contact_n(), 0, 1e-12);
  guard.Take({200, {30, 0, 0}});
  EXPECT_NEAR(guard.contact_n(), 0, 1e-12);
}

TEST(ForceGuard, BaselineIsAMeanThatBridgesGaps) {
  std::vector<ForceSample> lifted;
  for (size_t knot = 0; knot < 300; ++knot)
    if (knot < 140 || knot >= 190)
      lifted.push_back({knot, {knot % 2 ? 14.0 : 6.0, static_cast<double>(knot), 0}});
  const ForceBaseline baseline = MakeForceBaseline(lifted, 100, 250);
  ASSERT_EQ(baseline.size(), 150u);
  EXPECT_NEAR(baseline[20].x(), 10, 0.2);
  EXPECT_NEAR(baseline[20].y(), 120, 1e-9);
  EXPECT_NEAR(baseline[65].x(), 10, 0.5);
  EXPECT_TRUE(MakeForceBaseline(lifted, 140, 190).empty());
}

TEST(IdentityFaults, NameEachReason) {
  const Workcell cell;
  ArmIdentity arm{"UR10", "20173", {3, 15, 8, 1}, RobotMode::kRunning, SafetyMode::kReduced,
                  "STOPPED", cell.kinematics};
  EXPECT_THAT(IdentityFaults(arm, cell), IsEmpty());
  arm.kinematics.d_m[5] = std::nextafter(arm.kinematics.d_m[5], 1);
  ASSERT_EQ(IdentityFaults(arm, cell).size(), 1u);
  EXPECT_THAT(IdentityFaults(arm, cell)[0], HasSubstr("0.09220000000000"));
  EXPECT_THAT(IdentityFaults(arm, cell)[0], HasSubstr("0.0922]"));
  const std::pair<const char*, ControllerVersion> others[] = {{"UR10e", {5, 11, 0, 0}},
                                                              {"UR5", {3, 5, 0, 0}}};
  for (const auto& [model, version] : others) {
    arm.model = model;
    arm.version = version;
    arm.robot_mode = RobotMode::kIdle;
    arm.safety_mode = SafetyMode::kProtectiveStop;
    arm.program_state = "PAUSED";
    EXPECT_EQ(IdentityFaults(arm, cell).size(), 6u) << model;
  }
}

}  // namespace
}  // namespace sandwright
