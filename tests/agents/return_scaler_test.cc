#include "agents/return_scaler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;

// Two environments and gamma 0.5: the sums of the first are 1, 2.5, then 2 after its end, those of
// the second 3, 1.5, 4.75. Mean 2.4583, squared distances to it 8.8021.
const std::vector<float> kReward = {1, 3, 2, 0, 2, 4};
const std::vector<uint8_t> kEnd = {0, 0, 1, 0, 0, 0};
const double kDeviation = std::sqrt(8.80208333 / 6);

TEST(ReturnScaler, HandNumbers) {
  ReturnScaler scaler(2, 0.5);
  EXPECT_EQ(scaler.deviation(), 1.0);
  scaler.Observe(kReward, kEnd);
  EXPECT_NEAR(scaler.deviation(), kDeviation, 1e-7);
  std::vector<float> reward = {1, -2, 1e6f};
  scaler.Scale(reward);
  EXPECT_THAT(reward, ElementsAre(FloatNear(static_cast<float>(1 / kDeviation), 1e-6f),
                                  FloatNear(static_cast<float>(-2 / kDeviation), 1e-6f), 10.0f));
}

TEST(ReturnScaler, PartsEqualTheWholeAndAreSavedExactly) {
  ReturnScaler parts(2, 0.5), resumed(2, 0.5);
  parts.Observe(std::span(kReward).first(4), std::span(kEnd).first(4));
  parts.Observe(std::span(kReward).last(2), std::span(kEnd).last(2));
  EXPECT_NEAR(parts.deviation(), kDeviation, 1e-7);
  parts.RestartEpisodes();
  resumed.FromJson(nlohmann::json::parse(parts.ToJson().dump()));
  for (ReturnScaler* scaler : {&parts, &resumed}) scaler->Observe(kReward, kEnd);
  EXPECT_EQ(parts.deviation(), resumed.deviation());
}

}  // namespace
}  // namespace sandwright
