// What is trained, in its world: the trainer, how it is judged, and what is kept of it.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "agents/train.h"
#include "agents/trainer.h"

namespace sandwright {

// How well the deterministic policy does on what no training saw.
struct Verdict {
  double cost;                            // the less the better
  std::map<std::string, double> scalars;  // eval/...
  std::string note;                       // for the progress line
  cv::Mat picture = {};                   // of some of what it was evaluated on, BGR; or empty
};

class Training {
 public:
  virtual ~Training() = default;
  virtual Trainer& trainer() = 0;
  // Nothing after Ctrl-C: half-played episodes tell nothing.
  virtual std::optional<Verdict> Evaluate() = 0;
  // The part of the configuration that a cost depends on.
  virtual nlohmann::json EvaluatedOn() const = 0;
  // The policy as a file.
  virtual Safetensors Pack() = 0;
  // Throws Error naming `source` and what differs where that is another training's checkpoint.
  virtual void CheckSame(const Safetensors& checkpoint, const std::string& source) const = 0;
  // What `train --json` shows of the last verdict and the least cost of all.
  virtual nlohmann::json Result(const Verdict& last, double least_cost) const = 0;
};

// Any algorithm on the sand.
std::unique_ptr<Training> MakeSandTraining(const TrainConfig& config, const TrainRun& run);
// Any algorithm on the reference task of that name; the final evaluation is the result.
std::unique_ptr<Training> MakeReferenceTraining(const TrainConfig& config, const TrainRun& run);

}  // namespace sandwright
