#include "agents/ppo.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "agents/own_rows.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kAdamEpsilon = 1e-5;

// The rows of `batch` where `chosen` is not 0.
ObservationBatch RowsOf(const ObservationBatch& batch, const ObservationSpec& spec,
                        const std::vector<uint8_t>& chosen) {
  ObservationBatch rows;
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    const auto map = batch.map.begin() + static_cast<int64_t>(i) * spec.map_size();
    const auto vec = batch.vec.begin() + static_cast<int64_t>(i) * spec.vec_size();
    rows.map.insert(rows.map.end(), map, map + spec.map_size());
    rows.vec.insert(rows.vec.end(), vec, vec + spec.vec_size());
  }
  return rows;
}

void Append(ObservationBatch& all, const ObservationBatch& more) {
  all.map.insert(all.map.end(), more.map.begin(), more.map.end());
  all.vec.insert(all.vec.end(), more.vec.begin(), more.vec.end());
}

void Append(std::vector<float>& all, const torch::Tensor& cpu) {
  all.insert(all.end(), cpu.data_ptr<float>(), cpu.data_ptr<float>() + cpu.numel());
}

}  // namespace

Ppo::Ppo(VecEnv& env, ActorCritic& network, const PpoConfig& config, int64_t total_steps,
         uint64_t seed, torch::Device device, Collective& ranks)
    : ranks_(ranks),
      env_(env),
      network_(network),
      config_(config),
      total_steps_(total_steps),
      seed_(seed),
      device_(device),
      optimizer_((network.to(device), network.parameters()), kAdamEpsilon),
      shuffle_stream_(seed, StreamId("ppo shuffle")),
      return_scaler_(env.num_envs() * ranks.size(), config.gamma) {
  for (int i = 0; i < env.num_envs() * ranks.size(); ++i)
    action_streams_.emplace_back(seed, StreamId("ppo action"), static_cast<uint64_t>(i));
  RestartEpisodes();
}

void Ppo::RestartEpisodes() {
  return_scaler_.RestartEpisodes();
  observation_ = env_.Reset(EpisodesSeed(seed_, steps_));
}

std::span<RandomStream> Ppo::OwnStreams() {
  const auto envs = static_cast<size_t>(env_.num_envs());
  return std::span(action_streams_).subspan(static_cast<size_t>(ranks_.rank()) * envs, envs);
}

void Ppo::ObserveReturns(std::span<const float> reward, std::span<const uint8_t> ends) {
  const auto envs = static_cast<size_t>(env_.num_envs());
  const std::vector<float> all_ends =
      GatherSteps(ranks_, std::vector<float>(ends.begin(), ends.end()), envs, 1);
  return_scaler_.Observe(GatherSteps(ranks_, reward, envs, 1),
                         std::vector<uint8_t>(all_ends.begin(), all_ends.end()));
}

