#include "env/fit_surrogate.h"

#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <numeric>
#include <sstream>

#include "data/base/progress.h"
#include "data/base/random.h"
#include "data/base/stop.h"
#include "env/fit_samples.h"

namespace sandwright {
namespace {

constexpr double kResidualScale_mm = kResidualScale_m * 1e3;

// The net of surrogate_net.h with gradients.
class TrainingNet {
 public:
  // He's initialisation; the head starts at zero, so that training starts from the heightfield.
  TrainingNet(const SurrogateNetConfig& config, RandomStream stream)
      : poolings_(static_cast<int>(config.poolings)),
        patch_(config.patch_cells),
        shapes_(SurrogateLayers(config)) {
    for (const ConvShape& shape : shapes_) {
      auto weight = torch::zeros({shape.out, shape.in, shape.size, shape.size});
      const double deviation =
          shape.name == "head" ? 0 : std::sqrt(2.0 / (shape.in * shape.size * shape.size));
      float* values = weight.data_ptr<float>();
      for (int64_t i = 0; i < weight.numel(); ++i)
        values[i] = static_cast<float>(deviation * stream.Normal());
      parameters_.push_back(weight.set_requires_grad(true));
      parameters_.push_back(torch::zeros({shape.out}).set_requires_grad(true));
    }
  }

  const std::vector<torch::Tensor>& parameters() const { return parameters_; }

  // channels [N, C, H, W], active [N, 1, H, W] of zeros and ones -> [N, H, W]
  torch::Tensor Forward(const torch::Tensor& channels, const torch::Tensor& active) const {
    size_t next = 0;
    const auto convolve = [&](const torch::Tensor& x) {
      const size_t at = 2 * next++;
      return torch::conv2d(x, parameters_[at], parameters_[at + 1], 1,
                           (shapes_[at / 2].size - 1) / 2);
    };
    const auto block = [&](torch::Tensor x, const torch::Tensor& mask) {
      x = torch::relu(convolve(x)) * mask;
      return torch::relu(convolve(x)) * mask;
    };
    std::vector<torch::Tensor> skips, masks{torch::max_pool2d(active, patch_)};
    torch::Tensor x = torch::pixel_unshuffle(channels, patch_) * masks[0];
    for (int level = 0; level < poolings_; ++level) {
      skips.push_back(block(x, masks.back()));
      masks.push_back(torch::max_pool2d(masks.back(), 2));
      x = torch::avg_pool2d(skips.back(), 2);
    }
    x = block(x, masks.back());
    for (int level = poolings_ - 1; level >= 0; --level) {
      x = x.repeat_interleave(2, 2).repeat_interleave(2, 3);
      const torch::Tensor& mask = masks[static_cast<size_t>(level)];
      x = block(torch::cat({skips[static_cast<size_t>(level)], x * mask}, 1), mask);
    }
    return (torch::pixel_shuffle(convolve(x), patch_) * active).squeeze(1);
  }

  void Save(Safetensors& file) const {
    const auto store = [&](const std::string& name, const torch::Tensor& tensor) {
      const torch::Tensor flat = tensor.detach().contiguous();
      file.tensors[name] = {flat.sizes().vec(),
                            {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()}};
    };
    for (size_t i = 0; i < shapes_.size(); ++i) {
      store(shapes_[i].name + ".weight", parameters_[2 * i]);
      store(shapes_[i].name + ".bias", parameters_[2 * i + 1]);
    }
  }

  // Error where a tensor is missing or has another shape.
  void Load(const Safetensors& file, const std::string& source) {
    const torch::NoGradGuard no_grad;
    for (size_t i = 0; i < parameters_.size(); ++i) {
      const std::string name = shapes_[i / 2].name + (i % 2 == 0 ? ".weight" : ".bias");
      const NamedTensor& tensor = file.Tensor(name, source);
      if (tensor.shape != parameters_[i].sizes().vec())
        throw Error(source + ": tensor " + name + " has another shape than the configured net");
      std::ranges::copy(tensor.values, parameters_[i].data_ptr<float>());
    }
  }

