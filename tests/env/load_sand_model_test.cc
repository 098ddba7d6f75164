#include "env/load_sand_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "data/excavation.h"
#include "env/safetensors.h"
#include "env/score_model.h"
#include "env/terrain_generator.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ShippedSurrogate : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, ShippedSurrogate, ::testing::Values("default", "fast"),
                         [](const auto& test) { return std::string(test.param); });

// On a bed that it was not trained on.
TEST_P(ShippedSurrogate, BeatsTheHeightfieldOnGrains) {
  const std::vector<std::filesystem::path> bed = {SANDWRIGHT_ROOT "/data/strokes/dem/bed_504.h5"};
  const ScoreSummary learned = ScoreModel(*LoadSandModel(GetParam(), {}), bed, {}).Total();
  const ScoreSummary plain = ScoreModel(Heightfield(), bed, {}).Total();
  EXPECT_GT(learned.r2_change.value(), plain.r2_change.value() + 0.02);
  EXPECT_LT(learned.mae_mm.value(), plain.mae_mm.value() - 0.1);
}

TEST_P(ShippedSurrogate, StaysSaneOverFiftyStrokes) {
  const auto model = LoadSandModel(GetParam(), {});
  RandomStream stream(1);
  SandState state(GenerateTerrain({}, 75, 75, 0.004, stream));
  const auto volume = [&] {
    return std::accumulate(state.map().height_m.begin(), state.map().height_m.end(), 0.0);
  };
  const double before = volume();
  for (int i = 0; i < 50; ++i) {
    const Stroke stroke = DrawStroke({}, state.map(), stream);
    model->Apply(std::span(&state, 1), std::span(&stroke, 1));
    for (float h : state.map().height_m) ASSERT_TRUE(h >= 0 && h < 0.15f) << "stroke " << i;
  }
  EXPECT_NEAR(volume(), before, 1e-4 * before);
}

TEST(LoadSandModel, NamesAndRefusals) {
  EXPECT_EQ(LoadSandModel("heightfield", {})->name(), "heightfield");
  SandModelConfig wide;
  wide.heightfield.blade.width_m = 0.08;
  EXPECT_DOUBLE_EQ(LoadSandModel("none", wide)->blade().width_m, 0.08);
  EXPECT_EQ(LoadSandModel("dem", {})->name(), "dem");
  EXPECT_THAT([] { LoadSandModel("sand", {}); },
              ThrowsMessage<Error>(HasSubstr("unknown sand model 'sand'")));
  EXPECT_THAT([] { LoadSandModel("missing.safetensors", {}); },
              ThrowsMessage<Error>(HasSubstr("missing.safetensors")));
  const auto path = std::filesystem::path(::testing::TempDir()) / "foreign.safetensors";
  WriteSafetensors({{{"weight", {{1}, {0}}}}, {}}, path);
  EXPECT_THAT([&] { LoadSandModel(path.string(), {}); },
              ThrowsMessage<Error>(HasSubstr("not a surrogate")));
}

}  // namespace
}  // namespace sandwright
