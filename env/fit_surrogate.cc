#include "env/fit_surrogate.h"

#include <ATen/Parallel.h>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/base/atomic_file.h"
#include "data/base/json_number.h"
#include "data/base/progress.h"
#include "data/base/random.h"
#include "data/base/sha256.h"
#include "data/base/stop.h"
#include "data/base/tensorboard.h"
#include "env/fit_samples.h"
#include "env/surrogate_paste.h"
#include "env/training_net.h"
#include "env/training_range.h"

namespace sandwright {
namespace {

constexpr double kResidualScale_mm = kResidualScale_m * 1e3;
constexpr double kStateInterval_s = 5;  // between two writes of the state, the first at once

// Squared errors in net units and the cells they were taken over.
struct ErrorSum {
  double squared = 0, cells = 0;
  double rmse_mm() const { return std::sqrt(squared / cells) * kResidualScale_mm; }
};

ErrorSum Evaluate(const TrainingNet& net, const std::vector<FitSample>& samples) {
  const torch::NoGradGuard no_grad;
  ErrorSum sum;
  for (const FitSample& sample : samples) {
    const FitBatch batch(net.config(), {sample});
    const auto error = (net.Forward(batch) - batch.target) * batch.weight;
    sum.squared += error.square().sum().item<double>();
    sum.cells += batch.weight.sum().item<double>();
  }
  return sum;
}

// The error of a net that says nothing.
ErrorSum StartError(const std::vector<FitSample>& samples) {
  ErrorSum sum;
  for (const FitSample& sample : samples) {
    for (size_t i = 0; i < sample.target.size(); ++i) {
      sum.squared += static_cast<double>(sample.target[i]) * sample.target[i] * sample.weight[i];
      sum.cells += sample.weight[i];
    }
  }
  return sum;
}

// As they were recorded.
std::vector<FitSample> RecordedSamples(const FitStrokes& strokes, const SurrogateConfig& model) {
  std::vector<FitSample> samples;
  for (const FitStroke& s : strokes.strokes)
    samples.push_back(MakeFitSample(s.name, Place(s.record.before, {}, model.cell_size_m),
                                    Place(s.record.after, {}, model.cell_size_m), s.record.path,
                                    model));
  return samples;
}

class Trainer {
 public:
  Trainer(const FitConfig& config, uint64_t seed)
      : config_(config),
        seed_(seed),
        net_(config.surrogate.net, RandomStream(seed, StreamId("fit.parameters"))),
        mean_(config.surrogate.net, RandomStream(seed, StreamId("fit.parameters"))),
        optimiser_(
            net_.parameters(),
            torch::optim::AdamWOptions(config.learning_rate).weight_decay(config.weight_decay)) {}

  // The running mean of the weights: what predicts.
  const TrainingNet& mean() const { return mean_; }

  void StartFrom(const Safetensors& model, const std::string& source) {
    net_.Load(model, source);
    mean_.Load(model, source);
  }

  // One pass over all strokes; false when a stop was requested in the middle.
  bool RunEpoch(int epoch, const std::vector<FitStroke>& strokes, ErrorSum& error) {
    RandomStream stream(seed_, StreamId("fit.order"), static_cast<uint64_t>(epoch));
    std::vector<size_t> order(strokes.size());
    std::iota(order.begin(), order.end(), size_t{0});
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[stream.Index(i)]);
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
        chosen.push_back(Draw(strokes, order[i], stream));
      Step(epoch, b, chosen, error);
    }
    return true;
  }

  // Parameters, their mean and the optimiser's moments. Load: after at least one step was saved.
  void Save(Safetensors& state) {
    net_.Save(state);
    mean_.Save(state, "mean.");
    for (size_t i = 0; i < net_.parameters().size(); ++i) {
      const auto& moments = Moments(i);
      state.tensors["adam.mean." + std::to_string(i)] = ToNamed(moments.exp_avg());
      state.tensors["adam.square." + std::to_string(i)] = ToNamed(moments.exp_avg_sq());
      state.metadata["adam_steps"] = std::to_string(moments.step());
    }
  }
  void Load(const Safetensors& state, const std::string& source) {
    net_.Load(state, source);
    mean_.Load(state, source, "mean.");
    for (size_t i = 0; i < net_.parameters().size(); ++i) {
      const torch::Tensor& parameter = net_.parameters()[i];
      const auto take = [&](const std::string& name) {
        const NamedTensor& tensor = state.Tensor(name + std::to_string(i), source);
        if (tensor.shape != parameter.sizes().vec())
          throw Error(source + ": tensor " + name + std::to_string(i) + " has another shape");
        torch::Tensor copy = torch::zeros(parameter.sizes());
        std::ranges::copy(tensor.values, copy.data_ptr<float>());
        return copy;
      };
      auto moments = std::make_unique<torch::optim::AdamWParamState>();
      moments->step(std::stoll(state.Metadata("adam_steps", source)));
      moments->exp_avg(take("adam.mean."));
      moments->exp_avg_sq(take("adam.square."));
      optimiser_.state()[parameter.unsafeGetTensorImpl()] = std::move(moments);
    }
  }

