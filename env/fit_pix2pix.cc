#include "env/fit_pix2pix.h"

#include <ATen/CPUGeneratorImpl.h>
#include <ATen/Parallel.h>
#include <torch/types.h>

#include <algorithm>
#include <cmath>

#include "data/base/json_number.h"
#include "data/base/progress.h"
#include "data/base/random.h"
#include "data/base/stop.h"
#include "env/fit_samples.h"
#include "env/pix2pix_net.h"

namespace sandwright {
namespace {

// One stroke as a pair of pictures.
struct PaperPair {
  std::string name;  // for messages
  PaperInput input;
  PaperPlane after;
};

PaperPair MakePair(const std::string& name, const StrokeRecord& record) {
  std::optional<PaperInput> input = EncodePaperInput(record.before, record.path, record.blade);
  if (!input) throw Error(name + ": the paper's crop around the path lies outside the box");
  PaperPlane after = EncodePaperHeight(record.after, *input);
  return {name, std::move(*input), std::move(after)};
}

std::vector<PaperPair> MakePairs(const FitStrokes& strokes) {
  std::vector<PaperPair> pairs;
  for (const FitStroke& stroke : strokes.strokes)
    pairs.push_back(MakePair(stroke.name, stroke.record));
  return pairs;
}

// Squared errors in levels and the pixels they were taken over.
struct ErrorSum {
  double squared = 0, pixels = 0;
  void Add(const PaperPair& pair, const PaperPlane& predicted) {
    for (size_t i = 0; i < kPaperCount; ++i) {
      if (pair.input.counts[i] == 0) continue;
      const double error = int{predicted[i]} - int{pair.after[i]};
      squared += error * error;
      ++pixels;
    }
  }
  double rmse_mm() const { return std::sqrt(squared / pixels) * kPaperLevel_m * 1e3; }
};

// Adam (Kingma and Ba, ICLR 2015) by torch's fused kernel: the nets are so large that one pass over
// their memory in place of ten is a tenth of a step.
class Adam {
 public:
  Adam(std::vector<torch::Tensor> parameters, double beta1)
      : parameters_(std::move(parameters)), beta1_(beta1) {
    for (torch::Tensor& p : parameters_) {
      p.set_requires_grad(true);
      means_.push_back(torch::zeros_like(p));
      squares_.push_back(torch::zeros_like(p));
      steps_.push_back(torch::zeros({}));
    }
  }

  // Takes the gradients and leaves none.
  void Step(double learning_rate) {
    const torch::NoGradGuard no_grad;
    std::vector<torch::Tensor> gradients;
    for (size_t i = 0; i < parameters_.size(); ++i) {
      gradients.push_back(parameters_[i].grad());
      parameters_[i].mutable_grad().reset();
      steps_[i] += 1;
    }
    at::_fused_adam_(parameters_, gradients, means_, squares_, {}, steps_, learning_rate, beta1_,
                     0.999, 0, 1e-8, false, false);
  }
  void RequireGradients(bool required) {
    for (torch::Tensor& p : parameters_) p.set_requires_grad(required);
  }

 private:
  std::vector<torch::Tensor> parameters_, means_, squares_, steps_;
  double beta1_;
};

Pix2PixGenerator StartGenerator(const FitPix2PixConfig& config, const FitPix2PixRequest& request) {
  if (request.init)
    return {config.model.channels, ReadSafetensors(*request.init), request.init->string()};
  return {config.model.channels, RandomStream(request.seed, StreamId("pix2pix.generator"))};
}

class Trainer {
 public:
  Trainer(const FitPix2PixConfig& config, const FitPix2PixRequest& request,
          const std::vector<PaperPair>& pairs)
      : config_(config),
        seed_(request.seed),
        pairs_(pairs),
        generator_(StartGenerator(config, request)),
        discriminator_(config.model.channels,
                       RandomStream(request.seed, StreamId("pix2pix.discriminator"))),
        generator_adam_(generator_.layers().parameters(), config.beta1),
        discriminator_adam_(discriminator_.layers().parameters(), config.beta1) {
    config_.pretrain.heightfield.blade = config.model.blade;
  }

  const Pix2PixGenerator& generator() const { return generator_; }

  // Step 1, 2, ...
  void Step(int64_t step) {
    RandomStream stream(seed_, StreamId("pix2pix.step"), static_cast<uint64_t>(step));
    if (step <= config_.pretrain_steps) {
      RandomStream made(seed_, StreamId("pix2pix.pretrain"), static_cast<uint64_t>(step));
      const std::string name = "heightfield stroke of step " + std::to_string(step);
      const auto drawn = DrawHeightfieldStrokes(config_.pretrain, config_.pretrain_cell_m, 1, made);
      Learn(step, MakePair(name, drawn.front()), stream);
    } else {
      Learn(step, pairs_[stream.Index(pairs_.size())], stream);
    }
  }

  ErrorSum Evaluate(const std::vector<PaperPair>& pairs) const {
    const torch::NoGradGuard no_grad;
    ErrorSum sum;
    for (const PaperPair& pair : pairs)
      sum.Add(pair, PaperPlaneOf(generator_.Forward(PaperTensor(pair.input))));
    return sum;
  }

