// The rows of `bench --suite reference`, from runs of some milliseconds.
#include "env/reference_bench.h"

#include <gtest/gtest.h>

namespace sandwright {
namespace {

TEST(ReferenceBench, EveryTaskBesideItsCore) {
  std::vector<nlohmann::json> rows;
  RunReferenceBench(0.02, [&](const nlohmann::json& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0]["name"], "CartPole-v1");
  EXPECT_EQ(rows[4]["name"], "HalfCheetah-v5");
  for (const nlohmann::json& row : rows) {
    EXPECT_GT(row["core_us"], 0) << row;
    EXPECT_LT(row["step_us"], 5000) << row;
    EXPECT_GT(row["core_share"], 0) << row;
  }
  EXPECT_GT(rows[4]["core_us"], rows[0]["core_us"]);
}

}  // namespace
}  // namespace sandwright
