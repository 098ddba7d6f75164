#include "env/rank_correlation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace sandwright {
namespace {

TEST(SpearmanCorrelation, OnlyTheOrderCounts) {
  const std::vector<double> a = {1, 2, 3, 4}, b = {0.1, 7, 8, 900}, back = {4, 3, 2, 1};
  EXPECT_DOUBLE_EQ(SpearmanCorrelation(a, b).value(), 1);
  EXPECT_DOUBLE_EQ(SpearmanCorrelation(a, back).value(), -1);
}

// By hand: squared rank differences 0, 1, 1, 0, 0, so 1 - 6 * 2 / (5 * 24).
TEST(SpearmanCorrelation, HandNumbersAndTies) {
  const std::vector<double> a = {10, 20, 30, 40, 50}, b = {1, 3, 2, 4, 5};
  EXPECT_NEAR(SpearmanCorrelation(a, b).value(), 0.9, 1e-12);
  // Ranks 0, 1.5, 1.5, 3 against 0..3: 4.5 / sqrt(4.5 * 5).
  const std::vector<double> tied = {1, 2, 2, 3}, order = {1, 2, 3, 4};
  EXPECT_NEAR(SpearmanCorrelation(tied, order).value(), 4.5 / std::sqrt(22.5), 1e-12);
}

TEST(SpearmanCorrelation, NoneWhereNothingVaries) {
  const std::vector<double> flat = {1, 1, 1}, some = {1, 2, 3}, one = {1};
  EXPECT_FALSE(SpearmanCorrelation(flat, some).has_value());
  EXPECT_FALSE(SpearmanCorrelation(one, one).has_value());
  EXPECT_FALSE(SpearmanCorrelation({}, {}).has_value());
}

}  // namespace
}  // namespace sandwright
