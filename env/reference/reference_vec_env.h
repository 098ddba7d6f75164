// One reference task as trainers see it: N episodes stepped together.
#pragma once

#include "env/reference/reference_task.h"
#include "env/vec_env.h"

namespace sandwright {

// As Gymnasium's SyncVectorEnv with AutoresetMode.SAME_STEP: row i (first_row + i of a larger one)
// starts from the generator of seed + i and goes on with it from episode to episode; results do not
// depend on `threads`, which are started anew in each step and so pay on MuJoCo's bodies only. Two
// differences: numbers in an
// action are shares of ReferenceSpec::action_limit, and a row that terminates in its last step is
// not truncated as well. The constructor resets by seed 0.
class ReferenceVecEnv final : public VecEnv {
 public:
  // `name` as MakeReferenceTask takes it. Throws Error for another one and for less than one row.
  ReferenceVecEnv(const std::string& name, int num_envs, int threads = 1,
                  uint64_t first_row = 0);

  int num_envs() const override { return static_cast<int>(rows_.size()); }
  const ObservationSpec& observation_spec() const override { return observation_spec_; }
  int action_size() const override { return spec().action_size; }
  int choices() const override { return spec().choices; }
  const ReferenceSpec& spec() const { return rows_.front().task->spec(); }

  ObservationBatch Reset(uint64_t seed) override;
  // Throws Error, with nothing stepped, as CheckAction does. Summaries carry no metrics.
  StepBatch Step(std::span<const float> action_na) override;

 private:
  struct Row {
    std::unique_ptr<ReferenceTask> task;
    NumpyRandom random;
    EpisodeSummary episode, finished;
  };
  void StepRow(size_t i, std::span<const float> action_na, StepBatch& batch);
  // body(row) for all rows, an equal part of them on each thread.
  template <class Body>
  void ForRows(const Body& body);

  std::vector<Row> rows_;
  ObservationSpec observation_spec_;
  int threads_;
  uint64_t first_row_;
};

}  // namespace sandwright
