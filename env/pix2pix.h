// The sand model of Deep Sandscapes: pix2pix on the paper's picture of a stroke, the baseline of
// every other learned model.
#pragma once

#include <memory>

#include "env/safetensors.h"
#include "env/sand_model.h"

namespace sandwright {

class Pix2PixGenerator;

// Everything that decides a prediction, kept in the model's file.
struct Pix2PixConfig {
  int64_t channels = 64;
  Blade blade;

  void Fields(FieldList& f) {
    f.Add("channels", channels, "of the generator's and the discriminator's first level", 1, 256);
    f.Section("blade", blade);
  }
};

// Works on cells of any size. Changes the cells of the paper's crop alone, by what the predicted
// picture differs from the one before (env/paper_encoding.h); nothing where the picture shows no
// cut. Volume is not kept. A stroke whose crop lies outside the box changes nothing.
class Pix2Pix final : public SandModel {
 public:
  Pix2Pix(const Pix2PixConfig& config, std::unique_ptr<const Pix2PixGenerator> generator,
          int64_t threads);
  ~Pix2Pix() override;

  std::string name() const override { return "pix2pix"; }
  const Blade& blade() const override { return config_.blade; }
  const Pix2PixConfig& config() const { return config_; }

 protected:
  // One stroke on one thread, so that a result depends neither on the batch nor on the threads.
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override;

 private:
  Outcome Predict(const ToolPath& path, SandState& state) const;

  Pix2PixConfig config_;
  std::unique_ptr<const Pix2PixGenerator> generator_;
  int64_t threads_;
};

// The content of a file `source` that `fit` wrote: metadata "schema" = "sandwright-pix2pix" and
// "config" (the resolved Pix2PixConfig as JSON), and the generator's tensors. Error naming the file
// and what is wrong.
std::unique_ptr<Pix2Pix> ReadPix2Pix(const Safetensors& content, const std::string& source,
                                     int64_t threads);

}  // namespace sandwright
