// The training loop: environments, a learning algorithm, checkpoints, evaluation, logs, in one run
// folder.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "agents/collective.h"
#include "agents/expert_config.h"
#include "agents/group_config.h"
#include "agents/network_config.h"
#include "agents/ppo_config.h"
#include "agents/sac_config.h"
#include "data/base/run_status.h"
#include "env/load_sand_model.h"
#include "env/reference/reference_task.h"
#include "env/shaping_env.h"

namespace sandwright {

struct TrainConfig {
  std::string algorithm = "ppo";
  std::string reference = "none";
  int64_t total_steps = 60000;
  std::string device = "auto";
  int64_t torch_threads = 1;
  std::string model = "heightfield";
  std::string workcell;
  std::string tasks_file;
  std::string initial_policy;
  int64_t evaluate_every = 10240;
  int64_t evaluation_tasks = 20;
  int64_t checkpoint_every = 10240;
  double lost_rank_after_s = 300;
  SandModelConfig sand;
  TaskConfig task;
  ShapingConfig env;
  NetworkConfig network;
  ExpertConfig expert;
  GroupConfig group;
  PpoConfig ppo;
  SacConfig sac;
  TqcConfig tqc;

  bool OnSand() const { return reference == "none"; }

  void Fields(FieldList& f) {
    std::vector<std::string> tasks = ReferenceTaskNames();
    tasks.insert(tasks.begin(), "none");
    f.Add("algorithm", algorithm, "that learns; tqc reads the keys of sac as well",
          {"ppo", "expert_iteration", "group_gradient", "sac", "tqc"});
    f.Add("reference", reference, "task that trainers are compared on, in the place of the sand",
          tasks);
    f.Add("total_steps", total_steps, "strokes (steps of a reference task) to train on", 1, 1e12);
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
    f.Add("initial_policy", initial_policy,
          "policy file of the same network whose weights the training starts from; empty: random");
    f.Add("evaluate_every", evaluate_every, "strokes between evaluations; 0: at the end only", 0, 1e12);
    f.Add("evaluation_tasks", evaluation_tasks,
          "generated tasks (episodes of a reference task) of an evaluation, unseen in training", 1,
          10000);
    f.Add("checkpoint_every", checkpoint_every, "strokes between checkpoints; 0: at the end only",
          0, 1e12);
    f.Add("lost_rank_after_s", lost_rank_after_s,
          "of a run on several machines: how long a rank that does not answer is waited for [s]", 1, 1e6);
    sand.Fields(f);
    f.Section("task", task);
    f.Section("env", env);
    f.Section("network", network);
    f.Section("expert", expert);
    f.Section("group", group);
    f.Section("ppo", ppo);
    f.Section("sac", sac);
    f.Section("tqc", tqc);
  }
};

// What a run was told beside its configuration.
struct TrainRun {
  std::filesystem::path folder;
  uint64_t seed = 0;
  int threads = 1;      // of the environments; results do not depend on it
  bool resume = false;  // continue from the folder's last checkpoint; `seed` is taken from there
  RunStatus* status = nullptr;  // told how it goes; none: nobody watches
  Collective* ranks = &Alone();  // env.num_envs, a multiple of their number, are spread over them
};

// Leaves in the folder: config.yaml, checkpoints/, best.safetensors (the best in
// evaluations), agent.safetensors (the end), progress.csv, TensorBoard events. Ctrl-C: writes a
// checkpoint, then throws Error (kInterrupted). A resumed run repeats an uninterrupted one bit for
// bit where it was resumed at a regular checkpoint, of which there is one before the first step. Returns what `train --json` shows.
//
// On several ranks: the folder is the leader's, and a checkpoint of the last complete update is left
// there where a rank is lost, differs from the others, or stops; then it throws Error, which the
// leader alone logs where all know of it.
nlohmann::json Train(TrainConfig config, TrainRun run);

}  // namespace sandwright
