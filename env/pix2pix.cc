#include "env/pix2pix.h"

#include <ATen/Parallel.h>

#include <algorithm>

#include "data/base/parallel.h"
#include "env/blade_path.h"
#include "env/model_config.h"
#include "env/pix2pix_net.h"

namespace sandwright {
namespace {

// One torch thread while it lives, on this thread.
class OneTorchThread {
 public:
  OneTorchThread() { at::set_num_threads(1); }
  ~OneTorchThread() { at::set_num_threads(before_); }
  OneTorchThread(const OneTorchThread&) = delete;
  OneTorchThread& operator=(const OneTorchThread&) = delete;

 private:
  int before_ = at::get_num_threads();
};

}  // namespace

Pix2Pix::Pix2Pix(const Pix2PixConfig& config, std::unique_ptr<const Pix2PixGenerator> generator,
                 int64_t threads)
    : config_(config), generator_(std::move(generator)), threads_(threads) {}

Pix2Pix::~Pix2Pix() = default;

std::vector<Outcome> Pix2Pix::ApplyChecked(std::span<SandState> states,
                                           std::span<const ToolPath> paths) const {
  std::vector<Outcome> outcomes(states.size());
  ParallelFor(static_cast<int>(states.size()), static_cast<int>(threads_), [&](int index) {
    const auto i = static_cast<size_t>(index);
    outcomes[i] = Predict(paths[i], states[i]);
  });
  return outcomes;
}

Outcome Pix2Pix::Predict(const ToolPath& path, SandState& state) const {
  const HeightMap& before = state.map();
  const LimitedPath limited = LimitPath(path, config_.blade, before);
  Outcome outcome;
  outcome.left_box = limited.left_box;
  outcome.below_floor = limited.below_floor;
  const std::optional<PaperInput> input = EncodePaperInput(before, limited.path, config_.blade);
  if (!input || std::ranges::all_of(input->depth, [](uint8_t level) { return level == 0; }))
    return outcome;

  const OneTorchThread one_thread;
  const c10::InferenceMode inference;
  const PaperPlane predicted = PaperPlaneOf(generator_->Forward(PaperTensor(*input)));
  HeightMap after = before;
  outcome.changed = PastePaperChange(*input, predicted, after);
  outcome.moved_volume_m3 = MovedVolume(before, after, outcome.changed);
  state.Replace(std::move(after));
  return outcome;
}

std::unique_ptr<Pix2Pix> ReadPix2Pix(const Safetensors& content, const std::string& source,
                                     int64_t threads) {
  if (content.Metadata("schema", source) != "sandwright-pix2pix")
    throw Error(source + ": not a pix2pix model (metadata schema is \"" +
                content.Metadata("schema", source) + "\"; expected sandwright-pix2pix)");
  Pix2PixConfig config;
  LoadModelConfig(content, source, FieldsOf(config));
  return std::make_unique<Pix2Pix>(
      config, std::make_unique<Pix2PixGenerator>(config.channels, content, source), threads);
}

}  // namespace sandwright