Ppo::Collected Ppo::Collect(PpoReport& report) {
  const ObservationSpec& spec = env_.observation_spec();
  const auto envs = static_cast<size_t>(env_.num_envs());
  const size_t count = envs * static_cast<size_t>(config_.num_steps);
  ObservationBatch observations, final_observations;
  std::vector<float> actions, log_probs, values, rewards, next_values(count, 0.0f);
  std::vector<uint8_t> ends;
  std::vector<size_t> truncated_at;
  for (int64_t t = 0; t < config_.num_steps; ++t) {
    const auto decision = network_.Sample(ToTensors(observation_, spec, device_), OwnStreams());
    const size_t first = ends.size();
    StepBatch step = env_.Step({decision.action.data_ptr<float>(), envs * env_.action_size()});
    CheckFinite(step);
    Append(observations, observation_);
    Append(actions, decision.action);
    Append(log_probs, decision.log_prob);
    Append(values, decision.value);
    Append(final_observations, RowsOf(step.final_observation, spec, step.truncated));
    rewards.insert(rewards.end(), step.reward.begin(), step.reward.end());
    for (size_t i = 0; i < envs; ++i) {
      ends.push_back(step.terminated[i] || step.truncated[i]);
      if (step.truncated[i]) truncated_at.push_back(first + i);
    }
    std::ranges::move(step.finished, std::back_inserter(report.finished));
    observation_ = std::move(step.observation);
    ranks_.CheckIn();
  }
  ObserveReturns(rewards, ends);
  if (config_.scale_rewards) return_scaler_.Scale(rewards);
  // V(s_{t+1}) is the next row's value, and the critic's at the end of the rollout...
  std::vector<float> after(values.begin() + static_cast<int64_t>(envs), values.end());
  Append(after, network_.Value(ToTensors(observation_, spec, device_)));
  for (size_t i = 0; i < count; ++i) next_values[i] = ends[i] ? 0.0f : after[i];
  // ... and V of the episode's own last observation where it was cut off from outside.
  if (!truncated_at.empty()) {
    const auto bootstrap = network_.Value(ToTensors(final_observations, spec, device_));
    for (size_t k = 0; k < truncated_at.size(); ++k)
      next_values[truncated_at[k]] = bootstrap.data_ptr<float>()[k];
  }
  const Advantages estimate = EstimateAdvantages(
      rewards, values, next_values, ends, env_.num_envs(), config_.gamma, config_.gae_lambda);
  auto tensor = [&](const std::vector<float>& v) { return torch::tensor(v).to(device_); };
  auto of_all = [&](const std::vector<float>& v) { return tensor(GatherSteps(ranks_, v, envs, 1)); };
  const auto all_advantage = of_all(estimate.advantage);
  report.explained_variance = ExplainedVariance(of_all(values), of_all(estimate.value_target));
  report.advantage_deviation = all_advantage.std().item<double>();
  Rollout rollout{ToTensors(observations, spec, device_),
          tensor(actions).view({-1, env_.action_size()}),
          tensor(log_probs),
          tensor(values),
          tensor(estimate.advantage),
          tensor(estimate.value_target)};
  return {std::move(rollout), all_advantage};
}

std::vector<int64_t> Ppo::Permutation(int64_t count) {
  std::vector<int64_t> order(static_cast<size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  for (size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i], order[shuffle_stream_.Index(i + 1)]);
  return order;
}

Ppo::Rollout Ppo::Rollout::Map(
    const std::function<torch::Tensor(const torch::Tensor&)>& choose) const {
  return {{choose(observation.map), choose(observation.vec)},
          choose(action),
          choose(log_prob),
          choose(value),
          choose(advantage),
          choose(value_target)};
}

std::array<float, 5> Ppo::Differentiate(const Rollout& rows, double share, double clip) {
  const auto terms = network_.Evaluate(rows.observation, rows.action);
  const auto log_ratio = terms.log_prob - rows.log_prob;
  const auto ratio = log_ratio.exp();

  // Equation 7 of the PPO paper, as a loss.
  const auto policy_loss =
      -torch::min(ratio * rows.advantage, ratio.clamp(1.0 - clip, 1.0 + clip) * rows.advantage).mean();
  auto value_error = (terms.value - rows.value_target).square();
  if (config_.value_clip_range > 0) {
    const double range = config_.value_clip_range;
    const auto near = rows.value + (terms.value - rows.value).clamp(-range, range);
    value_error = torch::max(value_error, (near - rows.value_target).square());
  }
  const auto value_loss = 0.5 * value_error.mean();
  const auto entropy = terms.entropy.mean();
  auto loss = policy_loss + config_.value_coefficient * value_loss;
  // Left out of the graph where it weighs nothing: its derivative (polygamma) costs more than the
  // network's.
  if (config_.entropy_coefficient > 0) loss = loss - config_.entropy_coefficient * entropy;
  if (share < 1) loss = loss * share;
  loss.backward();

  const torch::NoGradGuard no_grad;
  const auto part = [share](const torch::Tensor& mean) {
    return static_cast<float>(mean.item<double>() * share);
  };
  // (r - 1) - log r: unbiased and never negative (Schulman, "Approximating KL divergence", 2020).
  return {part((ratio - 1.0 - log_ratio).mean()), part(policy_loss), part(value_loss), part(entropy),
          part(((ratio - 1.0).abs() > clip).to(torch::kFloat32).mean())};
}

