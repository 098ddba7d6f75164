// The rows of `bench --suite env`, from runs of some milliseconds.
#include "env/env_bench.h"

#include <gtest/gtest.h>

namespace sandwright {
namespace {

TEST(EnvBench, RatesAndSharesOfAStep) {
  EnvBench bench;
  bench.worlds = {"heightfield"};
  bench.threads = 2;
  bench.seconds = 0.05;
  std::vector<nlohmann::json> rows;
  RunEnvBench(bench, [&](const nlohmann::json& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), 2 * 2u);  // scenes x threads
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_GT(rows[i]["strokes_per_second"], 1) << rows[i];
    EXPECT_GT(rows[i]["share_sand"], 0) << rows[i];
    EXPECT_LT(rows[i]["share_sand"], 1) << rows[i];
    EXPECT_GT(rows[i]["gate_ms_per_stroke"], 0) << rows[i];
    EXPECT_GE(rows[i]["rejected_share"], 0) << rows[i];
  }
}

}  // namespace
}  // namespace sandwright
