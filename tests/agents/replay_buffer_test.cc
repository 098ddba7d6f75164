#include "agents/replay_buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Three environments: one goes on, one terminates, one is truncated.
StepBatch ThreeEnds() {
  return {.observation = {{}, {10, 11, 12}},
          .final_observation = {{}, {0, 21, 22}},
          .reward = {1, 2, 3},
          .terminated = {0, 1, 0},
          .truncated = {0, 0, 1},
          .finished = {}};
}

ReplayBuffer Filled(int64_t capacity) {
  ReplayBuffer buffer(1, 1, capacity);
  buffer.Add({{}, {1, 2, 3}}, std::vector<float>{0.1f, 0.2f, 0.3f}, ThreeEnds());
  return buffer;
}

std::vector<float> Rows(const ReplayBuffer& buffer) {
  Safetensors content;
  buffer.Save(content);
  return content.tensors.at("replay").values;
}

TEST(ReplayBuffer, KeepsTheEpisodesOwnLastObservationAndMarksTerminationOnly) {
  // Observation, action, what followed, reward, 1 where it goes on.
  EXPECT_THAT(Rows(Filled(10)), ElementsAre(1, 0.1f, 10, 1, 1,   //
                                            2, 0.2f, 21, 2, 0,   //
                                            3, 0.3f, 22, 3, 1));
}

TEST(ReplayBuffer, TheOldestIsOverwritten) {
  ReplayBuffer buffer = Filled(4);
  buffer.Add({{}, {4, 5, 6}}, std::vector<float>{0.4f, 0.5f, 0.6f}, ThreeEnds());
  EXPECT_EQ(buffer.size(), 4);
  EXPECT_THAT(Rows(buffer), ElementsAre(5, 0.5f, 21, 2, 0,   //
                                        6, 0.6f, 22, 3, 1,   //
                                        3, 0.3f, 22, 3, 1,   //
                                        4, 0.4f, 10, 1, 1));
}

TEST(ReplayBuffer, DrawsWholeRowsEvenly) {
  const ReplayBuffer buffer = Filled(10);
  RandomStream stream(1);
  constexpr int kDraws = 3000;
  const Transitions drawn = buffer.Sample(kDraws, stream, torch::kCPU);
  constexpr std::array<float, 3> kAfter = {10, 21, 22};
  std::array<int, 3> counts{};
  for (int i = 0; i < kDraws; ++i) {
    const auto at = [&](const torch::Tensor& t) { return t[i][0].item<float>(); };
    const auto row = static_cast<size_t>(at(drawn.observation)) - 1;
    ++counts.at(row);
    EXPECT_EQ(at(drawn.reward), at(drawn.observation));
    EXPECT_EQ(at(drawn.action), 0.1f * at(drawn.observation));
    EXPECT_EQ(at(drawn.next_observation), kAfter[row]);
    EXPECT_EQ(at(drawn.goes_on), row == 1 ? 0 : 1);
  }
  for (const int count : counts) EXPECT_NEAR(count, kDraws / 3, 4 * std::sqrt(kDraws * 2 / 9.0));
}

TEST(ReplayBuffer, SavedAndLoadedGoesOnAlike) {
  ReplayBuffer first = Filled(4), second(1, 1, 4);
  Safetensors content;
  first.Save(content);
  second.Load(content, "file");
  for (ReplayBuffer* buffer : {&first, &second})
    buffer->Add({{}, {4, 5, 6}}, std::vector<float>{0.4f, 0.5f, 0.6f}, ThreeEnds());
  EXPECT_EQ(Rows(first), Rows(second));
}

TEST(ReplayBuffer, ForeignRowsAreRefused) {
  Safetensors content;
  Filled(10).Save(content);
  ReplayBuffer wider(2, 1, 10), smaller(1, 1, 2);
  EXPECT_THAT([&] { wider.Load(content, "file"); },
              ThrowsMessage<Error>(HasSubstr("file: the replay buffer belongs to another task")));
  EXPECT_THAT([&] { smaller.Load(content, "file"); },
              ThrowsMessage<Error>(HasSubstr("holds 3 transitions; allowed by buffer_size: 2")));
  content.metadata["replay.next"] = "7";
  ReplayBuffer same(1, 1, 10);
  EXPECT_THAT([&] { same.Load(content, "file"); }, ThrowsMessage<Error>(HasSubstr("cursor")));
  EXPECT_EQ(same.size(), 0);
}

}  // namespace
}  // namespace sandwright
