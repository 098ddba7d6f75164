#include "env/paired_bootstrap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "data/base/error.h"
#include "data/base/random.h"

namespace sandwright {
namespace {

// `files` beds of 8 strokes whose change is 100 mm^2 and whose squared error is error_mm2 * (1 +
// noise N(0, 1)), a mean over 10 cells.
std::vector<StrokeScore> Scores(int files, double error_mm2, double noise, uint64_t seed) {
  RandomStream stream(seed);
  std::vector<StrokeScore> scores;
  for (int i = 0; i < files * 8; ++i) {
    StrokeScore s;
    s.file_index = i / 8;
    s.stroke = i % 8;
    s.cells = 10;
    s.change_mm2 = 1000;
    s.squared_mm2 = 10 * error_mm2 * (1 + noise * stream.Normal());
    scores.push_back(s);
  }
  return scores;
}

TEST(PairedBootstrap, ACommonNoiseCancels) {
  // Both have the same luck: explained 0.9 and 0.8 in every resample alike.
  const auto better = Scores(3, 10, 0, 1), worse = Scores(3, 20, 0, 1);
  const PairedComparison c = CompareExplained(better, worse, 0, 7);
  EXPECT_NEAR(c.explained, 0.9, 1e-12);
  EXPECT_NEAR(c.explained_against, 0.8, 1e-12);
  EXPECT_NEAR(c.low95, 0.1, 1e-12);
  EXPECT_NEAR(c.high95, 0.1, 1e-12);
  EXPECT_EQ(c.better_share, 1);
  EXPECT_EQ(c.unit, "strokes");
  EXPECT_EQ(c.units, 24);
  EXPECT_EQ(c.resamples, 10000);
}

// The mean of n independent differences with standard deviation d spreads by d / sqrt(n).
TEST(PairedBootstrap, TheIntervalIsThatOfTheMean) {
  constexpr double kNoise = 0.3;
  const auto a = Scores(3, 10, kNoise, 1), b = Scores(3, 10, kNoise, 2);
  double sum = 0, squared = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double d = (b[i].squared_mm2 - a[i].squared_mm2) / 1000;
    sum += d / 24, squared += d * d / 24;
  }
  const double deviation = std::sqrt((squared - sum * sum) / 24);
  const PairedComparison c = CompareExplained(a, b, 0, 7);
  EXPECT_NEAR(c.difference, sum, 1e-12);
  EXPECT_NEAR(c.high95 - c.low95, 2 * 1.96 * deviation, 0.1 * 3.92 * deviation);
  EXPECT_NEAR((c.high95 + c.low95) / 2, sum, 0.2 * deviation);
}

TEST(PairedBootstrap, BedsAreDrawnWhereThereAreEnough) {
  // All the difference lies in one bed of four: no interval over beds can leave out zero.
  auto a = Scores(4, 10, 0, 1);
  const auto b = Scores(4, 10, 0, 1);
  for (size_t i = 0; i < 8; ++i) a[i].squared_mm2 = 0;
  const PairedComparison c = CompareExplained(a, b, 0, 7);
  EXPECT_EQ(c.unit, "beds");
  EXPECT_EQ(c.units, 4);
  EXPECT_DOUBLE_EQ(c.low95, 0);
  EXPECT_NEAR(c.better_share, 1 - std::pow(0.75, 4), 0.02);
}

TEST(PairedBootstrap, IsRepeatableAndPairsOnlyWhatBothHave) {
  const auto a = Scores(2, 10, 0.3, 1), b = Scores(2, 12, 0.3, 2);
  EXPECT_EQ(CompareExplained(a, b, 1, 7).ToJson(), CompareExplained(a, b, 1, 7).ToJson());
  EXPECT_NE(CompareExplained(a, b, 1, 7).low95, CompareExplained(a, b, 1, 8).low95);
  EXPECT_EQ(CompareExplained(a, std::span(b).subspan(3, 5), 1, 7).strokes, 5);
  using ::testing::HasSubstr, ::testing::ThrowsMessage;
  EXPECT_THAT([&] { CompareExplained(a, {}, 1, 7); },
              ThrowsMessage<Error>(HasSubstr("no stroke in common")));
  EXPECT_THAT([&] { CompareExplained(a, b, 11, 7); },
              ThrowsMessage<Error>(HasSubstr("more than the floor")));
}

}  // namespace
}  // namespace sandwright
