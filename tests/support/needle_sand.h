// A sand model that is wrong on purpose, for tests of what looks for such.
#pragma once

#include "env/sand_model.h"

namespace sandwright {

// Puts a needle of `height_m` onto the first cell, out of nothing.
class NeedleSand final : public SandModel {
 public:
  explicit NeedleSand(float height_m) : height_m_(height_m) {}
  std::string name() const override { return "needle"; }
  const Blade& blade() const override { return blade_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath>) const override {
    for (SandState& state : states) {
      HeightMap map = state.map();
      map.At(0, 0) += height_m_;
      state.Replace(std::move(map));
    }
    return std::vector<Outcome>(states.size());
  }

 private:
  Blade blade_;
  float height_m_;
};

}  // namespace sandwright
