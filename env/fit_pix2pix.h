// Trains the pix2pix baseline on recorded strokes, with torch.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "data/base/run_status.h"
#include "env/heightfield_strokes.h"
#include "env/pix2pix.h"

namespace sandwright {

struct FitPix2PixConfig {
  int64_t steps = 2000;
  int64_t pretrain_steps = 1000;
  double learning_rate = 2e-4;
  double beta1 = 0.5;
  double l1_weight = 100;
  double gan_weight = 1;
  bool mirror = true;
  int64_t validate_every = 100;
  double pretrain_cell_m = 0.004;
  Pix2PixConfig model;                // what is trained
  HeightfieldStrokesConfig pretrain;  // with the model's blade

  void Fields(FieldList& f) {
    f.Add("steps", steps, "gradient steps on recorded strokes, one stroke each", 1, 1e8);
    f.Add("pretrain_steps", pretrain_steps,
          "gradient steps before them on heightfield strokes made on the fly", 0, 1e8);
    f.Add("learning_rate", learning_rate,
          "of Adam; falls linearly to zero in the second half of all steps", 1e-7, 1);
    f.Add("beta1", beta1, "of Adam: decay of the mean gradient", 0, 0.999);
    f.Add("l1_weight", l1_weight, "of the mean absolute error in the generator's loss", 0, 1e6);
    f.Add("gan_weight", gan_weight,
          "of the discriminator's judgement in it; 0: none is trained (L1 alone)", 0, 1e6);
    f.Add("mirror", mirror, "each picture is mirrored left to right at random");
    f.Add("validate_every", validate_every, "steps between two validations", 1, 1e8);
    f.Add("pretrain_cell_m", pretrain_cell_m, "cells of the heightfield strokes [m]", 0.001, 0.05);
    f.Section("model", model);
    f.Section("pretrain", pretrain);
  }
};

struct FitPix2PixRequest {
  std::vector<std::filesystem::path> data, validation;  // stroke files; validation may be empty
  std::optional<std::filesystem::path>
      init;  // start from this model's generator, of the same shape
  uint64_t seed = 0;
  int threads = 1;  // of torch; the same seed gives the same bytes for the same count
  RunStatus* status = nullptr;  // told how it goes; none: nobody watches
};

// A fitted pix2pix: its file and how it went.
struct FitPix2PixReport {
  Safetensors model;  // what ReadPix2Pix takes
  int strokes = 0, validation_strokes = 0;
  int64_t steps = 0, best_step = 0;  // done, pretraining included; the one that was kept
  // Over the pixels of the crops that count: of the kept one, and of "nothing changes".
  std::optional<double> validation_rmse_mm, validation_start_rmse_mm;
  double seconds = 0;
  bool stopped = false;  // by Ctrl-C: the best until then
  nlohmann::json ToJson() const;
};

// Isola et al. 2017 (pix2pix_net.h): conditional GAN and L1, Adam, one picture a step, and the
// authors' fall of the learning rate. Pixels beyond the walls or not seen by the camera do not
// count in the L1. The mirror is the one symmetry of a picture whose way is down; there is no
// jitter, which would change the size of a millimetre. Validation counts the levels that a user
// gets; with validation strokes the step with the least squared error on them is kept, else the
// last.
//
// Error: a bed that is in both sets, another blade than the model's, a stroke whose picture lies
// outside the box, a loss that is not finite (the stroke is named). Ctrl-C before there is anything
// to keep throws kInterrupted.
FitPix2PixReport FitPix2Pix(const FitPix2PixConfig& config, const FitPix2PixRequest& request);

}  // namespace sandwright
