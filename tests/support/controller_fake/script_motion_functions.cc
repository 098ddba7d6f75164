// movej, movel, movep, speedj, speedl, servoj, stopj, stopl.
#include <cmath>
#include <exception>

#include "tests/support/controller_fake/script_functions.h"

namespace sandwright::fake {
namespace {

using Evaluator = ScriptEvaluator;

constexpr double kAbandonedStop_radps2 = 8;
constexpr double kStopjDefault_radps2 = 2, kStoplDefault_mps2 = 20;

// While it lives, its thread moves the arm. A thread that is killed meanwhile leaves an arm that
// slows down.
class ArmClaim {
 public:
  explicit ArmClaim(Evaluator& evaluator)
      : evaluator_(evaluator), unwinding_(std::uncaught_exceptions()) {
    evaluator.runner().ClaimArm(evaluator.thread_id());
    if (!evaluator.machine().state.MayMove()) throw ScriptError("the arm may not move now");
  }
  ~ArmClaim() {
    evaluator_.runner().ReleaseArm();
    if (std::uncaught_exceptions() > unwinding_)
      evaluator_.machine().arm.Stop(kAbandonedStop_radps2);
  }
  ArmClaim(const ArmClaim&) = delete;
  ArmClaim& operator=(const ArmClaim&) = delete;

  FakeArm& arm() { return evaluator_.machine().arm; }
  // Periods of the controller, at least one.
  void Hold(double duration_s) {
    for (double left = duration_s; left > 1e-9; left -= kControlPeriod_s) evaluator_.Yield();
    if (duration_s <= 0) evaluator_.Yield();
  }

 private:
  Evaluator& evaluator_;
  int unwinding_;
};

JointAngles JointTarget(Evaluator& evaluator, const Value& target) {
  if (!target.As<PoseValue>()) return {target.Six()};
  FakeArm& arm = evaluator.machine().arm;
  const auto q = arm.Inverse(target.ToIsometry(), arm.q());
  if (!q) throw ScriptError("the pose is out of reach");
  return *q;
}

Eigen::Isometry3d PoseTarget(Evaluator& evaluator, const Value& target) {
  if (target.As<PoseValue>()) return target.ToIsometry();
  const FakeArm& arm = evaluator.machine().arm;
  return arm.kinematics().Forward({target.Six()}) * arm.tcp();
}

void Move(Evaluator& evaluator, MoveCommand command) {
  if (command.speed <= 0 || command.acceleration <= 0)
    throw ScriptError("speed and acceleration must be over 0");
  ArmClaim claim(evaluator);
  claim.arm().StartMove(command);
  if (!claim.arm().MoveDone()) evaluator.Yield([&] { return claim.arm().MoveDone(); });
}

Value MoveJ(Evaluator& evaluator, const Arguments& a) {
  MoveCommand command;
  command.q = JointTarget(evaluator, a.At(0, "q"));
  command.acceleration = a.Number(1, "a", 1.4);
  command.speed = a.Number(2, "v", 1.05);
  command.duration_s = a.Number(3, "t", 0);
  command.blend_m = a.Number(4, "r", 0);
  Move(evaluator, command);
  return {};
}

Value MoveL(Evaluator& evaluator, const Arguments& a) {
  MoveCommand command;
  command.in_space = true;
  command.X_WT = PoseTarget(evaluator, a.At(0, "pose"));
  command.acceleration = a.Number(1, "a", 1.2);
  command.speed = a.Number(2, "v", 0.25);
  command.duration_s = a.Number(3, "t", 0);
  command.blend_m = a.Number(4, "r", 0);
  Move(evaluator, command);
  return {};
}

Value MoveP(Evaluator& evaluator, const Arguments& a) {
  MoveCommand command;
  command.in_space = true;
  command.X_WT = PoseTarget(evaluator, a.At(0, "pose"));
  command.acceleration = a.Number(1, "a", 1.2);
  command.speed = a.Number(2, "v", 0.25);
  command.blend_m = a.Number(3, "r", 0);
  Move(evaluator, command);
  return {};
}

// Without a time, until the speed is reached.
template <class Start>
Value Speed(Evaluator& evaluator, const Arguments& a, Start start) {
  ArmClaim claim(evaluator);
  start(claim.arm());
  const double duration_s = a.Number(2, "t", 0);
  claim.Hold(duration_s);
  while (duration_s <= 0 && !claim.arm().SpeedReached()) evaluator.Yield();
  return {};
}

Value SpeedJ(Evaluator& evaluator, const Arguments& a) {
  const Vector6 speed = a.At(0, "qd").Six();
  const double acceleration = a.Number(1, "a", 1.4);
  return Speed(evaluator, a, [&](FakeArm& arm) { arm.StartSpeed(speed, acceleration); });
}

Value SpeedL(Evaluator& evaluator, const Arguments& a) {
  const Vector6 twist = a.At(0, "xd").Six();
  const double acceleration = a.Number(1, "a", 1.2);
  return Speed(evaluator, a, [&](FakeArm& arm) { arm.StartTwist(twist, acceleration); });
}

Value ServoJ(Evaluator& evaluator, const Arguments& a) {
  ArmClaim claim(evaluator);
  claim.arm().Servo({a.At(0, "q").Six()}, a.Number(4, "lookahead_time", 0.1));
  claim.Hold(a.Number(3, "t", kControlPeriod_s));
  return {};
}

void Stop(Evaluator& evaluator, double acceleration) {
  ArmClaim claim(evaluator);
  claim.arm().Stop(acceleration);
  if (!claim.arm().AtRest()) evaluator.Yield([&] { return claim.arm().AtRest(); });
}

}  // namespace

void AddMotionFunctions(BuiltIns& functions) {
  functions["movej"] = MoveJ;
  functions["movel"] = MoveL;
  functions["movep"] = MoveP;
  functions["speedj"] = SpeedJ;
  functions["speedl"] = SpeedL;
  functions["servoj"] = ServoJ;
  functions["stopj"] = [](Evaluator& evaluator, const Arguments& a) -> Value {
    Stop(evaluator, a.Number(0, "a", kStopjDefault_radps2));
    return {};
  };
  functions["stopl"] = [](Evaluator& evaluator, const Arguments& a) -> Value {
    Stop(evaluator, a.Number(0, "a", kStoplDefault_mps2));
    return {};
  };
}

}  // namespace sandwright::fake
