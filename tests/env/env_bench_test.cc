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
  bench.random_steps = 64;
  std::vector<nlohmann::json> rows;
  RunEnvBench(bench, [&](const nlohmann::json& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), 2 * 2 + 3 + 2 * 2u);  // scenes x threads; batches; memory and random steps
  for (size_t i = 0; i < 7; ++i) {
    EXPECT_GT(rows[i]["strokes_per_second"], 1) << rows[i];
    EXPECT_GT(rows[i]["share_sand"], 0) << rows[i];
    EXPECT_LT(rows[i]["share_sand"], 1) << rows[i];
    EXPECT_GT(rows[i]["gate_ms_per_stroke"], 0) << rows[i];
    EXPECT_GE(rows[i]["rejected_share"], 0) << rows[i];
  }
  EXPECT_EQ(rows[6]["batch"], 128);
  for (const size_t i : {7, 9}) {
    EXPECT_GT(rows[i]["kib_per_environment"], 1) << rows[i];
    EXPECT_EQ(rows[i + 1]["steps"], 64) << rows[i + 1];
    EXPECT_EQ(rows[i + 1]["sound"], true) << rows[i + 1];
  }
}

}  // namespace
}  // namespace sandwright
