// Evaluation in worlds where a stroke takes a minute (grains): one task after the other, each stroke
// kept on disk as it is done, so that hours of it can be stopped and continued.
#pragma once

#include "agents/evaluate.h"

namespace sandwright {

struct KeptIn {
  std::filesystem::path folder;  // of one agent
  // Of world and agent. Strokes that are kept with others, or for another task, seed or episode, are
  // refused.
  nlohmann::json settings = nlohmann::json::object();
};

// As Evaluate, but with random streams of each stroke's own. FOLDER/task_NNNNN.h5 are stroke files that
// grow by a stroke at a time; beside each a hidden file keeps the grains that the next stroke needs. What
// is there is taken as it is and no agent is asked for it again. A stroke in which grains get lost is
// worth nothing: the agent chooses again, as after a refusal by a gate. `progress` gets the strokes so far,
// kept ones too. A stop, also one in the middle of a stroke, keeps the strokes that were done. Throws Error
// where the folder cannot be continued; `world` must have no gate.
Evaluation EvaluateKept(Agent& agent, const World& world, const EpisodeConfig& config,
                        std::span<const Task> tasks, uint64_t seed, const KeptIn& kept,
                        const std::function<void(int64_t)>& progress = {});

}  // namespace sandwright