 private:
  int poolings_;
  int64_t patch_;
  std::vector<ConvShape> shapes_;
  std::vector<torch::Tensor> parameters_;  // weight, bias of each layer
};

struct Batch {
  torch::Tensor channels, active;  // [N, C, H, W], [N, 1, H, W]
  torch::Tensor target, weight;    // [N, H, W]
};

// Samples side by side, padded with zeros to the largest.
Batch Collate(const std::vector<FitSample>& samples) {
  int rows = 0, columns = 0;
  for (const FitSample& s : samples)
    rows = std::max(rows, s.input.rows), columns = std::max(columns, s.input.columns);
  const auto count = static_cast<int64_t>(samples.size());
  Batch batch{torch::zeros({count, kSurrogateChannelCount, rows, columns}),
              torch::zeros({count, 1, rows, columns}), torch::zeros({count, rows, columns}),
              torch::zeros({count, rows, columns})};
  const auto place = [](const std::vector<float>& values, torch::Tensor to, const FitSample& s) {
    const auto from =
        torch::from_blob(const_cast<float*>(values.data()),
                         {static_cast<int64_t>(values.size()) / (s.input.rows * s.input.columns),
                          s.input.rows, s.input.columns});
    to.view({-1, to.size(-2), to.size(-1)})
        .narrow(1, 0, s.input.rows)
        .narrow(2, 0, s.input.columns)
        .copy_(from);
  };
  for (size_t i = 0; i < samples.size(); ++i) {
    const auto n = static_cast<int64_t>(i);
    const std::vector<float> active(samples[i].input.active.begin(), samples[i].input.active.end());
    place(samples[i].input.channels, batch.channels[n], samples[i]);
    place(active, batch.active[n], samples[i]);
    place(samples[i].target, batch.target[n], samples[i]);
    place(samples[i].weight, batch.weight[n], samples[i]);
  }
  return batch;
}

// Squared errors in net units and the cells they were taken over.
struct ErrorSum {
  double squared = 0, cells = 0;
  double rmse_mm() const { return std::sqrt(squared / cells) * kResidualScale_mm; }
};

ErrorSum Evaluate(const TrainingNet& net, const std::vector<FitSample>& samples) {
  const torch::NoGradGuard no_grad;
  ErrorSum sum;
  for (const FitSample& sample : samples) {
    const Batch batch = Collate({sample});
    const auto error = (net.Forward(batch.channels, batch.active) - batch.target) * batch.weight;
    sum.squared += error.square().sum().item<double>();
    sum.cells += batch.weight.sum().item<double>();
  }
  return sum;
}

// The error of adding nothing to the heightfield.
ErrorSum HeightfieldError(const std::vector<FitSample>& samples) {
  ErrorSum sum;
  for (const FitSample& sample : samples) {
    for (size_t i = 0; i < sample.target.size(); ++i) {
      sum.squared += static_cast<double>(sample.target[i]) * sample.target[i] * sample.weight[i];
      sum.cells += sample.weight[i];
    }
  }
  return sum;
}

class Trainer {
 public:
  Trainer(const FitConfig& config, const FitRequest& request, std::vector<FitSample> samples)
      : config_(config),
        samples_(std::move(samples)),
        stream_(request.seed, StreamId("fit.order")),
        net_(config.surrogate.net, RandomStream(request.seed, StreamId("fit.parameters"))),
        optimiser_(
            net_.parameters(),
            torch::optim::AdamWOptions(config.learning_rate).weight_decay(config.weight_decay)) {}

  TrainingNet& net() { return net_; }

  // One pass over all samples; false when a stop was requested in the middle.
  bool RunEpoch(int epoch, ErrorSum& error) {
    std::vector<size_t> order(samples_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[stream_.Index(i)]);
    const size_t size = static_cast<size_t>(config_.batch_size);
    const size_t batches = (order.size() + size - 1) / size;
    for (size_t b = 0; b < batches; ++b) {
      if (StopRequested()) return false;
      const double done = (epoch - 1 + static_cast<double>(b) / static_cast<double>(batches)) /
                          static_cast<double>(config_.epochs);
      static_cast<torch::optim::AdamWOptions&>(optimiser_.param_groups()[0].options())
          .lr(config_.learning_rate * 0.5 * (1 + std::cos(std::numbers::pi * done)));
      std::vector<FitSample> chosen;
      for (size_t i = b * size; i < std::min(order.size(), (b + 1) * size); ++i)
        chosen.push_back(ApplySymmetry(samples_[order[i]], static_cast<int>(stream_.Index(8))));
      Step(epoch, b, chosen, error);
    }
    return true;
  }

 private:
  void Step(int epoch, size_t index, const std::vector<FitSample>& chosen, ErrorSum& error) {
    const Batch batch = Collate(chosen);
    optimiser_.zero_grad();
    const auto prediction = net_.Forward(batch.channels, batch.active) * batch.weight;
    const auto cells = batch.weight.sum();
    const double delta = config_.huber_mm / kResidualScale_mm;
    const auto loss =
        torch::huber_loss(prediction, batch.target, at::Reduction::Sum, delta) / cells;
    if (!std::isfinite(loss.item<double>())) {
      std::string message = "fit: the loss is not finite in epoch " + std::to_string(epoch) +
                            ", batch " + std::to_string(index + 1) + ":";
      for (const FitSample& s : chosen) message += "\n  " + s.name;
      throw Error(message);
    }
    loss.backward();
    torch::nn::utils::clip_grad_norm_(net_.parameters(), 1.0);
    optimiser_.step();
    error.squared += (prediction - batch.target).detach().square().sum().item<double>();
    error.cells += cells.item<double>();
  }

