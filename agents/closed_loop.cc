#include "agents/closed_loop.h"

#include <algorithm>
#include <chrono>

#include "data/base/stop.h"

namespace sandwright {
namespace {

// Milliseconds since `start`, which is moved to now.
double Lap_ms(std::chrono::steady_clock::time_point& start) {
  const auto now = std::chrono::steady_clock::now();
  const double ms = std::chrono::duration<double, std::milli>(now - start).count();
  start = now;
  return ms;
}

}  // namespace

int ShapingRun::rejected() const {
  return static_cast<int>(
      std::ranges::count_if(strokes, [](auto& s) { return !s.verdict.accepted; }));
}

Stroke ChooseStroke(Agent& agent, const ShapingJob& job, const HeightMap& sensed, int strokes_used,
                    int rejected_in_a_row, const SafetyGate& gate, const Blade& blade,
                    RandomStream& stream) {
  const TaskView view{.sensed = sensed,
                      .goal = job.goal,
                      .region = job.region,
                      .strokes_used = strokes_used,
                      .max_strokes = job.max_strokes,
                      .rejected_in_a_row = rejected_in_a_row,
                      .gate = &gate};
  const Action action = agent.Act({&view, 1}, {&stream, 1}).front();
  return DecodeAction(action, sensed, job.region, blade, job.speed_mps);
}

ShapingRun RunClosedLoop(Agent& agent, const SandModel& model, const SafetyGate& gate,
                         const ShapingJob& job, RandomStream stream, const Execute& execute) {
  CheckTask({job.terrain, job.goal, job.max_strokes}, "shaping job");
  if (job.terrain.datum != Datum::kFloor)
    throw Error("the terrain's datum is relative: strokes need heights above the box floor");
  ShapingRun run{.start_error_m = GoalError(job.terrain, job.goal)};
  HeightMap sensed = job.terrain;
  std::optional<JointAngles> arm;  // where the last stroke left it
  int rejected_in_a_row = 0;
  while (static_cast<int>(run.strokes.size()) < job.max_strokes &&
         rejected_in_a_row < job.max_rejected_in_a_row &&
         run.final_error_m() > job.success_error_m) {
    run.stopped = StopRequested();
    if (run.stopped) break;
    ShapingStroke step;
    auto clock = std::chrono::steady_clock::now();
    step.stroke = ChooseStroke(agent, job, sensed, static_cast<int>(run.strokes.size()),
                               rejected_in_a_row, gate, model.blade(), stream);
    step.choose_ms = Lap_ms(clock);
    step.verdict = gate.Check(step.stroke, sensed, GateSampling::kFine, arm);
    step.gate_ms = Lap_ms(clock);
    step.before = step.predicted = step.after = sensed;
    rejected_in_a_row = step.verdict.accepted ? 0 : rejected_in_a_row + 1;
    if (step.verdict.accepted) {
      arm = step.verdict.motion->knots.back();
      SandState state = model.Start(sensed, 0);
      model.Apply({&state, 1}, {&step.stroke, 1});
      step.predicted = state.map();
      step.predict_ms = Lap_ms(clock);
      step.after = execute ? execute(step.stroke) : step.predicted;
      sensed = step.after;
    }
    step.goal_error_m = GoalError(sensed, job.goal);
    run.strokes.push_back(std::move(step));
  }
  return run;
}

}  // namespace sandwright