double Ppo::Step(const Rollout& rows, double share, PpoReport& report) {
  optimizer_.ZeroGradients();
  std::array<float, 5> figures{};
  if (share > 0) figures = Differentiate(rows, share, report.clip_range);
  optimizer_.SumGradients(ranks_, figures);
  report.gradient_norm += optimizer_.ClipGradients(config_.max_gradient_norm);
  SAND_CHECK(std::isfinite(report.gradient_norm), "a gradient is NaN", steps_);
  optimizer_.Step(report.learning_rate);

  const auto& [kl, policy_loss, value_loss, entropy, clip_fraction] = figures;
  report.approx_kl += kl;
  report.policy_loss += policy_loss;
  report.value_loss += value_loss;
  report.entropy += entropy;
  report.clip_fraction += clip_fraction;
  return kl;
}

int64_t Ppo::Learn(const Collected& collected, PpoReport& report) {
  const int64_t count = collected.advantage.size(0);
  // A remainder is spread over the minibatches: none is small, nothing is dropped.
  const int64_t minibatches = std::max<int64_t>(1, count / config_.minibatch_size);
  const auto first_of = [&](int64_t minibatch) { return minibatch * count / minibatches; };
  const bool adaptive = config_.learning_rate_schedule == "adaptive";
  int64_t gradient_steps = 0;
  bool moved_enough = false;
  for (int64_t epoch = 0; epoch < config_.epochs && !moved_enough; ++epoch, ++report.epochs) {
    const std::vector<int64_t> order = Permutation(count);
    const OwnRows own(order, env_.num_envs(), ranks_);
    const auto chosen = [&](const torch::Tensor& all, const std::vector<int64_t>& rows) {
      return all.index_select(0, torch::tensor(rows, torch::kInt64).to(device_));
    };
    Rollout shuffled =
        collected.rollout.Map([&](const torch::Tensor& t) { return chosen(t, own.row); });
    // By the statistics of whole minibatches, whichever ranks their rows are on.
    const auto advantage = chosen(collected.advantage, order);
    std::vector<torch::Tensor> normalized;
    for (int64_t i = 0; i < minibatches; ++i)
      normalized.push_back(NormalizedAdvantages(
          advantage.narrow(0, first_of(i), first_of(i + 1) - first_of(i)), report.advantage_floor));
    shuffled.advantage = chosen(torch::cat(normalized), own.position);
    for (int64_t i = 0; i < minibatches && !moved_enough; ++i, ++gradient_steps) {
      const int64_t begin = own.Before(first_of(i)), size = own.Before(first_of(i + 1)) - begin;
      const double share =
          static_cast<double>(size) / static_cast<double>(first_of(i + 1) - first_of(i));
      const double kl = Step(
          shuffled.Map([&](const torch::Tensor& t) { return t.narrow(0, begin, size); }), share,
          report);
      moved_enough = !adaptive && config_.target_kl > 0 && kl > 1.5 * config_.target_kl;
    }
  }
  return gradient_steps;
}

void Ppo::ShareEpisodes(PpoReport& report) {
  if (ranks_.size() == 1) return;
  nlohmann::json mine = {{"streams", StreamsToJson(OwnStreams())},
                         {"finished", EpisodesToJson(report.finished)}};
  auto streams = nlohmann::json::array();
  report.finished.clear();
  for (const std::string& text : GatherTexts(ranks_, mine.dump())) {
    const auto theirs = nlohmann::json::parse(text);
    std::ranges::move(EpisodesFromJson(theirs["finished"]), std::back_inserter(report.finished));
    for (const auto& stream : theirs["streams"]) streams.push_back(stream);
  }
  StreamsFromJson(streams, "another rank", action_streams_);
}

