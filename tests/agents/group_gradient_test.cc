#include "agents/group_gradient.h"

#include <gtest/gtest.h>

namespace sandwright {
namespace {

const auto kReward = torch::tensor({{0.1, 0.4, -2.0, 0.3}, {5.0, 5.0, 5.0, 5.0}}, torch::kFloat64);

TEST(GroupAdvantages, AreOfTheGroupAlone) {
  for (const double seek : {0.0, 0.5}) {
    const auto advantage = GroupAdvantages(kReward, seek);
    EXPECT_TRUE(torch::allclose(advantage.mean(1), torch::zeros({2}, torch::kFloat64)));
    EXPECT_NEAR(advantage[0].std(0, false).item<double>(), 1.0, 1e-4);
    EXPECT_TRUE(torch::equal(advantage[1], torch::zeros({4}, torch::kFloat64))) << "nothing to choose";
    const auto other_unit = GroupAdvantages(1000.0 * kReward + 3.0, seek);
    EXPECT_TRUE(torch::allclose(other_unit[0], advantage[0], 1e-4, 1e-4)) << seek;
  }
}

TEST(GroupAdvantages, SeekingLooksAtTheBest) {
  const auto plain = GroupAdvantages(kReward, 0)[0], seeking = GroupAdvantages(kReward, 0.2)[0];
  // One bad stroke of four makes the other three good, plainly; of these seeking tells the best.
  EXPECT_GT(plain[0].item<double>(), 0);
  EXPECT_LT(seeking[0].item<double>(), 0);
  EXPECT_EQ(seeking.argmax().item<int64_t>(), 1);
  EXPECT_GT(seeking[1].item<double>(), plain[1].item<double>());
}

}  // namespace
}  // namespace sandwright
