#include "agents/n_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandwright {
namespace {

using ::testing::ElementsAre;

ObservationSpec OneNumber() {
  ObservationSpec spec;
  spec.numbers = {"time"};
  return spec;
}

// Environments whose observation is the time (the second's + 100), action -time, reward 1 for the first, 2 for the
// second; `end` of the first: 't' terminated, 'c' cut off, else '.'.
StepBatch StepAt(float time, char end) {
  return {.observation = {{}, {end == '.' ? time + 1 : 0, time + 101}},
          .final_observation = {{}, {end == '.' ? 0 : time + 1, 0}},
          .reward = {1, 2},
          .terminated = {static_cast<uint8_t>(end == 't'), 0},
          .truncated = {static_cast<uint8_t>(end == 'c'), 0},
          .finished = {}};
}

// Of the first environment alone, or of the second: observation, action, what followed, reward, discount.
std::vector<std::vector<float>> RowsOf(int64_t steps, const std::string& ends, bool second = false) {
  NStep n_step(OneNumber(), steps, 0.5);
  ReplayBuffer buffer(OneNumber(), 1, 100);
  for (size_t t = 0; t < ends.size(); ++t) {
    const auto time = static_cast<float>(t);
    n_step.Add({{}, {time, time + 100}}, std::vector{-time, -time - 100}, StepAt(time, ends[t]), buffer);
  }
  Safetensors content;
  buffer.Save(content);
  const auto& values = content.tensors.at("transitions").values;
  std::vector<std::vector<float>> rows;
  for (auto row = values.begin(); row != values.end(); row += 5)
    if ((*row >= 100) == second) rows.emplace_back(row, row + 5);
  return rows;
}

TEST(NStep, OneStepIsTheTransitionItself) {
  EXPECT_THAT(RowsOf(1, "..c"), ElementsAre(ElementsAre(0, 0, 1, 1, 0.5f), ElementsAre(1, -1, 2, 1, 0.5f),
                                            ElementsAre(2, -2, 3, 1, 0.5f)));
}

TEST(NStep, SumsDiscountedRewardsAndLooksAsFarAhead) {
  EXPECT_THAT(RowsOf(3, "....", true), ElementsAre(ElementsAre(100, -100, 103, 2 + 1 + 0.5f, 0.125f),
                                                   ElementsAre(101, -101, 104, 3.5f, 0.125f)));
}

TEST(NStep, AnEpisodesEndEndsAllThatIsOpen) {
  EXPECT_THAT(RowsOf(3, "...t"),
              ElementsAre(ElementsAre(0, 0, 3, 1.75f, 0.125f), ElementsAre(1, -1, 4, 1.75f, 0),
                          ElementsAre(2, -2, 4, 1.5f, 0), ElementsAre(3, -3, 4, 1, 0)));
  // Cut off from outside: what follows counts, after as many steps as there were.
  EXPECT_THAT(RowsOf(3, ".c."), ElementsAre(ElementsAre(0, 0, 2, 1.5f, 0.25f), ElementsAre(1, -1, 2, 1, 0.5f)));
}

}  // namespace
}  // namespace sandwright
