#include "env/fit_pix2pix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "env/load_sand_model.h"
#include "env/safetensors.h"
#include "env/score_model.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Two strokes through the heightfield on level sand.
std::filesystem::path WriteBed(const std::string& bed, double y_m) {
  StrokeFile file;
  file.source = "heightfield";
  file.bed = bed;
  for (double x_m : {0.07, 0.10}) {
    StrokeRecord record;
    record.before = HeightMap(50, 50, 0.004, 0.05f);
    record.stroke.control_points_m = {{x_m, y_m, 0.03}, {x_m + 0.05, y_m + 0.02, 0.03}};
    record.path = SamplePath(record.stroke, 0.002);
    SandState state(record.before);
    Heightfield().Apply(std::span(&state, 1), std::span(&record.path, 1));
    record.after = state.map();
    file.strokes.push_back(record);
  }
  const auto path = std::filesystem::path(::testing::TempDir()) / ("pix2pix_" + bed + ".h5");
  WriteStrokeFile(file, path);
  return path;
}

FitPix2PixConfig SmallFit(int64_t pretrain_steps, int64_t steps) {
  FitPix2PixConfig config;
  config.pretrain_steps = pretrain_steps;
  config.steps = steps;
  config.validate_every = 20;
  config.learning_rate = 2e-3;
  config.model.channels = 4;
  return config;
}

std::filesystem::path Save(const Safetensors& model, const std::string& name) {
  const auto path = std::filesystem::path(::testing::TempDir()) / name;
  WriteSafetensors(model, path);
  return path;
}

TEST(FitPix2Pix, LearnsAndPredictsFromItsFileAsInTraining) {
  const FitPix2PixRequest request{{WriteBed("a", 0.10)}, {WriteBed("b", 0.10)}, {}, 1, 1};
  const FitPix2PixReport report = FitPix2Pix(SmallFit(5, 115), request);
  EXPECT_EQ(report.strokes, 2);
  EXPECT_EQ(report.steps, 120);
  EXPECT_LT(report.validation_rmse_mm.value(), 0.7 * report.validation_start_rmse_mm.value());

  const auto file = Save(report.model, "pix2pix.safetensors");
  const auto model = LoadSandModel(file.string(), {});
  EXPECT_EQ(model->name(), "pix2pix");
  const ScoreReport learned = ScoreModel(*model, request.validation, {}),
                    still = ScoreModel(StillSand(), request.validation, {});
  EXPECT_LT(learned.Total().rmse_mean_mm.value(), 0.8 * still.Total().rmse_mean_mm.value());

  // From there on; and the same bytes for any number of threads of the model.
  FitPix2PixRequest on = request;
  on.init = file;
  FitPix2PixConfig little = SmallFit(0, 1);
  little.learning_rate = 1e-6;
  EXPECT_NEAR(FitPix2Pix(little, on).validation_rmse_mm.value(), report.validation_rmse_mm.value(),
              0.05);
  const StrokeFile strokes = ReadStrokeFile(request.validation[0]);
  std::vector<SandState> one, both;
  std::vector<ToolPath> paths;
  for (const StrokeRecord& record : strokes.strokes) {
    one.emplace_back(record.before);
    both.emplace_back(record.before);
    paths.push_back(record.path);
  }
  for (size_t i = 0; i < 2; ++i) model->Apply(std::span(&one[i], 1), std::span(&paths[i], 1));
  SandModelConfig threaded;
  threaded.heightfield.threads = 2;
  const auto outcomes = LoadSandModel(file.string(), threaded)->Apply(both, paths);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one[i].map().height_m, both[i].map().height_m);
    EXPECT_GT(outcomes[i].moved_volume_m3, 0);
  }
}

TEST(FitPix2Pix, SameSeedSameBytes) {
  FitPix2PixRequest request{{WriteBed("a", 0.10)}, {}, {}, 1, 1};
  const auto fit = [&] { return FitPix2Pix(SmallFit(1, 2), request).model; };
  const Safetensors first = fit(), again = fit();
  request.seed = 2;
  const Safetensors other = fit();
  for (const auto& [name, tensor] : first.tensors)
    EXPECT_EQ(tensor.values, again.tensors.at(name).values) << name;
  EXPECT_NE(first.tensors.at("up1.weight").values, other.tensors.at("up1.weight").values);
  EXPECT_EQ(first.metadata, again.metadata);
}

