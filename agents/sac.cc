#include "agents/sac.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "agents/colored_noise.h"
#include "agents/symmetry.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kAdamEpsilon = 1e-8;
constexpr int64_t kStretch = 250;      // rounds between two rows of the log
constexpr int64_t kNoiseLength = 1024;  // steps of one series of coloured noise
constexpr const char* kState = "sac_state";

const ObservationSpec& CheckedSpec(const VecEnv& env) {
  if (env.choices() > 0)
    throw Error(fmt::format(
        "SAC and TQC act by numbers, this task by one of {} choices; allowed here: algorithm = ppo",
        env.choices()));
  return env.observation_spec();
}

}  // namespace

CriticRule TwinCritics() {
  const auto least = [](const torch::Tensor& q) { return std::get<0>(q.min(0)); };
  return {.critics = 2,
          .outputs = 1,
          .next_value = least,
          // Equation 5, summed over both.
          .loss = [](const torch::Tensor& q,
                     const torch::Tensor& target) { return 0.5 * (q - target).square().sum(0).mean(); },
          .value = [least](const torch::Tensor& q) { return least(q).squeeze(-1); }};
}

Sac::Sac(VecEnv& env, const SacConfig& config, CriticRule rule, uint64_t seed, torch::Device device,
         int symmetries)
    : env_(env),
      config_(config),
      rule_(std::move(rule)),
      seed_(seed),
      device_(device),
      symmetries_(symmetries),
      initial_stream_(seed, StreamId("initial weights")),
      replay_stream_(seed, StreamId("sac replay")),
      policy_stream_(seed, StreamId("sac policy")),
      encoder_(std::make_shared<MapEncoder>(CheckedSpec(env), config.network.channels,
                                            config.network.features, initial_stream_)),
      actor_(encoder_, env.action_size(), config.network.hidden, initial_stream_),
      critics_(encoder_, rule_.critics, env.action_size(), config.network.hidden, rule_.outputs,
               initial_stream_),
      targets_(std::make_shared<MapEncoder>(env.observation_spec(), config.network.channels,
                                            config.network.features, initial_stream_),
               rule_.critics, env.action_size(), config.network.hidden, rule_.outputs,
               initial_stream_),
      log_temperature_(torch::zeros({1}, device).requires_grad_()),
      actor_adam_((actor_.to(device), actor_.OwnParameters()), kAdamEpsilon),
      critic_adam_((critics_.to(device), critics_.parameters()), kAdamEpsilon),
      temperature_adam_({log_temperature_}, kAdamEpsilon),
      n_step_(env.observation_spec(), config.n_step, config.gamma),
      replay_(env.observation_spec(), env.action_size(), config.buffer_size) {
  targets_.to(device);
  MoveTargets(1);
  RestartEpisodes();
}

void Sac::RestartEpisodes() {
  observation_ = env_.Reset(EpisodesSeed(seed_, steps()));
  n_step_.Forget();
  const uint64_t noise_seed =
      RandomStream(seed_, StreamId("sac noise"), static_cast<uint64_t>(steps())).Next64();
  noises_.clear();
  for (int i = 0; i < env_.num_envs(); ++i) {
    noises_.push_back({RandomStream(noise_seed, 0, static_cast<uint64_t>(i)), {}, 0});
    Renew(noises_.back());
  }
}

void Sac::Renew(Noise& noise) const {
  noise.series.clear();
  for (int i = 0; i < env_.action_size(); ++i)
    noise.series.push_back(ColoredNoise(kNoiseLength, config_.noise_color, noise.stream));
  noise.used = 0;
}

double Sac::temperature() const {
  return config_.temperature > 0 ? config_.temperature
                                 : std::exp(log_temperature_.item<double>());
}

torch::Tensor Sac::Explore() {
  const torch::NoGradGuard no_grad;
  const int64_t envs = env_.num_envs(), size = env_.action_size();
  auto noise = torch::empty({envs, size});
  for (int64_t i = 0; i < envs; ++i) {
    Noise& own = noises_[static_cast<size_t>(i)];
    if (own.used == kNoiseLength) Renew(own);
    for (int64_t j = 0; j < size; ++j)
      noise.data_ptr<float>()[i * size + j] = own.series[static_cast<size_t>(j)][own.used];
    ++own.used;
  }
  // The normal distribution's integral makes normal noise, of any colour, uniform.
  if (steps() < config_.random_steps) return torch::erf(noise * std::sqrt(0.5));
  const auto seen = ToTensors(observation_, env_.observation_spec(), device_);
  const auto p = actor_.Distribution(actor_.Features(seen));
  return Squash(p, noise.to(device_)).action.to(torch::kCPU).contiguous();
}

Transitions Sac::Replay() {
  Transitions batch = replay_.Sample(config_.batch_size, replay_stream_, device_);
  if (symmetries_ == 1) return batch;
  const auto symmetry = static_cast<int>(replay_stream_.Index(static_cast<uint64_t>(symmetries_)));
  for (auto* seen : {&batch.observation, &batch.next_observation})
    seen->map = Transformed(seen->map, symmetry);
  batch.action = TransformedAction(batch.action, symmetry);
  return batch;
}

SquashedDraw Sac::DrawFresh(const torch::Tensor& features) {
  auto noise = torch::empty({features.size(0), env_.action_size()});
  for (int64_t i = 0; i < noise.numel(); ++i)
    noise.data_ptr<float>()[i] = static_cast<float>(policy_stream_.Normal());
  return Squash(actor_.Distribution(features), noise.to(device_));
}

