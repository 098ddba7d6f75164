#include "agents/refine.h"

namespace sandwright {
namespace {

constexpr double kSpread = 0.15;  // sd of each number around the best, on [-1, 1]

}  // namespace

Action ActionNear(const Action& centre, RandomStream& stream) {
  Action action{};
  for (size_t i = 0; i < action.size(); ++i)
    action[i] = WithinBounds(i, centre[i] + kSpread * stream.Normal());
  return action;
}

JudgedPlan Refine(StrokeJudge& judge, const TaskView& view, JudgedPlan best, int64_t count,
                  RandomStream& stream) {
  const Action centre = best.strokes.front();
  std::vector<StrokePlan> near;
  for (int64_t k = 0; k < count; ++k) near.push_back({ActionNear(centre, stream)});
  std::vector<JudgedPlan> judged = judge.Judge(view, std::move(near));
  judged.insert(judged.begin(), std::move(best));
  judge.KeepBest(view, 1, judged);
  return judged.front();
}

}  // namespace sandwright
