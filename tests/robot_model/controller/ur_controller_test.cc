// The whole client against the fake controller: each fault, with the end that it must lead to.
#include "robot_model/controller/ur_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "data/base/error.h"
#include "robot_model/safety_gate.h"
#include "tests/support/controller_fake/controller_fake.h"

namespace sandwright {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

const Workcell& Cell() {
  static const Workcell cell;
  return cell;
}
const SafetyGate& Gate() {
  static const SafetyGate gate(Cell());
  return gate;
}
const HeightMap& Bed() {
  static const HeightMap bed{80, 120, 0.01, 0.05f};
  return bed;
}

ArmProgram TransferTo(const JointAngles& to, const JointAngles& from, const std::string& name) {
  const Passage passage = Gate().PassTransfer(to, Bed(), from);
  SAND_CHECK(passage.motion);
  return MakeArmProgram(*passage.motion, Gate(), name);
}
// Home to the camera's pose: over a second of motion.
ArmProgram ToCamera() { return TransferTo(Cell().camera_pose(), Cell().home(), "to_camera"); }

ControllerAddress Address(const ControllerFake& fake) {
  return {"127.0.0.1", fake.ports().dashboard, fake.ports().primary, fake.ports().rtde};
}

std::string RefusalOf(const ControllerFake& fake, const Workcell& cell = Cell()) {
  try {
    UrController controller(Address(fake), cell);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

// The outcome of a run during which `act` is called once the arm moves, or before it is sent.
RunOutcome RunWith(ControllerFake& fake, const std::function<void(UrController&)>& act,
                   bool once_moving = true) {
  UrController controller(Address(fake), Cell());
  std::thread actor;
  std::atomic<bool> acted = false;
  if (!once_moving) act(controller);
  const auto observer = [&](const RunSample& sample) {
    if (!once_moving || acted || sample.knot < 40) return;
    acted = true;
    // Not in the observer: the beat waits for it.
    actor = std::thread([&] { act(controller); });
  };
  const RunOutcome outcome = controller.Run(ToCamera(), observer);
  if (actor.joinable()) actor.join();
  if (outcome.end != RunEnd::kFinished) {
    // Latched, and nothing is sent again.
    const size_t scripts = fake.scripts().size();
    EXPECT_EQ(controller.Run(ToCamera()).end, RunEnd::kRefused);
    EXPECT_EQ(fake.scripts().size(), scripts);
    EXPECT_FALSE(outcome.reason.empty());
  }
  return outcome;
}

double DistanceFromCamera_rad(const ControllerFake& fake) {
  return (fake.joints().rad - Cell().camera_pose().rad).cwiseAbs().maxCoeff();
}

TEST(UrController, FinishesThereAndBackAgain) {
  ControllerFake fake;
  UrController controller(Address(fake), Cell());
  EXPECT_EQ(controller.identity().model, "UR10");
  EXPECT_EQ(controller.identity().serial_number, "2017309999");
  const RunOutcome there = controller.Run(ToCamera());
  ASSERT_EQ(there.end, RunEnd::kFinished) << there.reason;
  EXPECT_FALSE(there.stop_latency_s);
  EXPECT_LT(DistanceFromCamera_rad(fake), 1e-3);
  EXPECT_GT(there.samples.size(), static_cast<size_t>(ToCamera().duration_s() / 0.008 * 0.8));
  EXPECT_LT(there.samples.back().deviation_rad, 1e-3);
  const RunOutcome back =
      controller.Run(TransferTo(Cell().home(), Cell().camera_pose(), "to_home"));
  EXPECT_EQ(back.end, RunEnd::kFinished) << back.reason;
  EXPECT_EQ(fake.scripts().size(), 2u);
  EXPECT_EQ(controller.Run(ToCamera()).end, RunEnd::kFinished);
}

TEST(UrController, StrokeStaysOnItsPlan) {
  ControllerFake fake;
  UrController controller(Address(fake), Cell());
  const Stroke stroke{{{0.55, 0.35, 0.03}, {0.65, 0.35, 0.025}, {0.65, 0.45, 0.03}}, 1, 0.1};
  const Passage passage = Gate().PassStroke(stroke, Bed(), Cell().home());
  ASSERT_TRUE(passage.motion);
  const ArmProgram program = MakeArmProgram(*passage.motion, Gate(), "stroke");
  const RunOutcome outcome = controller.Run(program);
  ASSERT_EQ(outcome.end, RunEnd::kFinished) << outcome.reason;
  double deviation_rad = 0;
  for (const RunSample& sample : outcome.samples)
    deviation_rad = std::max(deviation_rad, sample.deviation_rad);
  EXPECT_LT(deviation_rad, 0.5 * RunWatch::kLargestDeviation_rad);
  EXPECT_EQ(outcome.samples.back().knot, passage.motion->knots().size() - 1);
}

TEST(UrController, OperatorStops) {
  ControllerFake fake;
  const RunOutcome outcome = RunWith(fake, [](UrController& controller) { controller.Stop(); });
  EXPECT_EQ(outcome.end, RunEnd::kStoppedByOperator) << outcome.reason;
  ASSERT_TRUE(outcome.stop_latency_s) << outcome.reason;
  EXPECT_LT(*outcome.stop_latency_s, 0.6);
  EXPECT_FALSE(fake.ProgramRunning());
  EXPECT_GT(DistanceFromCamera_rad(fake), 0.01);
}

TEST(UrController, SafetySystemStops) {
  const std::pair<std::function<void(ControllerFake&)>, RunEnd> cases[] = {
      {[](ControllerFake& fake) { fake.ProtectiveStop(); }, RunEnd::kProtectiveStop},
      {[](ControllerFake& fake) { fake.SafeguardStop(true); }, RunEnd::kSafeguardStop},
      {[](ControllerFake& fake) { fake.EmergencyStop(); }, RunEnd::kEmergencyStop}};
  for (const auto& [stop, end] : cases) {
    ControllerFake fake;
    const RunOutcome outcome = RunWith(fake, [&](UrController&) { stop(fake); });
    EXPECT_EQ(outcome.end, end) << Name(outcome.end) << ": " << outcome.reason;
    EXPECT_TRUE(outcome.stop_latency_s) << outcome.reason;
    EXPECT_FALSE(fake.ProgramRunning()) << Name(end);
    // A safeguard that is released must not set the arm going again.
    fake.SafeguardStop(false);
    const JointAngles at = fake.joints();
    std::this_thread::sleep_for(200ms);
    EXPECT_EQ(fake.joints().rad, at.rad) << Name(end);
  }
}

TEST(UrController, ContactStops) {
  ControllerFake fake;
  const RunOutcome outcome =
      RunWith(fake, [&](UrController&) { fake.ForceSpike(120, 0.2); });
  EXPECT_EQ(outcome.end, RunEnd::kForce) << outcome.reason;
  EXPECT_TRUE(outcome.stop_latency_s);
}

TEST(UrController, AShortKnockDoesNot) {
  ControllerFake fake;
  const RunOutcome outcome =
      RunWith(fake, [&](UrController&) { fake.ForceSpike(120, 0.012); });
  EXPECT_EQ(outcome.end, RunEnd::kFinished) << outcome.reason;
}

TEST(UrController, SilenceStops) {
  for (const double stall_s : {1.0, 3.5}) {
    ControllerFake fake;
    const RunOutcome outcome = RunWith(fake, [&](UrController&) { fake.StallRtde(stall_s); });
    EXPECT_EQ(outcome.end, RunEnd::kLinkLost) << outcome.reason;
    EXPECT_FALSE(fake.ProgramRunning());
  }
}

TEST(UrController, LostConnectionsStop) {
  for (const bool reset : {false, true}) {
    ControllerFake fake;
    const RunOutcome outcome =
        RunWith(fake, [&](UrController&) { fake.CloseConnections(reset); });
    EXPECT_EQ(outcome.end, RunEnd::kLinkLost) << outcome.reason;
    // Nothing can be told any more; the program misses the beat and stops by itself.
    std::this_thread::sleep_for(500ms);
    EXPECT_FALSE(fake.ProgramRunning());
  }
}

TEST(UrController, SlowAndPausedRunsFinish) {
  ControllerFakeOptions options;
  options.speed_slider = 0.3;
  ControllerFake slow(options);
  EXPECT_EQ(RunWith(slow, [](UrController&) {}).end, RunEnd::kFinished);
  ControllerFake paused;
  const RunOutcome outcome = RunWith(paused, [&](UrController&) {
    paused.PausePendant();
    std::this_thread::sleep_for(1s);
    paused.ResumePendant();
  });
  EXPECT_EQ(outcome.end, RunEnd::kFinished) << outcome.reason;
}

TEST(UrController, OtherProgramsEndTheRun) {
  ControllerFake stopped;
  EXPECT_EQ(RunWith(stopped, [&](UrController&) { stopped.StopPendant(); }).end,
            RunEnd::kProgramEnded);
  ControllerFake fake;
  const RunOutcome outcome =
      RunWith(fake, [&](UrController&) { fake.StartForeignProgram("other"); });
  EXPECT_EQ(outcome.end, RunEnd::kForeignProgram) << outcome.reason;
  EXPECT_THAT(outcome.reason, HasSubstr("other"));
  EXPECT_TRUE(fake.ProgramRunning());  // not ours to stop
}

TEST(UrController, ScriptFaultsAndSilenceAboutItAreTold) {
  ControllerFake rejecting;
  rejecting.RejectScripts();
  const RunOutcome rejected = RunWith(rejecting, [](UrController&) {}, false);
  EXPECT_EQ(rejected.end, RunEnd::kScriptError) << rejected.reason;
  EXPECT_THAT(rejected.reason, HasSubstr("line 1, column 1"));
  ControllerFake mute;
  mute.SwallowKeyMessages();
  EXPECT_EQ(RunWith(mute, [](UrController&) {}).end, RunEnd::kProgramEnded);
  ControllerFake late;
  late.DelayKeyMessages(0.2);
  EXPECT_EQ(RunWith(late, [](UrController&) {}).end, RunEnd::kFinished);
}

TEST(UrController, StartElsewhereIsNotSent) {
  ControllerFake fake;
  JointAngles elsewhere = Cell().home();
  elsewhere.rad[2] += 0.2;
  const RunOutcome outcome = RunWith(
      fake,
      [&](UrController&) {
        fake.JogTo(elsewhere);
        std::this_thread::sleep_for(100ms);
      },
      false);
  EXPECT_EQ(outcome.end, RunEnd::kNotAtStart) << outcome.reason;
  EXPECT_TRUE(fake.scripts().empty());
}

TEST(UrController, OtherToolIsToldByTheProgram) {
  ControllerFakeOptions options;
  options.X_FT.translation().z() = 0.26;
  ControllerFake other_tcp(options);
  EXPECT_EQ(RunWith(other_tcp, [](UrController&) {}).end, RunEnd::kOtherTcp);
  options = {};
  options.payload_kg = 1;
  ControllerFake other_payload(options);
  EXPECT_EQ(RunWith(other_payload, [](UrController&) {}).end, RunEnd::kOtherPayload);
}

TEST(UrController, AStuckObserverStopsTheArm) {
  ControllerFake fake;
  UrController controller(Address(fake), Cell());
  bool slept = false;
  const RunOutcome outcome = controller.Run(ToCamera(), [&](const RunSample& sample) {
    if (slept || sample.knot < 40) return;
    slept = true;
    std::this_thread::sleep_for(400ms);
  });
  EXPECT_EQ(outcome.end, RunEnd::kBeatLost) << outcome.reason;
  UrController again(Address(fake), Cell());
  ControllerFake other;
  UrController thrower(Address(other), Cell());
  const RunOutcome thrown = thrower.Run(
      ToCamera(), [](const RunSample&) { throw std::runtime_error("disk full"); });
  EXPECT_EQ(thrown.end, RunEnd::kInternalFault);
  EXPECT_THAT(thrown.reason, HasSubstr("disk full"));
}

TEST(UrController, BytesMayComeInAnyPieces) {
  ControllerFake fake;
  fake.SplitBytes(true);
  EXPECT_EQ(RunWith(fake, [](UrController&) {}).end, RunEnd::kFinished);
  ControllerFake lumps;
  lumps.CoalesceFrames(true);
  EXPECT_EQ(RunWith(lumps, [](UrController&) {}).end, RunEnd::kFinished);
}

TEST(UrController, OtherArmsAndStatesAreRefused) {
  const auto refusal = [](const std::function<void(ControllerFakeOptions&)>& change) {
    ControllerFakeOptions options;
    change(options);
    return RefusalOf(ControllerFake(options));
  };
  EXPECT_THAT(refusal([](auto& o) { o.model = "UR5"; }), HasSubstr("'UR5'; allowed: UR10"));
  EXPECT_THAT(refusal([](auto& o) { o.version = {3, 5, 0, 1}; }), HasSubstr("3.5.0.1; allowed"));
  EXPECT_THAT(refusal([](auto& o) { o.version = {5, 11, 0, 1}; }), HasSubstr("5.11.0.1; allowed"));
  EXPECT_THAT(refusal([](auto& o) { o.time_offset_s = 5; }), HasSubstr("booting"));
  EXPECT_THAT(refusal([](auto& o) { o.powered = false; }),
              HasSubstr("POWER_OFF; allowed: RUNNING"));
  EXPECT_THAT(refusal([](auto& o) { o.dh.d_m[0] += 1e-9; }), HasSubstr("calibration"));
}

TEST(UrController, BusyAndDeafControllersAreRefused) {
  ControllerFake stopped;
  stopped.ProtectiveStop();
  std::this_thread::sleep_for(50ms);
  EXPECT_THAT(RefusalOf(stopped), HasSubstr("PROTECTIVE_STOP; allowed: NORMAL"));
  ControllerFake busy;
  busy.StartForeignProgram();
  std::this_thread::sleep_for(50ms);
  EXPECT_THAT(RefusalOf(busy), HasSubstr("a program is there"));
  ControllerFake lacking;
  lacking.HideVariable("safety_status_bits");
  EXPECT_THAT(RefusalOf(lacking), HasSubstr("does not know safety_status_bits (NOT_FOUND)"));
  ControllerFake taken;
  taken.OccupyInput("input_int_register_0");
  EXPECT_THAT(RefusalOf(taken), HasSubstr("writes input_int_register_0 (IN_USE)"));
  ControllerFake old;
  old.SpeakOnlyProtocol1();
  EXPECT_THAT(RefusalOf(old), HasSubstr("refuses protocol version 2"));
}

TEST(UrController, AddressesBeyondThisMachineMustBeArmed) {
  EXPECT_THROW(CheckArmed({"192.0.2.1"}, false), Error);
  EXPECT_NO_THROW(CheckArmed({"192.0.2.1"}, true));
  EXPECT_NO_THROW(CheckArmed({"127.0.0.2"}, false));
  try {
    UrController controller({"192.0.2.1"}, Cell());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kRefused);
    EXPECT_THAT(error.what(), HasSubstr("everybody on its network can move it"));
  }
}

}  // namespace
}  // namespace sandwright