void Sac::MoveTargets(double share) {
  const torch::NoGradGuard no_grad;
  const auto from = critics_.parameters(), to = targets_.parameters();
  for (size_t i = 0; i < to.size(); ++i) to[i].lerp_(from[i], share);
}

void Sac::GradientStep(Sums& sums) {
  const Transitions batch = Replay();
  const double alpha = temperature();

  // Equations 5 and 6: the critics, towards reward and the soft value of what follows.
  torch::Tensor target;
  {
    const torch::NoGradGuard no_grad;
    const SquashedDraw next = DrawFresh(actor_.Features(batch.next_observation));
    const auto q = targets_.Forward(batch.next_observation, next.action);
    const auto soft = rule_.next_value(q) - alpha * next.log_prob.unsqueeze(1);
    target = batch.reward + batch.discount * soft;
  }
  const auto q = critics_.Forward(batch.observation, batch.action);
  const auto critic_loss = rule_.loss(q, target);
  critic_adam_.ZeroGradients();
  critic_loss.backward();
  critic_adam_.Step(config_.learning_rate);

  // Equation 9: the actor.
  const auto features = actor_.Features(batch.observation);
  const SquashedDraw draw = DrawFresh(features);
  const auto value = rule_.value(critics_.ForwardFrozen(features, draw.action));
  const auto actor_loss = (alpha * draw.log_prob - value).mean();
  actor_adam_.ZeroGradients();
  actor_loss.backward();
  actor_adam_.Step(config_.learning_rate);

  const torch::NoGradGuard no_grad;
  const double entropy = -draw.log_prob.mean().item<double>();
  if (config_.temperature == 0) {
    // Equation 18, by the logarithm of the temperature, for an entropy of -dim(A).
    log_temperature_.mutable_grad().fill_(entropy + env_.action_size());
    temperature_adam_.Step(config_.learning_rate);
  }
  MoveTargets(config_.target_share);

  sums.critic_loss += critic_loss.item<double>();
  sums.actor_loss += actor_loss.item<double>();
  sums.entropy += entropy;
  SAND_CHECK(std::isfinite(sums.critic_loss) && std::isfinite(sums.actor_loss), "a loss is NaN",
             steps());
  ++sums.gradient_steps;
}

std::map<std::string, double> Sac::Advance() {
  const auto start = Clock::now();
  Sums sums;
  std::vector<EpisodeSummary> finished;
  for (int64_t round = 0; round < kStretch; ++round) {
    const auto action = Explore();
    const std::span<const float> action_na(action.data_ptr<float>(),
                                           static_cast<size_t>(action.numel()));
    StepBatch step = env_.Step(action_na);
    CheckFinite(step);
    n_step_.Add(observation_, action_na, step, replay_);
    for (size_t i = 0; i < noises_.size(); ++i)
      if (step.terminated[i] || step.truncated[i]) Renew(noises_[i]);
    std::ranges::move(step.finished, std::back_inserter(finished));
    observation_ = std::move(step.observation);
    ++rounds_;
    if (steps() < config_.random_steps || rounds_ % config_.train_every != 0) continue;
    for (int64_t i = 0; i < config_.gradient_steps; ++i) GradientStep(sums);
  }
  auto scalars = EpisodeScalars(finished);
  scalars["time/fps"] = static_cast<double>(kStretch * env_.num_envs()) / SecondsSince(start);
  if (sums.gradient_steps == 0) return scalars;
  const auto count = static_cast<double>(sums.gradient_steps);
  scalars["train/critic_loss"] = sums.critic_loss / count;
  scalars["train/actor_loss"] = sums.actor_loss / count;
  scalars["train/entropy"] = sums.entropy / count;
  scalars["train/ent_coef"] = temperature();
  scalars["train/learning_rate"] = config_.learning_rate;
  return scalars;
}

void Sac::Save(Safetensors& content) const {
  const nlohmann::json state = {{"rounds", rounds_},
                                {"environments", env_.num_envs()},
                                {"replay", StreamToJson(replay_stream_)},
                                {"policy", StreamToJson(policy_stream_)}};
  content.metadata[kState] = state.dump();
  SaveWeights(actor_, "network.", content);
  SaveWeights(critics_, "critics.", content);
  SaveWeights(targets_, "targets.", content);
  content.tensors["log_temperature"] = {{1}, {log_temperature_.item<float>()}};
  actor_adam_.Save("actor_adam", content);
  critic_adam_.Save("critic_adam", content);
  temperature_adam_.Save("temperature_adam", content);
  replay_.Save(content);
}

void Sac::Load(const Safetensors& content, const std::string& source) {
  const auto state = ParsedMetadata(content, kState, source);
  if (state.at("environments") != env_.num_envs())
    throw Error(fmt::format("{}: saved with another number of environments ({} instead of {})",
                            source, state.at("environments").dump(), env_.num_envs()));
  LoadWeights(content, "network.", source, actor_);
  LoadWeights(content, "critics.", source, critics_);
  LoadWeights(content, "targets.", source, targets_);
  actor_adam_.Load("actor_adam", content, source);
  critic_adam_.Load("critic_adam", content, source);
  temperature_adam_.Load("temperature_adam", content, source);
  replay_.Load(content, source);
  {
    const torch::NoGradGuard no_grad;
    log_temperature_.fill_(content.Tensor("log_temperature", source).values.at(0));
  }
  rounds_ = state.at("rounds");
  replay_stream_ = StreamFromJson(state.at("replay"));
  policy_stream_ = StreamFromJson(state.at("policy"));
  RestartEpisodes();
}

}  // namespace sandwright
