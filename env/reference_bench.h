// What the environment around a reference task costs beside the task itself.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

namespace sandwright {

// Random actions through ReferenceVecEnv on one thread and, step by step in turn, through its core
// alone: the task without the batch, and for MuJoCo's bodies mj_step on the same controls from the
// same starts (equal to float32, so that ways part as chaos has it). `seconds` of one run; the median
// of five counts. Each row is given to `done` as it comes. Ctrl-C throws kInterrupted.
void RunReferenceBench(double seconds, const std::function<void(const nlohmann::json&)>& done);

}  // namespace sandwright
