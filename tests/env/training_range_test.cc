#include "env/training_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

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

TEST(TrainingRange, OneInAHundredTrainingStrokesIsBeyondAndStrongerOnesAre) {
  RandomStream stream(1);
  std::vector<SurrogateInput> strokes;
  for (int i = 0; i < 200; ++i) strokes.push_back(Noise(stream, stream.Uniform(0.5, 1.5)));
  const TrainingRange range(strokes);
  EXPECT_EQ(
      std::ranges::count_if(strokes, [&](const auto& s) { return range.Distance(s) > 1.0001; }), 2);
  EXPECT_LT(range.Distance(Noise(stream, 0.1)), 0.2);
  const double stronger = range.Distance(Noise(stream, 3)), wild = range.Distance(Noise(stream, 6));
  EXPECT_GT(stronger, 1.5);
  EXPECT_NEAR(wild / stronger, 2, 0.5);
}

TEST(TrainingRange, IsKeptInAFile) {
  RandomStream stream(1);
  const std::vector<SurrogateInput> strokes = {Noise(stream, 1), Noise(stream, 1.1)};
  const TrainingRange range(strokes);
  Safetensors file;
  EXPECT_FALSE(TrainingRange::In(file));
  range.Save(file);
  EXPECT_TRUE(TrainingRange::In(file));
  const SurrogateInput other = Noise(stream, 3);
  EXPECT_EQ(TrainingRange(file, "model").Distance(other), range.Distance(other));
  file.tensors["range.amounts"] = {{1}, {0}};
  EXPECT_THAT([&] { TrainingRange(file, "model"); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("5 positive values")));
}

}  // namespace
}  // namespace sandwright
