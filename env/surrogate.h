// The learned sand model: what a small net knows, mostly on top of the heightfield's prediction.
#pragma once

#include <filesystem>
#include <optional>

#include "env/heightfield.h"
#include "env/surrogate_net.h"
#include "env/training_range.h"

namespace sandwright {

// Everything that decides a prediction, kept in the model's file.
struct SurrogateConfig {
  double cell_size_m = 0.004;   // the cells it was trained on: it works on no others
  bool conserve_volume = true;  // what the net adds and takes is the same volume; fluxes do anyhow
  double reach_m = 0;           // of the net beyond the path; 0: the whole window
  int64_t heightfield_cells = 1;  // side of the heightfield's cells, in cells of the map
  double steepest_over_repose = 0;  // slopes that are left in the window; 0: any
  int64_t threads = 1;              // for a batch of strokes
  SurrogateNetConfig net;
  HeightfieldConfig heightfield;  // what the net was trained on top of, its blade included

  void Fields(FieldList& f) {
    f.Add("cell_size_m", cell_size_m, "cells of the maps [m]", 0.001, 0.05);
    f.Add("conserve_volume", conserve_volume,
          "what the net adds and takes is the same volume; fluxes conserve it anyhow");
    f.Add("reach_m", reach_m, "how far from the path the net corrects; 0: the whole window [m]", 0,
          1);
    f.Add("heightfield_cells", heightfield_cells,
          "side of the cells that the heightfield inside works on [cells of the maps]", 1, 8);
    f.Add("steepest_over_repose", steepest_over_repose,
          "what lies steeper in the window at the end flows until it does not, over the slope of "
          "repose; 0: never",
          0, 100);
    f.Add("threads", threads, "threads for a batch of strokes", 1, 1024);
    f.Section("net", net);
    f.Section("heightfield", heightfield);
  }
};

// The heightfield is applied to the whole map; what the net says changes the cells of StrokeWindow
// that the stroke reaches (surrogate_paste.h keeps the floor and the volume). So beyond them the
// surrogate is the heightfield; the architecture `direct` changes nothing there.
class Surrogate final : public SandModel {
 public:
  // The heightfield that is inside and the net; `source` names where they came from in messages.
  Surrogate(const SurrogateConfig& config, const Safetensors& parameters,
            const std::string& source);

  std::string name() const override { return "surrogate"; }
  const Blade& blade() const override { return config_.heightfield.blade; }
  std::optional<double> cell_size_m() const override { return config_.cell_size_m; }
  const SurrogateConfig& config() const { return config_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override;

 private:
  void Correct(const HeightMap& before, const ToolPath& path, SandState& state,
               Outcome& outcome) const;

  SurrogateConfig config_;
  Heightfield heightfield_;
  SurrogateNet net_;
  std::optional<TrainingRange> range_;  // of the strokes it was trained on; older files have none
};

// The metadata of a file that `fit` wrote: "schema" = "sandwright-surrogate" and "config" (the
// resolved SurrogateConfig as JSON). Error naming `source` and what is wrong.
SurrogateConfig SurrogateConfigOf(const Safetensors& content, const std::string& source);

// The whole file, the net's tensors with it. Error naming the file and what is wrong.
Surrogate ReadSurrogate(const std::filesystem::path& file, int64_t threads);
// The same from the content of the file `source`.
Surrogate ReadSurrogate(const Safetensors& content, const std::string& source, int64_t threads);

}  // namespace sandwright
