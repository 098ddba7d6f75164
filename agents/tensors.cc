#include "agents/tensors.h"

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {

ObservationTensors ToTensors(const ObservationBatch& batch, const ObservationSpec& spec,
                             torch::Device device) {
  const auto channels = static_cast<int64_t>(spec.channels.size());
  const int64_t rows = spec.map_size() > 0
                           ? static_cast<int64_t>(batch.map.size()) / spec.map_size()
                           : static_cast<int64_t>(batch.vec.size()) / spec.vec_size();
  auto view = [](const std::vector<float>& values, std::vector<int64_t> shape) {
    return torch::from_blob(const_cast<float*>(values.data()), shape, torch::kFloat32);
  };
  return {view(batch.map, {rows, channels, spec.rows, spec.columns}).to(device, false, true),
          view(batch.vec, {rows, spec.vec_size()}).to(device, false, true)};
}

std::vector<Action> ActionsOf(const torch::Tensor& action) {
  const auto rows = action.contiguous();
  SAND_CHECK(rows.size(1) == kActionSize, rows.size(1));
  std::vector<Action> actions(static_cast<size_t>(rows.size(0)));
  for (size_t i = 0; i < actions.size(); ++i)
    std::copy_n(rows.data_ptr<float>() + i * kActionSize, kActionSize, actions[i].begin());
  return actions;
}

std::vector<float> ValuesOf(std::span<const Action> actions) {
  std::vector<float> values;
  for (const Action& action : actions) values.insert(values.end(), action.begin(), action.end());
  return values;
}

torch::Device SelectDevice(const std::string& name) {
  if (name == "cpu") return torch::kCPU;
  if (torch::cuda::is_available()) return torch::kCUDA;
  if (name == "cuda") throw Error("device = cuda: no CUDA device works here; allowed: auto, cpu");
  return torch::kCPU;
}

}  // namespace sandwright
