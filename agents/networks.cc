#include "agents/networks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "agents/categorical.h"
#include "agents/plain_layers.h"
#include "data/base/error.h"
#include "env/observation.h"

namespace sandwright {
namespace {

namespace nn = torch::nn;
namespace F = torch::nn::functional;

constexpr double kHiddenGain = std::numbers::sqrt2;
constexpr const char* kSurplusChannel = "goal_difference_coarse";
constexpr double kPolicyGain = 0.01;  // the first policy is close to uniform
constexpr int64_t kPlainRows = 32;    // more of them at once are torch's
constexpr double kLinearSoftplus = 20;  // above it softplus is the identity, as in torch

// Rows (or columns) of equal length at right angles: Saxe et al., ICLR 2014.
void Orthogonal(torch::Tensor weight, double gain, RandomStream& stream) {
  const torch::NoGradGuard no_grad;
  const int64_t outputs = weight.size(0), inputs = weight.numel() / outputs;
  const int64_t tall = std::max(outputs, inputs), wide = std::min(outputs, inputs);
  auto random = torch::empty({tall, wide}, torch::kFloat64);
  for (int64_t i = 0; i < random.numel(); ++i) random.data_ptr<double>()[i] = stream.Normal();
  auto [q, r] = torch::linalg_qr(random);
  q = q * r.diagonal().sign();
  if (outputs < inputs) q = q.t();
  weight.copy_((gain * q).reshape(weight.sizes()));
}

template <class Layer>
void Initialise(Layer& layer, double gain, RandomStream& stream) {
  Orthogonal(layer->weight, gain, stream);
  if (layer->bias.defined()) {
    const torch::NoGradGuard no_grad;
    layer->bias.zero_();
  }
}

nn::Conv2d Convolution(int64_t in, int64_t out, int64_t kernel, int64_t stride) {
  return nn::Conv2d(nn::Conv2dOptions(in, out, kernel).stride(stride).padding(kernel / 2));
}

// [B, A] on the CPU; rows are drawn with equally many consecutive ones a stream.
torch::Tensor SampleBetas(const BetaParameters& p, std::span<RandomStream> streams) {
  const auto alpha = p.alpha.to(torch::kCPU).contiguous(), beta = p.beta.to(torch::kCPU).contiguous();
  const int64_t numbers = alpha.size(1), draws = alpha.size(0) / static_cast<int64_t>(streams.size());
  auto drawn = torch::empty_like(alpha);
  for (int64_t i = 0; i < alpha.numel(); ++i)
    drawn.data_ptr<float>()[i] =
        SampleBeta(alpha.data_ptr<float>()[i], beta.data_ptr<float>()[i],
                   streams[static_cast<size_t>(i / numbers / draws)]);
  return drawn;
}

torch::Tensor Enlarge(const torch::Tensor& features, const torch::Tensor& like) {
  return F::interpolate(features, F::InterpolateFuncOptions()
                                      .size(std::vector<int64_t>{like.size(2), like.size(3)})
                                      .mode(torch::kBilinear)
                                      .align_corners(false));
}

}  // namespace

ActorCritic::ActorCritic(const ObservationSpec& spec, int action_size, const NetworkConfig& config,
                         RandomStream& stream, int choices)
    : has_map_(spec.map_size() > 0), action_size_(action_size), choices_(choices) {
  SAND_CHECK(choices == 0 || (!has_map_ && action_size == 1), choices, action_size);
  const int64_t width = config.channels, hidden = config.hidden;
  int64_t whole_inputs = spec.vec_size(), rest_inputs = hidden;
  if (has_map_) {
    SAND_CHECK(action_size > PlaceGrid::kNumbers, action_size);
    const auto half = [](int64_t size) { return (size + 1) / 2; };
    const int64_t rows = half(spec.rows), columns = half(spec.columns);
    grid_ = {static_cast<int>(config.headings), static_cast<int>(rows), static_cast<int>(columns)};
    whole_inputs += 2 * width * half(half(rows)) * half(half(columns));
    rest_inputs += 2 * width + 2;
    const auto x = torch::linspace(-1, 1, spec.columns).expand({spec.rows, spec.columns});
    const auto y = torch::linspace(-1, 1, spec.rows).unsqueeze(1).expand({spec.rows, spec.columns});
    coordinates_ = torch::stack({x, y}).unsqueeze(0).clone();
    const auto channels = static_cast<int64_t>(spec.channels.size());
    fine_ = register_module("fine", Convolution(channels + 2, width, 3, 2));
    middle_ = register_module("middle", Convolution(width, 2 * width, 3, 2));
    coarse_ = register_module("coarse", Convolution(2 * width, 2 * width, 3, 2));
    fine_mix_ = register_module("fine_mix", Convolution(width, 2 * width, 1, 1));
    middle_mix_ = register_module("middle_mix", Convolution(2 * width, 2 * width, 1, 1));
    coarse_mix_ = register_module("coarse_mix", Convolution(2 * width, 2 * width, 1, 1));
    whole_mix_ = register_module("whole_mix", nn::Linear(hidden, 2 * width));
    place_head_ = register_module("place_head", Convolution(2 * width, config.headings, 1, 1));
    if (config.surplus_first > 0) PreferSurplus(spec, config);
    for (auto* layer : {&fine_, &middle_, &coarse_, &fine_mix_, &middle_mix_, &coarse_mix_})
      Initialise(*layer, kHiddenGain, stream);
    Initialise(whole_mix_, kHiddenGain, stream);
    Initialise(place_head_, kPolicyGain, stream);
    AddBlocks(config, stream);
  }
  whole_in_ = register_module("whole_in", nn::Linear(whole_inputs, hidden));
  whole_out_ = register_module("whole_out", nn::Linear(hidden, hidden));
  if (has_map_) rest_hidden_ = register_module("rest_hidden", nn::Linear(rest_inputs, hidden));
  rest_head_ =
      register_module("rest_head", nn::Linear(hidden, choices > 0 ? choices : 2 * action_size));
  if (!has_map_) value_in_ = register_module("value_in", nn::Linear(whole_inputs, hidden));
  value_hidden_ = register_module("value_hidden", nn::Linear(hidden, hidden));
  value_head_ = register_module("value_head", nn::Linear(hidden, 1));
  for (auto* layer : {&whole_in_, &whole_out_, &rest_hidden_, &value_in_, &value_hidden_})
    if (*layer) Initialise(*layer, kHiddenGain, stream);
  Initialise(rest_head_, kPolicyGain, stream);
  Initialise(value_head_, 1.0, stream);
  if (choices > 0 && !config.first_guess.empty())
    throw Error("network.first_guess: this task is played by choices; allowed: none");
  GuessFirst(config.first_guess);
  if (config.normalize)
    normalizer_ = register_module("normalizer",
                                  std::make_shared<ObservationNormalizer>(spec.vec_size()));
}

void ActorCritic::AddBlocks(const NetworkConfig& config, RandomStream& stream) {
  const int64_t width = config.channels;
  for (int64_t i = 0; i < config.blocks; ++i) {
    const int64_t dilation = int64_t{1} << (i % 3);
    const auto name = [&](const char* layer) { return "block" + std::to_string(i) + "_" + layer; };
    Block block;
    block.narrow = register_module(name("narrow"), Convolution(2 * width, width, 1, 1));
    block.look = register_module(
        name("look"),
        nn::Conv2d(nn::Conv2dOptions(width, width, 3).padding(dilation).dilation(dilation)));
    block.widen = register_module(name("widen"), Convolution(width, 2 * width, 1, 1));
    Initialise(block.narrow, kHiddenGain, stream);
    Initialise(block.look, kHiddenGain, stream);
    Initialise(block.widen, 0, stream);
    blocks_.push_back(block);
  }
}

void ActorCritic::PreferSurplus(const ObservationSpec& spec, const NetworkConfig& config) {
  const auto channel = std::ranges::find(spec.channels, kSurplusChannel);
  if (channel == spec.channels.end())
    throw Error(std::string("network.surplus_first needs an observation channel ") +
                kSurplusChannel);
  place_skip_ = register_module(
      "place_skip", Convolution(static_cast<int64_t>(spec.channels.size()), config.headings, 1, 1));
  const torch::NoGradGuard no_grad;
  place_skip_->weight.zero_();
  place_skip_->bias.zero_();
  place_skip_->weight.select(1, channel - spec.channels.begin())
      .fill_(-config.surplus_first * kDifferenceScale_m / 0.010);
}

void ActorCritic::GuessFirst(const std::vector<double>& means) {
  if (means.empty()) return;
  const torch::NoGradGuard no_grad;
  const int64_t placed = has_map_ ? PlaceGrid::kNumbers : 0, numbers = action_size_ - placed;
  if (static_cast<int64_t>(means.size()) != numbers)
    throw Error("network.first_guess has " + std::to_string(means.size()) +
                " numbers; allowed: none or " + std::to_string(numbers));
  const double broad = 1.0 + std::numbers::ln2;  // the concentration at output 0
  for (int64_t i = 0; i < numbers; ++i) {
    const double share = (means[static_cast<size_t>(i)] + 1.0) / 2.0;  // alpha / (alpha + beta)
    const double ratio = std::max(share, 1.0 - share) / std::min(share, 1.0 - share);
    // The lesser concentration stays broad, the greater one is set
    // for the mean: inverse of softplus + 1.
    const double output = std::log(std::expm1(broad * ratio - 1.0));
    rest_head_->bias[placed + (share > 0.5 ? i : action_size_ + i)] = output;
  }
}

ActorCritic::Encoding ActorCritic::Encode(const ObservationTensors& observation) {
  Encoding encoding;
  const auto numbers = normalizer_ ? normalizer_->Forward(observation.vec) : observation.vec;
  if (!has_map_) {
    encoding.whole = torch::tanh(whole_out_(torch::tanh(whole_in_(numbers))));
    encoding.worth = torch::tanh(value_hidden_(torch::tanh(value_in_(numbers))));
    return encoding;
  }
  coordinates_ = coordinates_.to(observation.map.device());
  // Channels last: convolutions of few channels take half the time, forward and backward.
  const auto input =
      torch::cat({observation.map, coordinates_.expand({observation.map.size(0), -1, -1, -1})}, 1)
          .contiguous(torch::MemoryFormat::ChannelsLast);
  const auto fine = torch::relu(fine_(input));
  const auto middle = torch::relu(middle_(fine));
  const auto coarse = torch::relu(coarse_(middle));
  const auto whole = torch::cat({coarse.flatten(1), numbers}, 1);
  encoding.whole = torch::relu(whole_out_(torch::relu(whole_in_(whole))));
  encoding.worth = torch::relu(value_hidden_(encoding.whole));
  // Every scale meets at the finest one, as in feature pyramids (Lin et al., CVPR 2017).
  encoding.places = torch::relu(fine_mix_(fine) + Enlarge(middle_mix_(middle), fine) +
                                Enlarge(coarse_mix_(coarse), fine) +
                                whole_mix_(encoding.whole).unsqueeze(-1).unsqueeze(-1));
  for (Block& block : blocks_)
    encoding.places = encoding.places +
                      block.widen(torch::relu(block.look(torch::relu(block.narrow(encoding.places)))));
  return encoding;
}

torch::Tensor ActorCritic::PlaceLogits(const Encoding& encoding, const torch::Tensor& map) {
  const auto logits = place_head_(encoding.places);
  if (!place_skip_) return logits.flatten(1);
  const auto pooled =
      F::avg_pool2d(map, F::AvgPool2dFuncOptions(2).ceil_mode(true).count_include_pad(false));
  return (logits + place_skip_(pooled)).flatten(1);
}

BetaParameters ActorCritic::NumbersAt(const Encoding& encoding, const torch::Tensor& row,
                                      const torch::Tensor& bin) {
  const auto here =
      encoding.places.flatten(2).transpose(1, 2).index({row, bin.remainder(grid_.cells())});
  const auto heading_rad = grid_.Centre(bin).narrow(1, 2, 1) * std::numbers::pi;
  const auto input = torch::cat(
      {here, encoding.whole.index_select(0, row), heading_rad.cos(), heading_rad.sin()}, 1);
  return BetaFromOutputs(rest_head_(torch::relu(rest_hidden_(input))));
}

torch::Tensor ActorCritic::ValueOf(const Encoding& encoding) {
  return value_head_(encoding.worth).squeeze(-1);
}

torch::Tensor ActorCritic::Value(const ObservationTensors& observation) {
  const torch::NoGradGuard no_grad;
  return ValueOf(Encode(observation)).to(torch::kCPU);
}

void ActorCritic::Observe(const ObservationTensors& observation) {
  if (normalizer_) normalizer_->Observe(observation.vec);
}

ActorCritic::Decision ActorCritic::SampleChoice(const Encoding& encoding,
                                                std::span<RandomStream> streams) {
  const auto logits = rest_head_(encoding.whole).to(torch::kCPU);
  const auto probability = torch::softmax(logits, -1).contiguous();
  const auto batch = static_cast<int64_t>(streams.size()), choices = logits.size(1);
  auto choice = torch::empty({batch}, torch::kInt64);
  for (int64_t i = 0; i < batch; ++i) {
    const std::span row(probability.data_ptr<float>() + i * choices, static_cast<size_t>(choices));
    choice.data_ptr<int64_t>()[i] = SampleCategorical(row, streams[static_cast<size_t>(i)]);
  }
  return {choice.to(torch::kFloat32).unsqueeze(1), CategoricalLogProb(logits, choice),
          ValueOf(encoding).to(torch::kCPU)};
}

ActorCritic::Decision ActorCritic::SamplePlaces(const Encoding& encoding, const torch::Tensor& map,
                                                std::span<RandomStream> streams, int draws) {
  const auto device = encoding.whole.device();
  const auto logits = PlaceLogits(encoding, map);
  const auto probability = torch::softmax(logits, -1).to(torch::kCPU).contiguous();
  const auto bins = static_cast<size_t>(grid_.bins());
  std::vector<int64_t> row, bin;
  for (size_t i = 0; i < streams.size(); ++i) {
    for (int k = 0; k < draws; ++k) {
      row.push_back(static_cast<int64_t>(i));
      bin.push_back(
          SampleCategorical({probability.data_ptr<float>() + i * bins, bins}, streams[i]));
    }
  }
  const auto rows = torch::tensor(row).to(device), chosen = torch::tensor(bin).to(device);
  const BetaParameters numbers = NumbersAt(encoding, rows, chosen);
  const auto drawn = SampleBetas(numbers, streams).to(device);
  const auto action = ActionAt(chosen, drawn);
  const auto log_prob = CategoricalLogProb(logits.index_select(0, rows), chosen) +
                        BetaLogProb(numbers, Offsets(action, chosen)) + grid_.LogDensityOfOffset();
  return {action.to(torch::kCPU), log_prob.to(torch::kCPU),
          ValueOf(encoding).index_select(0, rows).to(torch::kCPU)};
}

torch::Tensor ActorCritic::ActionAt(const torch::Tensor& bin, const torch::Tensor& offsets) const {
  return torch::cat({grid_.Place(bin, offsets.narrow(1, 0, PlaceGrid::kNumbers)),
                     offsets.narrow(1, PlaceGrid::kNumbers, action_size_ - PlaceGrid::kNumbers)},
                    1);
}

torch::Tensor ActorCritic::Offsets(const torch::Tensor& action, const torch::Tensor& bin) const {
  return torch::cat({grid_.Offset(action.narrow(1, 0, PlaceGrid::kNumbers), bin),
                     action.narrow(1, PlaceGrid::kNumbers, action_size_ - PlaceGrid::kNumbers)},
                    1);
}

ActorCritic::Decision ActorCritic::SamplePlainly(const torch::Tensor& numbers,
                                                 std::span<RandomStream> streams) {
  PlainRows rows = Eigen::Map<const PlainRows>(numbers.data_ptr<float>(), numbers.size(0),
                                               numbers.size(1));
  if (normalizer_)
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      normalizer_->ForwardRow({rows.row(i).data(), static_cast<size_t>(rows.cols())});
  PlainRows outputs = PlainLinear(rest_head_, PlainTanhLayers(whole_in_, whole_out_, rows));
  const PlainRows value = PlainLinear(value_head_, PlainTanhLayers(value_in_, value_hidden_, rows));
  Decision decision{torch::empty({rows.rows(), action_size_}), torch::empty({rows.rows()}),
                    torch::empty({rows.rows()})};
  float* action = decision.action.data_ptr<float>();
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    RandomStream& stream = streams[static_cast<size_t>(i)];
    double log_prob = 0;
    if (choices_ > 0) {
      auto row = outputs.row(i).array();
      row = (row - row.maxCoeff()).exp();
      row /= row.sum();
      const int choice = SampleCategorical({row.data(), static_cast<size_t>(choices_)}, stream);
      log_prob = std::log(row[choice]);
      *action++ = static_cast<float>(choice);
    } else {
      const auto concentration = [&](int64_t j) {
        const double output = outputs(i, j);
        return 1.0 + (output > kLinearSoftplus ? output : std::log1p(std::exp(output)));
      };
      for (int64_t j = 0; j < action_size_; ++j) {
        const double alpha = concentration(j), beta = concentration(action_size_ + j);
        *action = SampleBeta(alpha, beta, stream);
        log_prob += BetaLogProb(alpha, beta, *action++);
      }
    }
    decision.log_prob.data_ptr<float>()[i] = static_cast<float>(log_prob);
    decision.value.data_ptr<float>()[i] = value(i, 0);
  }
  return decision;
}

