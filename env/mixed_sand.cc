#include "env/mixed_sand.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/random.h"

namespace sandwright {

MixedSand::MixedSand(std::vector<std::unique_ptr<SandModel>> models) : models_(std::move(models)) {
  SAND_CHECK(!models_.empty());
  for (const auto& model : models_) {
    if (model->blade().width_m != blade().width_m ||
        model->blade().thickness_m != blade().thickness_m)
      throw Error(fmt::format(
          "sand models of different blades, {} x {} m and {} x {} m; a mixture needs one",
          blade().width_m, blade().thickness_m, model->blade().width_m,
          model->blade().thickness_m));
    if (model->cell_size_m() != cell_size_m())
      throw Error(fmt::format(
          "sand models of different cells, {} m and {} m (0: any); a mixture needs one size",
          cell_size_m().value_or(0), model->cell_size_m().value_or(0)));
  }
}

SandState MixedSand::Start(HeightMap terrain, uint64_t seed) const {
  RandomStream stream(seed, StreamId("sand of a mixture"));
  const auto variant = static_cast<size_t>(stream.Index(models_.size()));
  SandState state = models_[variant]->Start(std::move(terrain), seed);
  state.set_variant(variant);
  return state;
}

std::vector<Outcome> MixedSand::ApplyChecked(std::span<SandState> states,
                                             std::span<const ToolPath> paths) const {
  std::vector<Outcome> outcomes(states.size());
  for (size_t variant = 0; variant < models_.size(); ++variant) {
    std::vector<size_t> rows;
    std::vector<SandState> its_states;
    std::vector<ToolPath> its_paths;
    for (size_t i = 0; i < states.size(); ++i) {
      SAND_CHECK(states[i].variant() < models_.size(), states[i].variant(), models_.size());
      if (states[i].variant() != variant) continue;
      rows.push_back(i);
      its_states.push_back(states[i]);
      its_paths.push_back(paths[i]);
    }
    if (rows.empty()) continue;
    const std::vector<Outcome> its_outcomes = models_[variant]->Apply(its_states, its_paths);
    for (size_t k = 0; k < rows.size(); ++k) {
      states[rows[k]] = std::move(its_states[k]);
      outcomes[rows[k]] = its_outcomes[k];
    }
  }
  return outcomes;
}

MixedSand RandomSand(const HeightfieldConfig& middle, const RandomSandConfig& spread) {
  std::vector<std::unique_ptr<SandModel>> models;
  for (int64_t v = 0; v < spread.variants; ++v) {
    RandomStream stream(static_cast<uint64_t>(spread.seed), StreamId("random sand"), static_cast<uint64_t>(v));
    const auto within = [&](double share) { return 1 + share * stream.Uniform(-1, 1); };
    HeightfieldConfig config = middle;
    const double turn_deg = spread.repose_spread_deg * stream.Uniform(-1, 1);
    config.repose_deg += turn_deg;
    config.loose_deg += turn_deg;
    config.relaxation_m *= within(spread.relaxation_spread);
    config.cut.rupture_ratio *= within(spread.rupture_spread);
    config.cut.bite_m *= within(spread.bite_spread);
    models.push_back(std::make_unique<Heightfield>(config));
  }
  return MixedSand(std::move(models));
}

}  // namespace sandwright