  const FitConfig& config_;
  std::vector<FitSample> samples_;
  RandomStream stream_;
  TrainingNet net_;
  torch::optim::AdamW optimiser_;
};

// "1.23 mm". (torch brings an fmt of its own that must not meet the system's in one file.)
std::string Millimetres(double value_mm) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << value_mm << " mm";
  return text.str();
}

void CheckBeds(const FitSamples& data, const FitSamples& validation) {
  for (const std::string& bed : validation.beds) {
    if (data.beds.contains(bed))
      throw Error("bed '" + bed +
                  "' is in both --data and --validation; split by bed, never by stroke");
  }
}

std::map<std::string, std::string> Metadata(const FitConfig& config, const FitRequest& request,
                                            const FitSamples& data, const FitSamples& validation) {
  SurrogateConfig model = config.surrogate;
  FitConfig fit = config;
  const auto identity = [](const FitSamples& part) {
    return nlohmann::json{{"beds", part.beds}, {"files_sha256", part.sha256}};
  };
  const nlohmann::json split = {{"training", identity(data)}, {"validation", identity(validation)}};
  return {{"schema", "sandwright-surrogate"},
          {"config", ToJson(FieldsOf(model)).dump()},
          {"fit", ToJson(FieldsOf(fit)).dump()},
          {"channels", nlohmann::json(kSurrogateChannels).dump()},
          {"data", split.dump()},
          {"seed", std::to_string(request.seed)}};
}

}  // namespace

FitReport FitSurrogate(const FitConfig& config, const FitRequest& request) {
  const FitSamples validation =
      ReadFitSamples(request.validation, config.surrogate, request.threads);
  FitSamples data = ReadFitSamples(request.data, config.surrogate, request.threads);
  CheckBeds(data, validation);
  torch::set_num_threads(request.threads);

  FitReport report;
  report.strokes = static_cast<int>(data.samples.size());
  report.validation_strokes = static_cast<int>(validation.samples.size());
  report.model.metadata = Metadata(config, request, data, validation);
  Trainer trainer(config, request, std::move(data.samples));
  if (request.init) trainer.net().Load(ReadSafetensors(*request.init), request.init->string());
  if (!validation.samples.empty())
    report.validation_heightfield_rmse_mm = HeightfieldError(validation.samples).rmse_mm();

  Progress progress("fit", config.epochs, "epochs");
  for (int epoch = 1; epoch <= config.epochs; ++epoch) {
    ErrorSum error;
    report.stopped = !trainer.RunEpoch(epoch, error);
    if (report.stopped) break;
    report.epochs = epoch;
    report.train_rmse_mm = error.rmse_mm();
    std::string note = "training " + Millimetres(report.train_rmse_mm);
    if (validation.samples.empty()) {
      report.best_epoch = epoch;
      trainer.net().Save(report.model);
    } else {
      const double rmse_mm = Evaluate(trainer.net(), validation.samples).rmse_mm();
      if (!report.validation_rmse_mm || rmse_mm < *report.validation_rmse_mm) {
        report.validation_rmse_mm = rmse_mm;
        report.best_epoch = epoch;
        trainer.net().Save(report.model);
      }
      note += ", validation " + Millimetres(rmse_mm) + ", best " +
              Millimetres(*report.validation_rmse_mm) + ", heightfield " +
              Millimetres(*report.validation_heightfield_rmse_mm);
    }
    progress.Update(epoch, note);
    if (epoch - report.best_epoch >= config.patience) break;
  }
  report.seconds = progress.elapsed_s();
  if (report.epochs == 0) ThrowIfStopRequested();
  return report;
}

nlohmann::json FitReport::ToJson() const {
  const auto number = [](const std::optional<double>& v) {
    return v ? nlohmann::json(*v) : nlohmann::json();
  };
  return {{"strokes", strokes},
          {"validation_strokes", validation_strokes},
          {"epochs", epochs},
          {"best_epoch", best_epoch},
          {"train_rmse_mm", train_rmse_mm},
          {"validation_rmse_mm", number(validation_rmse_mm)},
          {"validation_heightfield_rmse_mm", number(validation_heightfield_rmse_mm)},
          {"seconds", seconds},
          {"stopped", stopped}};
}

}  // namespace sandwright