ActorCritic::Decision ActorCritic::Sample(const ObservationTensors& observation,
                                          std::span<RandomStream> streams, int draws) {
  const torch::NoGradGuard no_grad;
  if (!has_map_ && observation.vec.is_cpu() && observation.vec.size(0) <= kPlainRows) {
    SAND_CHECK(observation.vec.is_contiguous() &&
                   observation.vec.size(0) == static_cast<int64_t>(streams.size()),
               streams.size());
    return SamplePlainly(observation.vec, streams);
  }
  const Encoding encoding = Encode(observation);
  SAND_CHECK(encoding.whole.size(0) == static_cast<int64_t>(streams.size()),
             encoding.whole.size(0), streams.size());
  if (has_map_) return SamplePlaces(encoding, observation.map, streams, draws);
  SAND_CHECK(draws == 1, draws);
  if (choices_ > 0) return SampleChoice(encoding, streams);
  const BetaParameters numbers = BetaFromOutputs(rest_head_(encoding.whole));
  const auto action = SampleBetas(numbers, streams);
  return {action, BetaLogProb({numbers.alpha.to(torch::kCPU), numbers.beta.to(torch::kCPU)}, action),
          ValueOf(encoding).to(torch::kCPU)};
}

torch::Tensor ActorCritic::Mean(const ObservationTensors& observation) {
  const torch::NoGradGuard no_grad;
  const Encoding encoding = Encode(observation);
  if (choices_ > 0)
    return rest_head_(encoding.whole).argmax(-1, true).to(torch::kCPU, torch::kFloat32);
  if (!has_map_) return BetaMean(BetaFromOutputs(rest_head_(encoding.whole))).to(torch::kCPU).contiguous();
  const auto bin = PlaceLogits(encoding, observation.map).argmax(-1);
  const auto mean = BetaMean(NumbersAt(encoding, torch::arange(bin.size(0), bin.device()), bin));
  return ActionAt(bin, mean).to(torch::kCPU).contiguous();
}

