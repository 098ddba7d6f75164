// The keys of every planner, one section each: the same for all subcommands that load agents.
#pragma once

#include "agents/boustrophedon.h"
#include "agents/cem.h"
#include "agents/ga.h"
#include "agents/greedy.h"
#include "agents/ranked_config.h"
#include "agents/sweep.h"

namespace sandwright {

struct PlannerConfigs {
  GreedyConfig greedy = {};
  BoustrophedonConfig boustrophedon = {};
  SweepConfig sweep = {};
  CemConfig cem = {};
  GaConfig ga = {};
  RankedConfig ranked = {};

  PlannerConfigs() = default;

  void Fields(FieldList& f) {
    f.Section("greedy", greedy);
    f.Section("boustrophedon", boustrophedon);
    f.Section("sweep", sweep);
    f.Section("cem", cem);
    f.Section("ga", ga);
    f.Section("ranked", ranked);
  }
};

}  // namespace sandwright
