// Densities against numeric integration and hand numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "agents/beta.h"
#include "agents/categorical.h"
#include "agents/stroke_place.h"

namespace sandwright {
namespace {

struct Case {
  double alpha, beta;
};
const Case kCases[] = {{1.7, 1.7}, {1.01, 4.0}, {12.0, 3.0}, {60.0, 80.0}};

BetaParameters Of(const Case& c) {
  return {torch::full({1, 1}, c.alpha), torch::full({1, 1}, c.beta)};
}

// Midpoint rule over the actions: x of shape [n, 1], each with weight `width`.
torch::Tensor Midpoints(int64_t n) {
  return ((torch::arange(n, torch::kFloat64) + 0.5) * (2.0 / static_cast<double>(n)) - 1.0)
      .to(torch::kFloat32)
      .unsqueeze(1);
}

TEST(Beta, DensityEntropyAndMeanMatchIntegration) {
  constexpr int64_t n = 200000;
  const double width = 2.0 / n;
  for (const Case& c : kCases) {
    const auto x = Midpoints(n);
    const auto log_density = BetaLogProb(Of(c), x).to(torch::kFloat64);
    const auto density = log_density.exp();
    EXPECT_NEAR(density.sum().item<double>() * width, 1.0, 2e-3) << c.alpha;
    EXPECT_NEAR(-(density * log_density).sum().item<double>() * width,
                BetaEntropy(Of(c)).item<double>(), 3e-3)
        << c.alpha;
    EXPECT_NEAR((density * x.squeeze(1)).sum().item<double>() * width,
                BetaMean(Of(c)).item<double>(), 2e-3);
  }
}

TEST(Beta, HandNumbers) {
  // Beta(2, 2) on [-1, 1] has density 3/4 (1 - x^2) and variance 1/5.
  const Case c{2, 2};
  EXPECT_NEAR(BetaLogProb(Of(c), torch::zeros({1, 1})).item<double>(), std::log(0.75), 1e-6);
  EXPECT_NEAR(BetaLogProb(Of(c), torch::full({1, 1}, 0.5)).item<double>(), std::log(0.5625), 1e-6);
  // Beyond the bounds by rounding, and on them, the log density stays finite.
  EXPECT_TRUE(std::isfinite(BetaLogProb(Of(c), torch::ones({1, 1})).item<double>()));
}

TEST(Beta, OutputsGiveOnePeak) {
  const auto p = BetaFromOutputs(torch::tensor({{-30.0f, 0.0f, 5.0f, 40.0f}}));
  EXPECT_GE(p.alpha.min().item<float>(), 1.0f);
  EXPECT_GE(p.beta.min().item<float>(), 1.0f);
  EXPECT_NEAR(p.alpha[0][1].item<float>(), 1.0f + std::log(2.0f), 1e-6f);
}

TEST(Beta, SamplesHaveTheRightMomentsAndBounds) {
  RandomStream stream(3);
  constexpr int n = 40000;
  for (const Case& c : kCases) {
    double sum = 0, squares = 0;
    for (int i = 0; i < n; ++i) {
      const float a = SampleBeta(c.alpha, c.beta, stream);
      ASSERT_LT(std::abs(a), 1.0f);
      sum += a, squares += a * a;
    }
    const double total = c.alpha + c.beta, mean = sum / n;
    const double sd = 2.0 * std::sqrt(c.alpha * c.beta / (total * total * (total + 1)));
    EXPECT_NEAR(mean, 2 * c.alpha / total - 1, 4 * sd / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares / n - mean * mean), sd, 0.02 * sd);
  }
}

TEST(Categorical, HandNumbers) {
  // Probabilities 1/4 and 3/4.
  const auto logits = torch::tensor({{0.0f, std::log(3.0f)}});
  EXPECT_NEAR(CategoricalLogProb(logits, torch::tensor({1})).item<double>(), std::log(0.75), 1e-6);
  EXPECT_NEAR(CategoricalEntropy(logits).item<double>(),
              -0.25 * std::log(0.25) - 0.75 * std::log(0.75), 1e-6);
  RandomStream stream(4);
  const std::vector<float> probability = {0.25f, 0.75f};
  int second = 0;
  for (int i = 0; i < 4000; ++i) second += SampleCategorical(probability, stream);
  EXPECT_NEAR(second, 3000, 4 * std::sqrt(4000 * 0.25 * 0.75));
}

TEST(PlaceGrid, CentresLieInTheirBins) {
  const PlaceGrid grid{4, 3, 5};
  const auto bins = torch::arange(grid.bins(), torch::kInt64);
  EXPECT_TRUE(torch::equal(grid.Bin(grid.Centre(bins)), bins));
  // Bin (heading 2, row 1, column 0): x = -1 + 1/5, y = 0, heading = -1 + 2.5 / 2.
  const auto centre = grid.Centre(torch::tensor({(2 * 3 + 1) * 5}));
  EXPECT_NEAR(centre[0][0].item<double>(), -0.8, 1e-6);
  EXPECT_NEAR(centre[0][1].item<double>(), 0.0, 1e-6);
  EXPECT_NEAR(centre[0][2].item<double>(), 0.25, 1e-6);
  // The bounds belong to the outer bins.
  EXPECT_EQ(grid.Bin(torch::ones({1, 3})).item<int64_t>(), grid.bins() - 1);
  EXPECT_EQ(grid.Bin(-torch::ones({1, 3})).item<int64_t>(), 0);
}

TEST(PlaceGrid, OffsetsAndPlacesAreInverse) {
  const PlaceGrid grid{4, 3, 5};
  const auto bins = torch::arange(grid.bins(), torch::kInt64);
  for (const double within : {-0.99, -0.3, 0.0, 0.7}) {
    const auto offset = torch::tensor({within, -within, 0.5 * within}).expand({grid.bins(), 3});
    const auto place = grid.Place(bins, offset);
    EXPECT_TRUE(torch::equal(grid.Bin(place), bins));
    EXPECT_TRUE(torch::allclose(grid.Offset(place, bins), offset.to(torch::kFloat32), 0, 1e-5));
  }
  // An offset at the edge does not leave the bin.
  for (const double edge : {-1.0, 1.0})
    EXPECT_TRUE(torch::equal(grid.Bin(grid.Place(bins, torch::full({grid.bins(), 3}, edge))), bins));
  // Of bin (0, 0, 0), whose sides are 2/5, 2/3 and 1/2.
  const auto place = grid.Place(torch::zeros({1}, torch::kInt64), torch::tensor({{0.5, 0.0, -0.5}}));
  EXPECT_NEAR(place[0][0].item<double>(), -0.7, 1e-6);
  EXPECT_NEAR(place[0][1].item<double>(), -2.0 / 3, 1e-6);
  EXPECT_NEAR(place[0][2].item<double>(), -0.875, 1e-6);
}

}  // namespace
}  // namespace sandwright
