// Gymnasium's tasks that trainers are compared on, equal to it in the last bit of float32, so that
// ours can be held against published scores. One task is one file beside this one.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "env/reference/numpy_random.h"

namespace sandwright {

struct ReferenceSpec {
  std::string name;                      // Gymnasium's id
  std::vector<std::string> observation;  // its numbers
  int choices;                           // discrete actions 0..choices-1; 0: numbers
  int action_size;                       // numbers in an action; 1 for a choice
  double action_limit;                   // numbers lie within +-action_limit; 1 for a choice
  int max_steps;                         // an episode is truncated there
};

struct ReferenceStep {
  double reward;
  bool terminated;
};

// One task in one state. Observations are written as float32 [spec().observation.size()].
class ReferenceTask {
 public:
  virtual ~ReferenceTask() = default;
  virtual const ReferenceSpec& spec() const = 0;
  // Draws what Gymnasium draws from the generator of the same seed.
  virtual void Reset(NumpyRandom& random, std::span<float> observation) = 0;
  // `action` [spec().action_size]: one that CheckAction lets pass. Beyond +-action_limit each task
  // does what Gymnasium's does.
  virtual ReferenceStep Step(std::span<const float> action, std::span<float> observation) = 0;
};

// Gymnasium's ids of what there is.
std::vector<std::string> ReferenceTaskNames();
// Throws Error for a name that is not among them.
std::unique_ptr<ReferenceTask> MakeReferenceTask(const std::string& name);

// Throws Error naming the task for a choice that there is not and for a number that is not finite.
void CheckAction(const ReferenceSpec& spec, std::span<const float> action);

// One of each, for MakeReferenceTask. Versions 4 and 5 differ in what Hopper is paid only.
std::unique_ptr<ReferenceTask> MakeAcrobot();
std::unique_ptr<ReferenceTask> MakeCartPole();
std::unique_ptr<ReferenceTask> MakeHalfCheetah(int version);
std::unique_ptr<ReferenceTask> MakeHopper(int version);
std::unique_ptr<ReferenceTask> MakeMountainCarContinuous();
std::unique_ptr<ReferenceTask> MakePendulum();

}  // namespace sandwright