TEST(FitPix2Pix, WithoutTheDiscriminatorTooAndWithoutBlade) {
  FitPix2PixConfig config = SmallFit(0, 2);
  config.gan_weight = 0;
  FitPix2PixRequest request{{WriteBed("a", 0.10)}, {}, {}, 1, 1};
  const auto l1 = FitPix2Pix(config, request).model.tensors.at("up1.weight").values;
  EXPECT_NE(l1, FitPix2Pix(SmallFit(0, 2), request).model.tensors.at("up1.weight").values);
  config.model.blade.width_m = 0.08;
  EXPECT_THAT([&] { FitPix2Pix(config, request); },
              ThrowsMessage<Error>(HasSubstr("the model is for 0.08 x 0.005 m")));
}

TEST(FitPix2Pix, RefusesABedInBothSets) {
  const FitPix2PixRequest request{{WriteBed("a", 0.10)}, {WriteBed("a", 0.11)}, {}, 1, 1};
  EXPECT_THAT([&] { FitPix2Pix(SmallFit(0, 1), request); },
              ThrowsMessage<Error>(HasSubstr("bed 'a' is in both")));
}

TEST(FitPix2Pix, NamesTheStrokeOfALossThatIsNotFinite) {
  const FitPix2PixRequest request{{WriteBed("a", 0.10)}, {}, {}, 1, 1};
  Safetensors start = FitPix2Pix(SmallFit(0, 1), request).model;
  for (float& value : start.tensors.at("down3.weight").values) value = 1e38f;
  FitPix2PixRequest broken = request;
  broken.init = Save(start, "huge.safetensors");
  EXPECT_THAT([&] { FitPix2Pix(SmallFit(0, 1), broken); },
              ThrowsMessage<Error>(HasSubstr("pix2pix_a.h5, stroke")));
}

TEST(Pix2Pix, OneErrorForADamagedFile) {
  const FitPix2PixRequest request{{WriteBed("a", 0.10)}, {}, {}, 1, 1};
  const Safetensors model = FitPix2Pix(SmallFit(0, 1), request).model;
  const auto load = [](const std::filesystem::path& file) {
    return [file] { LoadSandModel(file.string(), {}); };
  };
  const auto cut = Save(model, "cut.safetensors");
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  EXPECT_THAT(load(cut), ThrowsMessage<Error>(HasSubstr("cut.safetensors")));
  Safetensors damaged = model;
  damaged.metadata["config"] = "{";
  EXPECT_THAT(load(Save(damaged, "config.safetensors")),
              ThrowsMessage<Error>(HasSubstr("config.safetensors: metadata config is not JSON")));
  damaged = model;
  damaged.tensors.erase("down1.bias");
  EXPECT_THAT(load(Save(damaged, "without_a_tensor.safetensors")),
              ThrowsMessage<Error>(HasSubstr("no tensor 'down1.bias'")));
}

TEST(Pix2Pix, ChangesNothingWhereNothingIsCut) {
  const FitPix2PixRequest request{{WriteBed("a", 0.10)}, {}, {}, 1, 1};
  const auto model = ReadPix2Pix(FitPix2Pix(SmallFit(0, 1), request).model, "memory", 1);
  const HeightMap bed(50, 50, 0.004, 0.05f);
  for (const double x_m : {0.1, 5.0}) {  // above the sand; outside the box
    SandState state(bed);
    const ToolPath path =
        SamplePath({{{x_m, 0.1, 0.055}, {x_m + 0.05, 0.1, 0.055}}, 1, 0.1}, 0.002);
    const Outcome outcome = model->Apply(std::span(&state, 1), std::span(&path, 1)).front();
    EXPECT_EQ(outcome.left_box, x_m > 1);
    EXPECT_TRUE(outcome.changed.empty());
    EXPECT_EQ(state.map().height_m, bed.height_m);
  }
}

}  // namespace
}  // namespace sandwright
