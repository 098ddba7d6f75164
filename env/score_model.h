// Scores a sand model on stroke files: one report with the keys of the `score` subcommand.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "env/rollout_score.h"
#include "env/sand_model.h"
#include "env/score.h"

namespace sandwright {

struct ScoreConfig {
  double cell_size_m = 0.004;  // errors are taken on cells of this size
  // Cells the model works on; 0: those it is bound to, else those above.
  double model_cell_size_m = 0;
  std::optional<double> floor_mm;  // noise floor; none: from the replicates in the data, else 0
  bool rollout = false;            // accrued error over the sequences too
  bool paper = false;              // the errors of paper_protocol.h too
  // Folder for one picture a stroke, with `paper` also its WritePaperPair (..._paper.png); "": none.
  std::string pictures;

  void Fields(FieldList& f) {
    f.Add("model_cell_size_m", model_cell_size_m,
          "cells that the model works on [m]; 0: those it is bound to, else those of the errors", 0,
          0.1);
  }
};

struct ScoreReport {
  std::string model;
  double cell_size_m = 0, model_cell_size_m = 0;
  double floor_mm = 0;
  std::string floor_source;  // "given", "replicates", "none in the data"
  double ms_per_stroke = 0;  // one stroke at a time, from bed and path to height map
  std::vector<StrokeScore> strokes;
  // Of replicates: see NoiseFloor::max_abs_mm. None in the data: none.
  std::optional<double> floor_max_abs_mm;
  int strokes_failed = 0;             // left out: the model lost grains in them
  bool stopped = false;               // by Ctrl-C, before the last stroke
  std::vector<AccruedError> accrued;  // with rollout: see ScoreModel
  std::optional<double> accrued_growth_exponent;
  // With paper: means over strokes (the mode for the RMSE), on the paper's crop.
  std::optional<double> paper_mae_mm, paper_rmse_mode_mm, paper_mean_max_mm;

  ScoreSummary Total() const { return Summarise(strokes, floor_mm); }
  // Spearman's correlation of the strokes' training_distance with their RMSE; none without distances.
  std::optional<double> RangeErrorCorrelation() const;
  nlohmann::json ToJson() const;
};

// Each stroke starts from its recorded `before`. The model's change, averaged or spread over the
// cells of the errors, is added to the recorded terrain, so that a coarser model is not charged
// for the roughness that it never saw. With rollout, every run of consecutive steps of one sequence
// is also predicted from its first `before` on; after each stroke the error is taken over the union of
// the score windows so far, and pooled over the sequences that reach it.
//
// Error: a file without strokes, a blade other than the model's, cells that do not divide the map,
// a replicate of a group that the file does not hold. After Ctrl-C the report is over the strokes
// so far; it throws kInterrupted where there are none. A stroke in which model `dem` loses grains is
// left out and counted; in a rollout, and where nothing is left, that is an Error.
ScoreReport ScoreModel(const SandModel& model, std::span<const std::filesystem::path> files,
                       const ScoreConfig& config);

}  // namespace sandwright
