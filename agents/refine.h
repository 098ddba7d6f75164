// Local search: strokes a little beside the best one so far.
#pragma once

#include "agents/stroke_judge.h"

namespace sandwright {

// `best` (a plan of one stroke) or what is better among `count` strokes drawn normally around it: an
// accepted one before any other.
JudgedPlan Refine(StrokeJudge& judge, const TaskView& view, JudgedPlan best, int64_t count,
                  RandomStream& stream);

}  // namespace sandwright
