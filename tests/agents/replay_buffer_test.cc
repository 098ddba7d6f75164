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

ObservationSpec TwoNumbers() {
  ObservationSpec spec;
  spec.channels = {"height"};
  spec.rows = spec.columns = 1;
  spec.numbers = {"left"};
  return spec;
}

// Rows 1, 2, 3 ...: their observation (a map of one cell and a number), action, what followed, reward, discount.
void AddRows(ReplayBuffer& buffer, std::initializer_list<int> rows) {
  for (const int row : rows) {
    const auto r = static_cast<float>(row);
    buffer.Add(std::vector{r, -r}, std::vector{0.1f * r}, std::vector{10 + r, -10 - r}, 100 + r,
               row == 2 ? 0.0f : 0.9f);
  }
}

ReplayBuffer Filled(int64_t capacity) {
  ReplayBuffer buffer(TwoNumbers(), 1, capacity);
  AddRows(buffer, {1, 2, 3});
  return buffer;
}

std::vector<float> Rows(const ReplayBuffer& buffer) {
  Safetensors content;
  buffer.Save(content);
  return content.tensors.at("transitions").values;
}

TEST(ReplayBuffer, TheOldestIsOverwritten) {
  ReplayBuffer buffer = Filled(4);
  AddRows(buffer, {4, 5, 6});
  EXPECT_EQ(buffer.size(), 4);
  EXPECT_THAT(Rows(buffer), ElementsAre(5, -5, 0.5f, 15, -15, 105, 0.9f,    //
                                        6, -6, 0.6f, 16, -16, 106, 0.9f,    //
                                        3, -3, 0.1f * 3, 13, -13, 103, 0.9f,  //
                                        4, -4, 0.4f, 14, -14, 104, 0.9f));
}

TEST(ReplayBuffer, DrawsWholeRowsEvenly) {
  const ReplayBuffer buffer = Filled(10);
  RandomStream stream(1);
  constexpr int kDraws = 3000;
  const Transitions drawn = buffer.Sample(kDraws, stream, torch::kCPU);
  std::array<int, 3> counts{};
  for (int i = 0; i < kDraws; ++i) {
    const auto at = [&](const torch::Tensor& t) { return t[i].item<float>(); };
    const float row = at(drawn.observation.map);
    ++counts.at(static_cast<size_t>(row) - 1);
    EXPECT_EQ(at(drawn.observation.vec), -row);
    EXPECT_EQ(at(drawn.action), 0.1f * row);
    EXPECT_EQ(at(drawn.next_observation.map), 10 + row);
    EXPECT_EQ(at(drawn.next_observation.vec), -10 - row);
    EXPECT_EQ(at(drawn.reward), 100 + row);
    EXPECT_EQ(at(drawn.discount), row == 2 ? 0.0f : 0.9f);
  }
  EXPECT_EQ(drawn.observation.map.sizes(), (std::vector<int64_t>{kDraws, 1, 1, 1}));
  for (const int count : counts) EXPECT_NEAR(count, kDraws / 3, 4 * std::sqrt(kDraws * 2 / 9.0));
}

TEST(ReplayBuffer, SavedAndLoadedGoesOnAlike) {
  ReplayBuffer first = Filled(4), second(TwoNumbers(), 1, 4);
  Safetensors content;
  first.Save(content);
  second.Load(content, "file");
  for (ReplayBuffer* buffer : {&first, &second}) AddRows(*buffer, {4, 5, 6});
  EXPECT_EQ(Rows(first), Rows(second));
}

TEST(ReplayBuffer, ForeignRowsAreRefused) {
  Safetensors content;
  Filled(10).Save(content);
  ReplayBuffer wider(TwoNumbers(), 2, 10), smaller(TwoNumbers(), 1, 2);
  EXPECT_THAT([&] { wider.Load(content, "file"); },
              ThrowsMessage<Error>(HasSubstr("file: the rows of transitions are of another task")));
  EXPECT_THAT([&] { smaller.Load(content, "file"); },
              ThrowsMessage<Error>(HasSubstr("transitions has 3 rows; allowed by buffer_size: 2")));
  content.metadata["transitions.next"] = "7";
  ReplayBuffer same(TwoNumbers(), 1, 10);
  EXPECT_THAT([&] { same.Load(content, "file"); }, ThrowsMessage<Error>(HasSubstr("cursor")));
  EXPECT_EQ(same.size(), 0);
}

}  // namespace
}  // namespace sandwright