 private:
  void Learn(int64_t step, const PaperPair& pair, RandomStream& stream) {
    const bool mirrored = config_.mirror && stream.Index(2) == 1;
    const auto turn = [&](const torch::Tensor& x) { return mirrored ? x.flip({3}) : x; };
    const torch::Tensor input = turn(PaperTensor(pair.input)),
                        truth = turn(PaperTensor(pair.after));
    const torch::Tensor counts = turn((PaperTensor(pair.input.counts) + 1) * 127.5);
    const auto dropout = at::make_generator<at::CPUGeneratorImpl>(stream.Next64());
    const torch::Tensor answer = generator_.Forward(input, dropout);
    const double rate = LearningRate(step);

    torch::Tensor loss =
        config_.l1_weight * ((answer - truth).abs() * counts).sum() / counts.sum().clamp_min(1);
    if (config_.gan_weight > 0) {
      discriminator_adam_.RequireGradients(true);
      const torch::Tensor judged =
          (Judgement(input, truth, true) + Judgement(input, answer.detach(), false)) / 2;
      CheckFinite(judged, "discriminator", step, pair);
      judged.backward();
      discriminator_adam_.Step(rate);
      discriminator_adam_.RequireGradients(false);
      loss = loss + config_.gan_weight * Judgement(input, answer, true);
    }
    CheckFinite(loss, "generator", step, pair);
    loss.backward();
    generator_adam_.Step(rate);
  }

  // Cross entropy of the discriminator's judgement of an answer, against what it should be.
  torch::Tensor Judgement(const torch::Tensor& input, const torch::Tensor& answer,
                          bool real) const {
    const torch::Tensor logits = discriminator_.Forward(input, answer);
    return torch::binary_cross_entropy_with_logits(logits, torch::full_like(logits, real ? 1 : 0));
  }

  // The first half of all steps at the full rate, then linearly to zero.
  double LearningRate(int64_t step) const {
    const auto all = static_cast<double>(config_.pretrain_steps + config_.steps);
    return config_.learning_rate * std::min(1.0, 2 * (1 - static_cast<double>(step - 1) / all));
  }

  static void CheckFinite(const torch::Tensor& loss, const char* of, int64_t step,
                          const PaperPair& pair) {
    if (std::isfinite(loss.item<double>())) return;
    throw Error("fit: the loss of the " + std::string(of) + " is not finite in step " +
                std::to_string(step) + ":\n  " + pair.name);
  }

  FitPix2PixConfig config_;
  uint64_t seed_;
  const std::vector<PaperPair>& pairs_;
  Pix2PixGenerator generator_;
  Pix2PixDiscriminator discriminator_;
  Adam generator_adam_, discriminator_adam_;
};

// The parameters of the generator that is kept.
class Kept {
 public:
  void Take(const Pix2PixGenerator& generator) {
    values_.clear();
    for (const torch::Tensor& p : generator.layers().parameters())
      values_.push_back(p.detach().clone());
  }
  const std::vector<torch::Tensor>& values() const { return values_; }

 private:
  std::vector<torch::Tensor> values_;
};

std::map<std::string, std::string> Metadata(const FitPix2PixConfig& config,
                                            const FitPix2PixRequest& request,
                                            const FitStrokes& data, const FitStrokes& validation) {
  FitPix2PixConfig fit = config;
  return {{"schema", "sandwright-pix2pix"},
          {"config", ToJson(FieldsOf(fit.model)).dump()},
          {"fit", ToJson(FieldsOf(fit)).dump()},
          {"data", SplitIdentity(data, validation, request.init).dump()},
          {"seed", std::to_string(request.seed)}};
}

}  // namespace

FitPix2PixReport FitPix2Pix(const FitPix2PixConfig& config, const FitPix2PixRequest& request) {
  const FitStrokes data = ReadFitStrokes(request.data, config.model.blade),
                   validation_strokes = ReadFitStrokes(request.validation, config.model.blade);
  CheckSplit(data, validation_strokes);
  at::set_num_threads(request.threads);
  const std::vector<PaperPair> pairs = MakePairs(data), validation = MakePairs(validation_strokes);

  FitPix2PixReport report;
  report.strokes = static_cast<int>(pairs.size());
  report.validation_strokes = static_cast<int>(validation.size());
  report.model.metadata = Metadata(config, request, data, validation_strokes);
  if (!validation.empty()) {
    ErrorSum start;
    for (const PaperPair& pair : validation) start.Add(pair, pair.input.height);
    report.validation_start_rmse_mm = start.rmse_mm();
  }
  Trainer trainer(config, request, pairs);
  Kept best;
  std::string note;
  const int64_t steps = config.pretrain_steps + config.steps;
  Progress progress("fit", steps, "steps", request.status);
  while (report.steps < steps && !(report.stopped = StopRequested())) {
    trainer.Step(++report.steps);
    if (!validation.empty() &&
        (report.steps % config.validate_every == 0 || report.steps == steps)) {
      const double rmse_mm = trainer.Evaluate(validation).rmse_mm();
      if (!report.validation_rmse_mm || rmse_mm < *report.validation_rmse_mm) {
        report.validation_rmse_mm = rmse_mm;
        report.best_step = report.steps;
        best.Take(trainer.generator());
      }
      note = ValidationNote(rmse_mm, *report.validation_rmse_mm, *report.validation_start_rmse_mm);
    }
    progress.Update(report.steps, note);
  }
  report.seconds = progress.elapsed_s();
  if (validation.empty() && report.steps > 0) {
    report.best_step = report.steps;
    best.Take(trainer.generator());
  }
  if (report.best_step == 0) ThrowIfStopRequested();
  trainer.generator().layers().Save(best.values(), report.model);
  return report;
}

nlohmann::json FitPix2PixReport::ToJson() const {
  return {{"strokes", strokes},
          {"validation_strokes", validation_strokes},
          {"steps", steps},
          {"best_step", best_step},
          {"validation_rmse_mm", JsonNumber(validation_rmse_mm)},
          {"validation_start_rmse_mm", JsonNumber(validation_start_rmse_mm)},
          {"seconds", seconds},
          {"stopped", stopped}};
}

}  // namespace sandwright
