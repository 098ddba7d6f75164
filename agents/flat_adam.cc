#include "agents/flat_adam.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {
constexpr double kBeta1 = 0.9, kBeta2 = 0.999;
constexpr const char *kFirst = ".first_moment", *kSecond = ".second_moment", *kSteps = ".steps";
}  // namespace

FlatAdam::FlatAdam(const std::vector<torch::Tensor>& parameters, double epsilon)
    : epsilon_(epsilon), parameters_(parameters) {
  SAND_CHECK(!parameters_.empty());
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> flat;
  for (const auto& p : parameters_) flat.push_back(p.detach().reshape({-1}));
  values_ = torch::cat(flat).clone();
  gradient_ = torch::zeros_like(values_);
  first_moment_ = torch::zeros_like(values_);
  second_moment_ = torch::zeros_like(values_);
  int64_t offset = 0;
  for (auto& p : parameters_) {
    p.set_data(values_.narrow(0, offset, p.numel()).view(p.sizes()));
    p.mutable_grad() = gradient_.narrow(0, offset, p.numel()).view(p.sizes());
    offset += p.numel();
  }
}

void FlatAdam::SumGradients(Collective& ranks, std::span<float> riders) {
  if (ranks.size() == 1) return;
  const auto mine = gradient_.to(torch::kCPU);
  const auto count = static_cast<size_t>(mine.numel());
  message_.assign(mine.data_ptr<float>(), mine.data_ptr<float>() + count);
  message_.insert(message_.end(), riders.begin(), riders.end());
  ranks.Sum(message_);
  gradient_.copy_(torch::from_blob(message_.data(), {mine.numel()}));
  std::copy_n(message_.begin() + mine.numel(), riders.size(), riders.begin());
}

double FlatAdam::ClipGradients(double limit) {
  const double norm = gradient_.norm().item<double>();
  if (norm > limit) gradient_.mul_(limit / norm);
  return norm;
}

void FlatAdam::Step(double learning_rate) {
  const torch::NoGradGuard no_grad;
  ++steps_;
  first_moment_.lerp_(gradient_, 1.0 - kBeta1);
  second_moment_.mul_(kBeta2).addcmul_(gradient_, gradient_, 1.0 - kBeta2);
  const double step_size = learning_rate / (1.0 - std::pow(kBeta1, static_cast<double>(steps_)));
  const double correction = std::sqrt(1.0 - std::pow(kBeta2, static_cast<double>(steps_)));
  const auto denominator = second_moment_.sqrt().div_(correction).add_(epsilon_);
  values_.addcdiv_(first_moment_, denominator, -step_size);
}

void FlatAdam::Descend(const torch::Tensor& loss, double learning_rate, double gradient_limit) {
  ZeroGradients();
  loss.backward();
  const double norm = ClipGradients(gradient_limit);
  SAND_CHECK(std::isfinite(norm), "a gradient is NaN", steps_);
  Step(learning_rate);
}

void FlatAdam::Save(const std::string& name, Safetensors& content) const {
  const auto add = [&](const char* kind, const torch::Tensor& moment) {
    const auto cpu = moment.to(torch::kCPU);
    content.tensors[name + kind] = {
        {cpu.numel()}, {cpu.data_ptr<float>(), cpu.data_ptr<float>() + cpu.numel()}};
  };
  add(kFirst, first_moment_);
  add(kSecond, second_moment_);
  content.metadata[name + kSteps] = std::to_string(steps_);
}

void FlatAdam::Load(const std::string& name, const Safetensors& content,
                    const std::string& source) {
  const auto saved = [&](const char* kind) {
    const NamedTensor& moment = content.Tensor(name + kind, source);
    if (static_cast<int64_t>(moment.values.size()) != values_.numel())
      throw Error(source + ": " + name + kind + " belongs to another network");
    return torch::tensor(moment.values);
  };
  const auto first = saved(kFirst), second = saved(kSecond);
  const std::string& steps = content.Metadata(name + kSteps, source);
  const auto [end, failure] =
      std::from_chars(steps.data(), steps.data() + steps.size(), steps_);
  if (failure != std::errc() || end != steps.data() + steps.size())
    throw Error(source + ": " + name + kSteps + " is '" + steps + "'; allowed: a whole number");
  first_moment_.copy_(first);
  second_moment_.copy_(second);
}

}  // namespace sandwright