ActorCritic::Terms ActorCritic::Evaluate(const ObservationTensors& observation,
                                         const torch::Tensor& action) {
  const Encoding encoding = Encode(observation);
  if (choices_ > 0) {
    const auto logits = rest_head_(encoding.whole);
    return {CategoricalLogProb(logits, action.squeeze(1).to(torch::kInt64)),
            CategoricalEntropy(logits), ValueOf(encoding)};
  }
  if (!has_map_) {
    const BetaParameters all = BetaFromOutputs(rest_head_(encoding.whole));
    return {BetaLogProb(all, action), BetaEntropy(all), ValueOf(encoding)};
  }
  const int64_t rows = encoding.whole.size(0);
  const auto row = torch::arange(rows, action.device()).repeat_interleave(action.size(0) / rows);
  const auto bin = grid_.Bin(action.narrow(1, 0, PlaceGrid::kNumbers));
  const auto log_probability = torch::log_softmax(PlaceLogits(encoding, observation.map), -1);
  const auto bin_entropy = -(log_probability.exp() * log_probability).sum(-1);
  const BetaParameters numbers = NumbersAt(encoding, row, bin);
  return {log_probability.index({row, bin}) + BetaLogProb(numbers, Offsets(action, bin)) +
              grid_.LogDensityOfOffset(),
          bin_entropy.index_select(0, row) + BetaEntropy(numbers) - grid_.LogDensityOfOffset(),
          ValueOf(encoding)};
}

}  // namespace sandwright