torch::Tensor Ppo::OfAllRanks(const torch::Tensor& numbers) {
  if (ranks_.size() == 1) return numbers;
  const auto mine = numbers.to(torch::kCPU).contiguous();
  const std::vector<float> all =
      GatherSteps(ranks_, {mine.data_ptr<float>(), static_cast<size_t>(mine.numel())},
                  static_cast<size_t>(env_.num_envs()), static_cast<size_t>(mine.size(1)));
  return torch::tensor(all).view({-1, mine.size(1)}).to(device_);
}

PpoReport Ppo::Update() {
  PpoReport report;
  auto start = Clock::now();
  const Collected collected = Collect(report);
  report.rollout_s = SecondsSince(start);
  start = Clock::now();
  const bool adaptive = config_.learning_rate_schedule == "adaptive";
  report.learning_rate =
      adaptive ? adapted_rate_
               : config_.learning_rate *
                     ShareLeft(config_.learning_rate_schedule, steps_, total_steps_);
  report.clip_range = config_.clip_range * ShareLeft(config_.clip_range_schedule, steps_, total_steps_);
  // Advantages are in the rewards' unit, which scaling has brought to the deviation.
  report.advantage_floor =
      config_.advantage_floor * (config_.scale_rewards ? 1.0 : return_scaler_.deviation());
  const auto gradient_steps = static_cast<double>(Learn(collected, report));
  for (double* mean : {&report.policy_loss, &report.value_loss, &report.entropy, &report.approx_kl,
                       &report.clip_fraction, &report.gradient_norm})
    *mean /= gradient_steps;
  steps_ += collected.advantage.size(0);
  if (adaptive) adapted_rate_ = AdaptedRate(adapted_rate_, report.approx_kl, config_.target_kl);
  // Only now: while the rollout was learnt from, observations had to look as when it was collected.
  network_.Observe({collected.rollout.observation.map, OfAllRanks(collected.rollout.observation.vec)});
  ShareEpisodes(report);
  report.update_s = SecondsSince(start);
  return report;
}

std::map<std::string, double> Ppo::Advance() {
  const int64_t before = steps_;
  const PpoReport report = Update();
  auto scalars = EpisodeScalars(report.finished);
  scalars.merge(std::map<std::string, double>{
      {"train/policy_loss", report.policy_loss},
      {"train/value_loss", report.value_loss},
      {"train/entropy", report.entropy},
      {"train/approx_kl", report.approx_kl},
      {"train/clip_fraction", report.clip_fraction},
      {"train/explained_variance", report.explained_variance},
      {"train/advantage_deviation", report.advantage_deviation},
      {"train/return_deviation", return_scaler_.deviation()},
      {"train/gradient_norm", report.gradient_norm},
      {"train/learning_rate", report.learning_rate},
      {"train/epochs", static_cast<double>(report.epochs)},
      {"time/fps",
       static_cast<double>(steps_ - before) / (report.rollout_s + report.update_s)},
      {"time/rollout_s", report.rollout_s},
      {"time/update_s", report.update_s}});
  return scalars;
}

void Ppo::Save(Safetensors& content) const {
  nlohmann::json state = {{"steps", steps_},
                          {"shuffle", StreamToJson(shuffle_stream_)},
                          {"returns", return_scaler_.ToJson()},
                          {"adapted_rate", adapted_rate_},
                          {"action", StreamsToJson(action_streams_)}};
  content.metadata["ppo_state"] = state.dump();
  SaveWeights(network_, "network.", content);
  optimizer_.Save("ppo", content);
}

void Ppo::Load(const Safetensors& content, const std::string& source) {
  const auto state = ParsedMetadata(content, "ppo_state", source);
  StreamsFromJson(state.at("action"), source, action_streams_);
  LoadWeights(content, "network.", source, network_);
  optimizer_.Load("ppo", content, source);
  steps_ = state.at("steps");
  shuffle_stream_ = StreamFromJson(state.at("shuffle"));
  return_scaler_.FromJson(state.at("returns"));
  adapted_rate_ = state.at("adapted_rate");
  RestartEpisodes();
}

}  // namespace sandwright
