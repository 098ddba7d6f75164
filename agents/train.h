// The training loop: environments, PPO, checkpoints, evaluation, logs, in one run folder.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "agents/network_config.h"
#include "agents/ppo_config.h"
#include "env/load_sand_model.h"
#include "env/shaping_env.h"

namespace sandwright {

struct TrainConfig {
  int64_t total_steps = 60000;
  std::string device = "auto";
  int64_t torch_threads = 1;
  std::string model = "heightfield";
  std::string workcell;
  std::string tasks_file;
  int64_t evaluate_every = 10240;
  int64_t evaluation_tasks = 20;
  int64_t checkpoint_every = 10240;
  SandModelConfig sand;
  TaskConfig task;
  ShapingConfig env;
  NetworkConfig network;
  PpoConfig ppo;

  void Fields(FieldList& f) {
    f.Add("total_steps", total_steps, "strokes to train on", 1, 1e12);
    f.Add("device", device, "where the network computes; cuda falls back to cpu with auto only",
          {"auto", "cpu", "cuda"});
    f.Add("torch_threads", torch_threads,
          "threads of the network; results depend on it in the last bits", 1, 256);
    f.Add("model", model,
          "sand model that is the world: heightfield, dem, none, default, fast or a .safetensors "
          "file");
    f.Add("workcell", workcell,
          "workcell whose gate refuses strokes: a file, or a name in configs/; empty: no arm");
    f.Add("tasks.file", tasks_file,
          "task file to draw training tasks from; empty: generate by `task`");
    f.Add("evaluate_every", evaluate_every, "strokes between evaluations; 0: never", 0, 1e12);
    f.Add("evaluation_tasks", evaluation_tasks,
          "generated tasks of an evaluation, unseen in training", 1, 10000);
    f.Add("checkpoint_every", checkpoint_every, "strokes between checkpoints; 0: at the end only",
          0, 1e12);
    sand.Fields(f);
    f.Section("task", task);
    f.Section("env", env);
    f.Section("network", network);
    f.Section("ppo", ppo);
  }
};

// What a run was told beside its configuration.
struct TrainRun {
  std::filesystem::path folder;
  uint64_t seed = 0;
  int threads = 1;      // of the environments; results do not depend on it
  bool resume = false;  // continue from the folder's last checkpoint; `seed` is taken from there
};

// Leaves in the folder: config.yaml, checkpoints/, best.safetensors (the least error in
// evaluations), agent.safetensors (the end), progress.csv, TensorBoard events. Ctrl-C: writes a
// checkpoint, then throws Error (kInterrupted). A resumed run repeats an uninterrupted one bit for
// bit where it was resumed at a regular checkpoint. Returns what `train --json` shows.
nlohmann::json Train(TrainConfig config, TrainRun run);

// The last checkpoint of a run folder; Error where there is none.
std::filesystem::path LastCheckpoint(const std::filesystem::path& folder);

}  // namespace sandwright
