#include "env/training_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/error.h"
#include "data/base/random.h"

namespace sandwright {
namespace {

// Noise of one strength in every channel; half of the cells are active.
SurrogateInput Noise(RandomStream& stream, double strength) {
  SurrogateInput input;
  input.rows = input.columns = 8;
  for (int i = 0; i < 64; ++i) input.active.push_back(i < 32);
  for (int i = 0; i < 64 * kSurrogateChannelCount; ++i)
    input.channels.push_back(i % 64 < 32 ? static_cast<float>(strength * stream.Normal()) : 99.0f);
  return input;
}

TEST(TrainingRange, IsOneAmongTheTrainingStrokesAndGrowsAway) {
  RandomStream stream(1);
  std::vector<SurrogateInput> strokes;
  for (int i = 0; i < 200; ++i) strokes.push_back(Noise(stream, 1));
  const TrainingRange range(strokes);
  double squared = 0;
  for (const SurrogateInput& stroke : strokes) squared += std::pow(range.Distance(stroke), 2) / 200;
  EXPECT_NEAR(squared, 1, 1e-3);
  const double stronger = range.Distance(Noise(stream, 2)), wild = range.Distance(Noise(stream, 4));
  EXPECT_GT(stronger, 2);
  EXPECT_GT(wild, stronger);
}

TEST(TrainingRange, IsKeptInAFile) {
  RandomStream stream(1);
  const TrainingRange range({Noise(stream, 1), Noise(stream, 1.1)});
  Safetensors file;
  range.Save(file);
  const SurrogateInput other = Noise(stream, 3);
  EXPECT_EQ(TrainingRange(file, "model").Distance(other), range.Distance(other));
  file.tensors["range.mean"] = {{1}, {0}};
  EXPECT_THAT([&] { TrainingRange(file, "model"); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("another shape than [24]")));
}

}  // namespace
}  // namespace sandwright
