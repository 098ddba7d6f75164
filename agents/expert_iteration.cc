#include "agents/expert_iteration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "agents/refine.h"
#include "agents/stroke_proposal.h"
#include "agents/stroke_trial.h"
#include "agents/symmetry.h"
#include "data/base/error.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kAdamEpsilon = 1e-8;
constexpr double kSurplusShare = 0.8;  // of the strokes that are not the policy's

}  // namespace

ExpertIteration::ExpertIteration(ShapingEnv& env, const World& world, const EpisodeConfig& episode,
                                 ActorCritic& network, const ExpertConfig& config,
                                 int64_t total_steps, uint64_t seed, torch::Device device)
    : env_(env),
      world_(world),
      episode_(episode),
      network_(network),
      config_(config),
      total_steps_(total_steps),
      seed_(seed),
      device_(device),
      optimizer_((network.to(device), network.parameters()), kAdamEpsilon),
      shuffle_stream_(seed, StreamId("expert shuffle")),
      buffer_(env.observation_spec(), config.keep, config.buffer_size) {
  for (int i = 0; i < env.num_envs(); ++i)
    streams_.emplace_back(seed, StreamId("expert"), static_cast<uint64_t>(i));
  RestartEpisodes();
}

void ExpertIteration::RestartEpisodes() {
  observation_ = env_.Reset(EpisodesSeed(seed_, steps_));
}

void ExpertIteration::Try(const EpisodeState& state, std::span<const Action> candidates,
                          Advice& advice) {
  const auto [strokes, reward] = TryStrokes(world_, episode_, state, candidates);
  std::vector<size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](size_t i) { return reward[i]; });
  for (const size_t i : order) {  // best first, so that few meet the gate
    const bool full = std::ssize(advice.reward) == config_.keep;
    if (full && reward[i] <= advice.reward.back()) break;
    if (world_.gate && !world_.gate->Check(strokes[i], state.sensed.map(), GateSampling::kCoarse).accepted)
      continue;
    if (full) advice.reward.pop_back(), advice.action.pop_back();
    const auto at = std::ranges::upper_bound(advice.reward, reward[i], std::greater{}) -
                    advice.reward.begin();
    advice.reward.insert(advice.reward.begin() + at, reward[i]);
    advice.action.insert(advice.action.begin() + at, candidates[i]);
  }
}

ExpertIteration::Advice ExpertIteration::Ask(const EpisodeState& state,
                                             std::span<const Action> from_policy,
                                             RandomStream& stream) {
  const auto refined = static_cast<size_t>(config_.refine_share *
                                           static_cast<double>(config_.evaluations));
  std::vector<Action> candidates(from_policy.begin(), from_policy.end());
  const StrokeProposal proposal(View(state), kSurplusShare);
  while (candidates.size() + refined < static_cast<size_t>(config_.evaluations))
    candidates.push_back(proposal.Draw(stream));
  Advice advice;
  Try(state, candidates, advice);
  if (advice.action.empty()) return advice;
  candidates.clear();
  while (candidates.size() < refined) candidates.push_back(ActionNear(advice.action.front(), stream));
  Try(state, candidates, advice);
  return advice;
}

std::map<std::string, double> ExpertIteration::Advance() {
  const ObservationSpec& spec = env_.observation_spec();
  const auto map_size = static_cast<size_t>(spec.map_size()),
             vec_size = static_cast<size_t>(spec.vec_size());
  const auto from_policy = std::max(
      1, static_cast<int>(config_.policy_share * static_cast<double>(config_.evaluations)));
  const auto start = Clock::now();
  std::vector<EpisodeSummary> finished;
  double best_reward = 0;
  int64_t asked = 0;
  for (int64_t t = 0; t < config_.num_steps; ++t) {
    const ObservationTensors observation = ToTensors(observation_, spec, device_);
    const auto drawn = ActionsOf(network_.Sample(observation, streams_, from_policy).action);
    std::vector<Action> chosen = ActionsOf(network_.Mean(observation));
    for (size_t i = 0; i < chosen.size(); ++i) {
      const auto own = std::span(drawn).subspan(i * static_cast<size_t>(from_policy),
                                                static_cast<size_t>(from_policy));
      const Advice advice = Ask(env_.episodes()[i], own, streams_[i]);
      if (advice.action.empty()) continue;
      std::vector<double> weights;
      for (const double reward : advice.reward)
        weights.push_back(std::exp((reward - advice.reward.front()) / config_.temperature));
      buffer_.Add(std::span(observation_.map).subspan(i * map_size, map_size),
                  std::span(observation_.vec).subspan(i * vec_size, vec_size), advice.action,
                  weights);
      best_reward += advice.reward.front();
      ++asked;
      if (streams_[i].Uniform() < config_.expert_share) chosen[i] = advice.action.front();
    }
    StepBatch step = env_.Step(ValuesOf(chosen));
    CheckFinite(step);
    std::ranges::move(step.finished, std::back_inserter(finished));
    observation_ = std::move(step.observation);
  }
  const double rollout_s = SecondsSince(start);
  double loss = 0;
  for (int64_t k = 0; k < config_.gradient_steps; ++k) loss += Learn();
  const auto made = config_.num_steps * env_.num_envs();
  steps_ += made;
  auto scalars = EpisodeScalars(finished);
  scalars.merge(std::map<std::string, double>{
      {"train/loss", loss / static_cast<double>(config_.gradient_steps)},
      {"train/expert_reward", best_reward / static_cast<double>(std::max<int64_t>(asked, 1))},
      {"time/rollout_s", rollout_s},
      {"time/update_s", SecondsSince(start) - rollout_s},
      {"time/fps", static_cast<double>(made) / SecondsSince(start)}});
  return scalars;
}

double ExpertIteration::Learn() {
  AdviceBuffer::Examples examples = buffer_.Sample(config_.minibatch_size, shuffle_stream_);
  if (config_.symmetry) {
    const int symmetries = SymmetriesOf(env_.observation_spec(), env_.episodes()[0].region);
    const auto symmetry =
        static_cast<int>(shuffle_stream_.Index(static_cast<uint64_t>(symmetries)));
    examples.observation.map = Transformed(examples.observation.map, symmetry);
    examples.action = TransformedAction(examples.action, symmetry);
  }
  const auto terms = network_.Evaluate(
      {examples.observation.map.to(device_), examples.observation.vec.to(device_)},
      examples.action.to(device_));
  const auto loss = -terms.log_prob.mean();
  optimizer_.Descend(loss,
                     config_.learning_rate *
                         ShareLeft(config_.learning_rate_schedule, steps_, total_steps_),
                     config_.max_gradient_norm);
  return loss.item<double>();
}

void ExpertIteration::Save(Safetensors& content) const {
  const nlohmann::json state = {{"steps", steps_},
                          {"shuffle", StreamToJson(shuffle_stream_)},
                          {"streams", StreamsToJson(streams_)}};
  content.metadata["expert_state"] = state.dump();
  SaveWeights(network_, "network.", content);
  optimizer_.Save("expert", content);
  buffer_.Save(content);
}

void ExpertIteration::Load(const Safetensors& content, const std::string& source) {
  const auto state = ParsedMetadata(content, "expert_state", source);
  StreamsFromJson(state.at("streams"), source, streams_);
  LoadWeights(content, "network.", source, network_);
  optimizer_.Load("expert", content, source);
  buffer_.Load(content, source);
  steps_ = state.at("steps");
  shuffle_stream_ = StreamFromJson(state.at("shuffle"));
  RestartEpisodes();
}

}  // namespace sandwright
