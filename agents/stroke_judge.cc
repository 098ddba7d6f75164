#include "agents/stroke_judge.h"

#include <algorithm>

#include "data/task.h"

namespace sandwright {
namespace {

constexpr size_t kBatchBytes = 128u << 20;

size_t BatchSize(const HeightMap& map) {
  return std::clamp<size_t>(kBatchBytes / (map.size() * sizeof(float)), 1, 1024);
}

}  // namespace

std::vector<SandState> StrokeJudge::Imagine(const TaskView& view, const SandState& start,
                                            std::span<const StrokePlan> plans) {
  std::vector<SandState> states(plans.size(), start);
  const size_t length = plans.front().size();
  for (size_t step = 0; step < length; ++step) {
    std::vector<Stroke> strokes;
    for (size_t i = 0; i < plans.size(); ++i) {
      SAND_CHECK(plans[i].size() == length, plans[i].size(), length);
      strokes.push_back(tool_.Decode(plans[i][step], states[i].map(), view.region));
    }
    model_.Apply(states, strokes);
    model_evaluations_ += static_cast<int64_t>(plans.size());
  }
  return states;
}

std::vector<JudgedPlan> StrokeJudge::Judge(const TaskView& view, std::vector<StrokePlan> plans) {
  const SandState start = model_.Start(view.sensed, 0);
  const size_t batch = BatchSize(view.sensed);
  std::vector<JudgedPlan> judged;
  for (size_t first = 0; first < plans.size(); first += batch) {
    const auto part = std::span(plans).subspan(first, std::min(batch, plans.size() - first));
    const std::vector<SandState> after = Imagine(view, start, part);
    for (size_t i = 0; i < part.size(); ++i)
      judged.push_back({std::move(part[i]), GoalError(after[i].map(), view.goal), std::nullopt});
  }
  return judged;
}

void StrokeJudge::KeepBest(const TaskView& view, size_t count,
                           std::vector<JudgedPlan>& plans) const {
  std::ranges::stable_sort(plans, {}, &JudgedPlan::error_m);
  size_t accepted = 0;
  for (JudgedPlan& plan : plans) {
    if (accepted == count) break;
    if (!plan.accepted) plan.accepted = tool_.Accepts(view, plan.strokes.front());
    accepted += *plan.accepted;
  }
  std::ranges::stable_partition(plans, [](const auto& p) { return p.accepted.value_or(false); });
  plans.resize(std::min(count, plans.size()));
}

}  // namespace sandwright
