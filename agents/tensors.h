// Observations and strokes as tensors, and the device that computes with them.
#pragma once

#include <torch/torch.h>

#include <span>
#include <string>
#include <vector>

#include "env/action.h"
#include "env/vec_env.h"

namespace sandwright {

// [B, C, H, W] and [B, V], float, on the network's device.
struct ObservationTensors {
  torch::Tensor map, vec;
};
ObservationTensors ToTensors(const ObservationBatch& batch, const ObservationSpec& spec,
                             torch::Device device);

// Strokes [N, 7] on the CPU.
std::vector<Action> ActionsOf(const torch::Tensor& action);
// The numbers of all of them in a row, as VecEnv::Step takes them.
std::vector<float> ValuesOf(std::span<const Action> actions);

// auto: cuda where it works, else cpu. Error where cuda is asked for and is not there.
torch::Device SelectDevice(const std::string& name);

}  // namespace sandwright
