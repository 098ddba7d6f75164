#include "agents/group_gradient.h"

#include <algorithm>

#include "agents/stroke_trial.h"
#include "data/base/error.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kAdamEpsilon = 1e-5;
constexpr double kLeastDeviation = 1e-6;

torch::Tensor Standardised(const torch::Tensor& value) {
  return (value - value.mean(1, true)) / (value.std(1, false, true) + kLeastDeviation);
}

}  // namespace

torch::Tensor GroupAdvantages(const torch::Tensor& reward, double seek) {
  const auto standardised = Standardised(reward);
  return seek > 0 ? Standardised(torch::softmax(standardised / seek, 1)) : standardised;
}

GroupGradient::GroupGradient(ShapingEnv& env, const World& world, const EpisodeConfig& episode,
                             ActorCritic& network, const GroupConfig& config, int64_t total_steps,
                             uint64_t seed, torch::Device device)
    : env_(env),
      world_(world),
      episode_(episode),
      network_(network),
      config_(config),
      total_steps_(total_steps),
      seed_(seed),
      device_(device),
      optimizer_((network.to(device), network.parameters()), kAdamEpsilon),
      shuffle_stream_(seed, StreamId("group shuffle")) {
  for (int i = 0; i < env.num_envs(); ++i)
    streams_.emplace_back(seed, StreamId("group"), static_cast<uint64_t>(i));
  RestartEpisodes();
}

void GroupGradient::RestartEpisodes() {
  observation_ = env_.Reset(EpisodesSeed(seed_, steps_));
}

std::vector<float> GroupGradient::Rewards(const EpisodeState& state,
                                          std::span<const Action> actions) const {
  const StrokeTrial trial = TryStrokes(world_, episode_, state, actions);
  const double refused = RejectedReward(episode_.reward).total();
  std::vector<float> rewards;
  for (size_t i = 0; i < actions.size(); ++i) {
    const bool accepted =
        !world_.gate ||
        world_.gate->Check(trial.stroke[i], state.sensed.map(), GateSampling::kCoarse).accepted;
    rewards.push_back(static_cast<float>(accepted ? trial.reward[i] : refused));
  }
  return rewards;
}

std::map<std::string, double> GroupGradient::Advance() {
  const auto start = Clock::now();
  const auto group = static_cast<size_t>(config_.strokes);
  std::vector<EpisodeSummary> finished;
  std::vector<torch::Tensor> map, vec, action, log_prob, reward;
  for (int64_t t = 0; t < config_.num_steps; ++t) {
    const ObservationTensors observation = ToTensors(observation_, env_.observation_spec(), device_);
    const auto decision = network_.Sample(observation, streams_, static_cast<int>(group));
    const std::vector<Action> drawn = ActionsOf(decision.action);
    std::vector<Action> chosen = ActionsOf(network_.Mean(observation));
    std::vector<float> worth;
    for (size_t i = 0; i < chosen.size(); ++i) {
      const auto own = std::span(drawn).subspan(i * group, group);
      const std::vector<float> rewards = Rewards(env_.episodes()[i], own);
      worth.insert(worth.end(), rewards.begin(), rewards.end());
      if (streams_[i].Uniform() < config_.best_share)
        chosen[i] = own[static_cast<size_t>(std::ranges::max_element(rewards) - rewards.begin())];
    }
    map.push_back(observation.map.clone());
    vec.push_back(observation.vec.clone());
    action.push_back(decision.action.view({-1, config_.strokes, kActionSize}));
    log_prob.push_back(decision.log_prob.view({-1, config_.strokes}));
    reward.push_back(torch::tensor(worth).view({-1, config_.strokes}));
    StepBatch step = env_.Step(ValuesOf(chosen));
    CheckFinite(step);
    std::ranges::move(step.finished, std::back_inserter(finished));
    observation_ = std::move(step.observation);
  }
  const double rollout_s = SecondsSince(start);
  const auto rewards = torch::cat(reward);
  const Round round = {torch::cat(map), torch::cat(vec), torch::cat(action).to(device_),
                       torch::cat(log_prob).to(device_),
                       GroupAdvantages(rewards, config_.seek).to(device_)};
  Report sum;
  for (int64_t k = 0; k < config_.gradient_steps; ++k) {
    const Report report = Learn(round);
    sum.loss += report.loss;
    sum.kl += report.kl;
    sum.clip_fraction += report.clip_fraction;
    sum.entropy += report.entropy;
  }
  const auto made = config_.num_steps * env_.num_envs();
  steps_ += made;
  const auto updates = static_cast<double>(config_.gradient_steps);
  auto scalars = EpisodeScalars(finished);
  scalars.merge(std::map<std::string, double>{
      {"train/policy_loss", sum.loss / updates},
      {"train/approx_kl", sum.kl / updates},
      {"train/clip_fraction", sum.clip_fraction / updates},
      {"train/entropy", sum.entropy / updates},
      {"train/drawn_reward", rewards.mean().item<double>()},
      {"train/best_reward", std::get<0>(rewards.max(1)).mean().item<double>()},
      {"time/rollout_s", rollout_s},
      {"time/update_s", SecondsSince(start) - rollout_s},
      {"time/fps", static_cast<double>(made) / SecondsSince(start)}});
  return scalars;
}

GroupGradient::Report GroupGradient::Learn(const Round& round) {
  std::vector<int64_t> states(static_cast<size_t>(config_.minibatch_size));
  const auto count = static_cast<uint64_t>(round.map.size(0));
  for (int64_t& state : states) state = static_cast<int64_t>(shuffle_stream_.Index(count));
  const auto chosen = torch::tensor(states).to(device_);
  const auto of = [&](const torch::Tensor& part) { return part.index_select(0, chosen); };
  const auto terms =
      network_.Evaluate({of(round.map), of(round.vec)}, of(round.action).view({-1, kActionSize}));
  const auto log_ratio = terms.log_prob - of(round.log_prob).flatten();
  const auto ratio = log_ratio.exp(), advantage = of(round.advantage).flatten();
  const auto clipped = ratio.clamp(1 - config_.clip_range, 1 + config_.clip_range);
  const auto loss = -torch::min(ratio * advantage, clipped * advantage).mean();
  optimizer_.Descend(loss,
                     config_.learning_rate *
                         ShareLeft(config_.learning_rate_schedule, steps_, total_steps_),
                     config_.max_gradient_norm);
  const torch::NoGradGuard no_grad;
  return {loss.item<double>(), (ratio - 1 - log_ratio).mean().item<double>(),
          ((ratio - 1).abs() > config_.clip_range).to(torch::kFloat32).mean().item<double>(),
          terms.entropy.mean().item<double>()};
}

void GroupGradient::Save(Safetensors& content) const {
  const nlohmann::json state = {{"steps", steps_},
                                {"shuffle", StreamToJson(shuffle_stream_)},
                                {"streams", StreamsToJson(streams_)}};
  content.metadata["group_state"] = state.dump();
  SaveWeights(network_, "network.", content);
  optimizer_.Save("group", content);
}

void GroupGradient::Load(const Safetensors& content, const std::string& source) {
  const auto state = ParsedMetadata(content, "group_state", source);
  StreamsFromJson(state.at("streams"), source, streams_);
  LoadWeights(content, "network.", source, network_);
  optimizer_.Load("group", content, source);
  steps_ = state.at("steps");
  shuffle_stream_ = StreamFromJson(state.at("shuffle"));
  RestartEpisodes();
}

}  // namespace sandwright
