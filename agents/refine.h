// Local search: strokes a little beside the best one so far.
#pragma once

#include "agents/stroke_judge.h"

namespace sandwright {

// An action drawn around `centre`: normal, sd 0.15 in each number, within the bounds.
Action ActionNear(const Action& centre, RandomStream& stream);

// `best` (a plan of one stroke) or what is better among `count` strokes drawn normally around it: an
// accepted one before any other.
JudgedPlan Refine(StrokeJudge& judge, const TaskView& view, JudgedPlan best, int64_t count,
                  RandomStream& stream);

}  // namespace sandwright