 private:
  const torch::optim::AdamWParamState& Moments(size_t i) {
    return static_cast<const torch::optim::AdamWParamState&>(
        *optimiser_.state().at(net_.parameters()[i].unsafeGetTensorImpl()));
  }

  // Stroke `index`, placed at random; with pushforward on the net's own prediction.
  FitSample Draw(const std::vector<FitStroke>& strokes, size_t index, RandomStream& stream) const {
    const double cell_m = config_.surrogate.cell_size_m;
    const double turn_rad = config_.turn_deg * std::numbers::pi / 180,
                 shift_m = config_.shift_cells * cell_m;
    Placement placement;
    placement.turn_rad = stream.Uniform(-turn_rad, turn_rad);
    placement.shift_x_m = stream.Uniform(-shift_m, shift_m);
    placement.shift_y_m = stream.Uniform(-shift_m, shift_m);
    const auto steps = static_cast<size_t>(config_.pushforward_steps);
    size_t at = index - std::min<size_t>(stream.Index(steps), strokes[index].behind);
    HeightMap before = Place(strokes[at].record.before, placement, cell_m);
    for (; at < index; ++at) before = Predict(MakeSample(strokes[at], before, placement));
    const int symmetry = static_cast<int>(stream.Index(8));
    return ApplySymmetry(MakeSample(strokes[index], before, placement), symmetry);
  }

  FitSample MakeSample(const FitStroke& stroke, const HeightMap& before,
                       const Placement& placement) const {
    const StrokeRecord& record = stroke.record;
    return MakeFitSample(stroke.name, before,
                         Place(record.after, placement, config_.surrogate.cell_size_m),
                         Place(record.path, placement, record.before), config_.surrogate);
  }

  HeightMap Predict(const FitSample& sample) const {
    const torch::NoGradGuard no_grad;
    const torch::Tensor said = net_.Forward(FitBatch(net_.config(), {sample})).contiguous();
    const float* values = said.data_ptr<float>();
    const CellRect& window = sample.input.window;
    std::vector<double> change_m;
    for (int row = 0; row < window.rows(); ++row) {
      for (int column = 0; column < window.columns(); ++column)
        change_m.push_back(kResidualScale_m * values[row * sample.input.columns + column]);
    }
    HeightMap map = sample.start;
    AddResidual(window, std::move(change_m), config_.surrogate.conserve_volume, map);
    return map;
  }

  void Step(int epoch, size_t index, const std::vector<FitSample>& chosen, ErrorSum& error) {
    const FitBatch batch(net_.config(), chosen);
    optimiser_.zero_grad();
    const auto prediction = net_.Forward(batch) * batch.weight;
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
    {
      const torch::NoGradGuard no_grad;
      for (size_t i = 0; i < net_.parameters().size(); ++i)
        torch::Tensor(mean_.parameters()[i]).lerp_(net_.parameters()[i], 1 / config_.average_steps);
    }
    error.squared += (prediction - batch.target).detach().square().sum().item<double>();
    error.cells += cells.item<double>();
  }

  const FitConfig& config_;
  uint64_t seed_;
  TrainingNet net_, mean_;
  torch::optim::AdamW optimiser_;
};

std::map<std::string, std::string> Metadata(const FitConfig& config, const FitRequest& request,
                                            const FitStrokes& data, const FitStrokes& validation) {
  SurrogateConfig model = config.surrogate;
  FitConfig fit = config;
  return {{"schema", "sandwright-surrogate"},
          {"config", ToJson(FieldsOf(model)).dump()},
          {"fit", ToJson(FieldsOf(fit)).dump()},
          {"channels", nlohmann::json(kSurrogateChannels).dump()},
          {"data", SplitIdentity(data, validation, request.init).dump()},
          {"init", request.init ? Sha256Hex(ReadFile(*request.init)) : ""},
          {"seed", std::to_string(request.seed)}};
}

// A fit between two epochs, as it is kept on disk: the metadata of its model, how far it came, the
// trainer's state, and the best net so far under "best.".
constexpr const char* kStateSchema = "sandwright-fit-state";

Safetensors Snapshot(Trainer& trainer, const FitReport& report) {
  Safetensors state;
  state.metadata = report.model.metadata;
  state.metadata["schema"] = kStateSchema;
  state.metadata["progress"] = report.ToJson().dump();
  trainer.Save(state);
  for (const auto& [name, tensor] : report.model.tensors) state.tensors["best." + name] = tensor;
  return state;
}

void Restore(const std::filesystem::path& file, Trainer& trainer, FitReport& report) {
  const std::string source = file.string();
  const Safetensors state = ReadSafetensors(file);
  for (const auto& [key, value] : report.model.metadata) {
    const std::string& found = state.Metadata(key, source);
    if (found != (key == "schema" ? kStateSchema : value))
      throw Error(source + ": not the state of this fit: another " + key);
  }
  const nlohmann::json progress = nlohmann::json::parse(state.Metadata("progress", source));
  report.epochs = progress.at("epochs");
  report.best_epoch = progress.at("best_epoch");
  report.train_rmse_mm = progress.at("train_rmse_mm");
  if (!progress.at("validation_rmse_mm").is_null())
    report.validation_rmse_mm = progress.at("validation_rmse_mm").get<double>();
  trainer.Load(state, source);
  for (const auto& [name, tensor] : state.tensors) {
    if (name.starts_with("best.")) report.model.tensors[name.substr(5)] = tensor;
  }
}

}  // namespace

