// Trains the surrogate's net on recorded strokes, with torch.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "data/base/run_status.h"
#include "env/generated_strokes.h"
#include "env/surrogate.h"

namespace sandwright {

struct FitConfig {
  int64_t epochs = 100;
  int64_t batch_size = 2;
  double learning_rate = 1e-3;  // of AdamW at the start; falls to zero along a cosine
  double weight_decay = 1e-3;
  double huber_mm = 2.0;     // errors beyond it count linearly
  double average_steps = 1;  // of the running mean of the weights that is kept; 1: the last ones
  int64_t patience = 40;     // epochs without a better validation error before the end
  double turn_deg = 0;       // each sample is turned by up to this, both ways
  double shift_cells = 0;    // and shifted by up to this, along both axes
  int64_t pushforward_steps = 1;
  GeneratedStrokes generate;  // trained on where there are no recorded strokes
  SurrogateConfig surrogate;  // the model that is trained

  void Fields(FieldList& f) {
    f.Add("epochs", epochs, "passes over the training strokes, each time placed anew", 1, 100000);
    f.Add("batch_size", batch_size, "strokes in one gradient step", 1, 1024);
    f.Add("learning_rate", learning_rate, "of AdamW at the start; falls to zero along a cosine",
          1e-7, 1);
    f.Add("weight_decay", weight_decay, "of AdamW", 0, 1);
    f.Add("huber_mm", huber_mm, "errors beyond it count linearly [mm]", 0.01, 1000);
    f.Add("average_steps", average_steps,
          "the weights that are kept are a running mean over about so many steps; 1: the last ones",
          1, 1e6);
    f.Add("patience", patience, "epochs without a better validation error before the end", 1,
          100000);
    f.Add("turn_deg", turn_deg, "each sample is turned by up to this, both ways [deg]", 0, 180);
    f.Add("shift_cells", shift_cells, "and shifted by up to this along both axes [cells]", 0, 100);
    f.Add("pushforward_steps", pushforward_steps,
          "a sample starts up to this many strokes back, less one, from the model's own prediction",
          1, 100);
    f.Section("generate", generate);
    f.Section("surrogate", surrogate);
  }
};

struct FitRequest {
  // Stroke files. Without data each pass trains on new strokes of config.generate.
  std::vector<std::filesystem::path> data, validation;
  std::optional<std::filesystem::path> init = {};  // start from this surrogate's net, of the same shape
  uint64_t seed = 0;
  int threads = 1;  // of torch; the same seed gives the same bytes for the same count
  // Where the fit is kept while it runs, so that an interrupted one can go on bit for bit.
  std::optional<std::filesystem::path> state = {};
  bool resume = false;     // goes on from `state`
  std::optional<std::filesystem::path> log = {};  // folder of TensorBoard events, one a pass
  RunStatus* status = nullptr;  // told how it goes; none: nobody watches
  int64_t epochs_now = 0;  // stops after so many as if by Ctrl-C; 0: goes on to the end
};

// A fitted surrogate: its file and how it went.
struct FitReport {
  Safetensors model;  // what ReadSurrogate takes
  int strokes = 0, validation_strokes = 0;
  int epochs = 0, best_epoch = 0;  // done; the one that was kept (counted from 1)
  double train_rmse_mm = 0;        // of the last epoch, over the strokes' windows
  // Of the kept one; of the net that says nothing (the heightfield, for `direct` no change).
  std::optional<double> validation_rmse_mm, validation_start_rmse_mm;
  double seconds = 0;    // of this call
  bool stopped = false;  // by Ctrl-C: the best until then
  nlohmann::json ToJson() const;
};

// The target is what the heightfield gets wrong (architecture `direct`: the whole change) on the
// windows of StrokeWindow. Each pass shows every stroke once: turned and shifted at random, then
// under one of the eight symmetries of the square. With pushforward_steps = k the terrain before it
// is, at random, the recorded one or what the net as it stands makes of the one 1..k-1 strokes
// earlier; no gradient runs through that (Brandstetter, Worrall, Welling, "Message passing neural
// PDE solvers", ICLR 2022, the pushforward trick). With validation strokes the epoch with the least
// squared error on them is kept, else the last. What is kept is an exponential mean of the weights
// over about average_steps steps.
//
// Error: a bed that is in both sets, a blade or shape that does not fit, cells that do not divide
// the maps, a loss that is not finite (the batch is named), a state of another fit. Ctrl-C before
// the first epoch has ended throws kInterrupted.
FitReport FitSurrogate(const FitConfig& config, const FitRequest& request);

}  // namespace sandwright
