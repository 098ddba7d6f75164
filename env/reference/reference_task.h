// Gymnasium's classic-control tasks, equal to it in the last bit of float32, so that trainers can be held
// against published scores. One task is one file beside this one.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "env/reference/numpy_random.h"

namespace sandwright {

struct ReferenceSpec {
  std::string name;         // Gymnasium's id
  int observation_size;
  int choices;              // discrete actions 0..choices-1; 0: one number within +-action_limit
  double action_limit;
  int max_steps;            // an episode is truncated there
};

struct ReferenceStep {
  double reward;
  bool terminated;
};

// One task in one state. Observations are written as float32 [spec().observation_size].
class ReferenceTask {
 public:
  virtual ~ReferenceTask() = default;
  virtual const ReferenceSpec& spec() const = 0;
  // Draws what Gymnasium draws from the generator of the same seed.
  virtual void Reset(NumpyRandom& random, std::span<float> observation) = 0;
  // `action`: the number, or a choice. Throws Error for a choice that there is not.
  virtual ReferenceStep Step(float action, std::span<float> observation) = 0;
};

// CartPole-v1, Acrobot-v1, Pendulum-v1, MountainCarContinuous-v0; Error for another name.
std::unique_ptr<ReferenceTask> MakeReferenceTask(const std::string& name);

// One of each, for MakeReferenceTask.
std::unique_ptr<ReferenceTask> MakeAcrobot();
std::unique_ptr<ReferenceTask> MakeCartPole();
std::unique_ptr<ReferenceTask> MakeMountainCarContinuous();
std::unique_ptr<ReferenceTask> MakePendulum();

// `action` as one of `choices`. Throws Error naming the task.
int ChoiceOf(float action, const ReferenceSpec& spec);

}  // namespace sandwright