FitReport FitSurrogate(const FitConfig& config, const FitRequest& request) {
  const auto read = [&](const std::vector<std::filesystem::path>& files) {
    return ReadFitStrokes(files, config.surrogate.heightfield.blade, config.surrogate.cell_size_m);
  };
  const FitStrokes validation_strokes = read(request.validation), recorded = read(request.data);
  CheckSplit(recorded, validation_strokes);
  at::set_num_threads(request.threads);
  const std::vector<FitSample> validation = RecordedSamples(validation_strokes, config.surrogate);

  FitReport report;
  const bool generates = request.data.empty();
  report.strokes = static_cast<int>(generates ? config.generate.strokes : recorded.strokes.size());
  report.validation_strokes = static_cast<int>(validation.size());
  report.model.metadata = Metadata(config, request, recorded, validation_strokes);
  Trainer trainer(config, request.seed);
  if (request.init) trainer.StartFrom(ReadSafetensors(*request.init), request.init->string());
  if (request.resume) Restore(request.state.value(), trainer, report);
  if (!validation.empty()) report.validation_start_rmse_mm = StartError(validation).rmse_mm();

  Progress progress("fit", config.epochs, "epochs", request.status);
  progress.Update(report.epochs);
  const int last_epoch = static_cast<int>(
      request.epochs_now > 0 ? std::min(report.epochs + request.epochs_now, config.epochs)
                             : config.epochs);
  FitStrokes made;  // of one pass
  const auto strokes_of = [&](int epoch) -> const FitStrokes& {
    if (!generates) return recorded;
    made = GenerateStrokes(config.generate, config.surrogate.cell_size_m, request.seed, epoch);
    return made;
  };
  std::optional<Safetensors> state;  // after the last whole epoch
  double written_s = -kStateInterval_s;
  std::optional<TensorboardWriter> log;
  if (request.log) {
    std::filesystem::create_directories(*request.log);
    log.emplace(*request.log);
  }
  const auto patient = [&] { return report.epochs - report.best_epoch < config.patience; };
  while (report.epochs < last_epoch && patient()) {
    const int epoch = report.epochs + 1;
    ErrorSum error;
    report.stopped = !trainer.RunEpoch(epoch, strokes_of(epoch).strokes, error);
    if (report.stopped) break;
    report.epochs = epoch;
    report.train_rmse_mm = error.rmse_mm();
    std::string note = "training " + Millimetres(report.train_rmse_mm);
    std::vector<std::pair<std::string, double>> scalars = {
        {"rmse_mm/training", report.train_rmse_mm}};
    if (validation.empty()) {
      report.best_epoch = epoch;
      trainer.mean().Save(report.model);
    } else {
      const double rmse_mm = Evaluate(trainer.mean(), validation).rmse_mm();
      scalars.emplace_back("rmse_mm/validation", rmse_mm);
      if (!report.validation_rmse_mm || rmse_mm < *report.validation_rmse_mm) {
        report.validation_rmse_mm = rmse_mm;
        report.best_epoch = epoch;
        trainer.mean().Save(report.model);
      }
      note += ", " +
              ValidationNote(rmse_mm, *report.validation_rmse_mm, *report.validation_start_rmse_mm);
    }
    if (log) log->Write(epoch, scalars);
    if (request.status) request.status->Figures(nlohmann::json(std::map(scalars.begin(), scalars.end())));
    progress.Update(epoch, note);
    if (!request.state) continue;
    state = Snapshot(trainer, report);
    if (progress.elapsed_s() - written_s < kStateInterval_s) continue;
    WriteSafetensors(*state, *request.state);
    written_s = progress.elapsed_s();
  }
  report.stopped = report.stopped || (report.epochs < config.epochs && patient());
  if (report.stopped && state) WriteSafetensors(*state, *request.state);
  report.seconds = progress.elapsed_s();
  if (report.epochs == 0) ThrowIfStopRequested();
  std::vector<SurrogateInput> inputs;
  for (FitSample& sample : RecordedSamples(strokes_of(report.epochs), config.surrogate))
    inputs.push_back(std::move(sample.input));
  TrainingRange(inputs).Save(report.model);
  return report;
}

nlohmann::json FitReport::ToJson() const {
  return {{"strokes", strokes},
          {"validation_strokes", validation_strokes},
          {"epochs", epochs},
          {"best_epoch", best_epoch},
          {"train_rmse_mm", train_rmse_mm},
          {"validation_rmse_mm", JsonNumber(validation_rmse_mm)},
          {"validation_start_rmse_mm", JsonNumber(validation_start_rmse_mm)},
          {"seconds", seconds},
          {"stopped", stopped}};
}

}  // namespace sandwright
