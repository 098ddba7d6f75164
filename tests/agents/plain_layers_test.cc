#include "agents/plain_layers.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "agents/networks.h"

namespace sandwright {
namespace {

constexpr int kRows = 64;  // so many at once are sampled by torch, eight of them without it

// What is sampled of the rows begin...end, each with a stream of its own.
ActorCritic::Decision Sampled(ActorCritic& network, const torch::Tensor& rows, int begin, int end) {
  std::vector<RandomStream> streams;
  for (int i = begin; i < end; ++i) streams.emplace_back(5, 0, static_cast<uint64_t>(i));
  return network.Sample({torch::empty({end - begin, 0, 0, 0}), rows.slice(0, begin, end)}, streams);
}

// A network of seven inputs far from its first weights, its normaliser included.
std::unique_ptr<ActorCritic> SomeNetwork(int action_size, int choices) {
  torch::manual_seed(0);
  torch::set_num_threads(1);
  ObservationSpec spec;
  spec.numbers.assign(7, "number");
  RandomStream stream(1);
  auto network = std::make_unique<ActorCritic>(
      spec, action_size, NetworkConfig{.hidden = 64, .normalize = true}, stream, choices);
  network->Observe({{}, 3.0 * torch::randn({500, 7}) + 1.0});
  const torch::NoGradGuard no_grad;
  for (auto& p : network->parameters()) p.add_(0.2 * torch::randn_like(p));
  return network;
}

void ExpectTorchAgrees(ActorCritic& network) {
  const auto rows = 3.0 * torch::randn({kRows, 7}) + 1.0;
  const auto torchs = Sampled(network, rows, 0, kRows);
  EXPECT_GT(torchs.action.std().item<float>(), 0.1);
  for (int begin = 0; begin < kRows; begin += 8) {
    const auto plain = Sampled(network, rows, begin, begin + 8);
    const auto part = [&](const torch::Tensor& t) { return t.slice(0, begin, begin + 8); };
    EXPECT_TRUE(torch::allclose(plain.action, part(torchs.action), 1e-6, 1e-6));
    EXPECT_TRUE(torch::allclose(plain.value, part(torchs.value), 1e-6, 1e-6));
    // A sum of terms of up to 10 in float on torch's side.
    EXPECT_TRUE(torch::allclose(plain.log_prob, part(torchs.log_prob), 1e-6, 1e-5));
  }
}

TEST(PlainLayers, AgreeWithTorchOnNumbers) { ExpectTorchAgrees(*SomeNetwork(6, 0)); }
TEST(PlainLayers, AgreeWithTorchOnChoices) { ExpectTorchAgrees(*SomeNetwork(1, 5)); }

TEST(PlainLayers, ARowDoesNotDependOnItsNeighbours) {
  const auto network = SomeNetwork(6, 0);
  const auto rows = torch::randn({8, 7});
  const auto together = Sampled(*network, rows, 0, 8);
  for (int i = 0; i < 8; ++i) {
    const auto alone = Sampled(*network, rows, i, i + 1);
    EXPECT_TRUE(torch::equal(alone.action, together.action.slice(0, i, i + 1)));
    EXPECT_TRUE(torch::equal(alone.log_prob, together.log_prob.slice(0, i, i + 1)));
    EXPECT_TRUE(torch::equal(alone.value, together.value.slice(0, i, i + 1)));
  }
}

}  // namespace
}  // namespace sandwright
