#include "env/pix2pix_net.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <torch/types.h>

#include <limits>
#include <utility>

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

torch::Tensor Noise(int64_t batch, int64_t channels) {
  torch::manual_seed(3);
  return torch::rand({batch, channels, kPaperPixels, kPaperPixels}) * 2 - 1;
}

int64_t CountOf(const Pix2PixLayers& layers) {
  int64_t count = 0;
  for (const torch::Tensor& p : layers.parameters()) count += p.numel();
  return count;
}

TEST(Pix2PixGenerator, IsTheUNetOfThePaper) {
  const torch::NoGradGuard no_grad;
  const Pix2PixGenerator generator(4, RandomStream(1));
  const torch::Tensor x = Noise(2, 3), y = generator.Forward(x);
  EXPECT_EQ(y.sizes().vec(), (std::vector<int64_t>{2, 1, kPaperPixels, kPaperPixels}));
  EXPECT_LE(y.abs().max().item<double>(), 1);
  // A picture's answer does not depend on the others of its batch.
  EXPECT_LT((y.narrow(0, 1, 1) - generator.Forward(x.narrow(0, 1, 1))).abs().max().item<double>(),
            1e-5);
  // 54.4 million numbers at ngf 64 in the original, whose three output channels cost 2049 each.
  const auto expected = [](int64_t ngf) {
    const int64_t widths[] = {3,       ngf,     2 * ngf, 4 * ngf, 8 * ngf,
                              8 * ngf, 8 * ngf, 8 * ngf, 8 * ngf};
    int64_t count = 0;
    for (int i = 0; i < 8; ++i) {
      count += 16 * widths[i] * widths[i + 1];                                    // down
      count += 16 * (i == 7 ? 1 : 2) * widths[i + 1] * (i == 0 ? 1 : widths[i]);  // up
      count += i == 0 || i == 7 ? widths[i + 1] : 2 * widths[i + 1];
      count += i == 0 ? 1 : 2 * widths[i];
    }
    return count;
  };
  EXPECT_EQ(CountOf(generator.layers()), expected(4));
  EXPECT_NEAR(1e-6 * static_cast<double>(expected(64)), 54.4, 0.1);
}

TEST(Pix2PixGenerator, DropoutComesFromItsOwnStream) {
  const torch::NoGradGuard no_grad;
  const Pix2PixGenerator generator(4, RandomStream(1));
  const torch::Tensor x = Noise(1, 3);
  const auto forward = [&](uint64_t seed) {
    return generator.Forward(x, torch::make_generator<at::CPUGeneratorImpl>(seed));
  };
  EXPECT_TRUE(torch::equal(forward(5), forward(5)));
  EXPECT_FALSE(torch::equal(forward(5), forward(6)));
  EXPECT_TRUE(torch::equal(generator.Forward(x), generator.Forward(x)));
}

TEST(Pix2PixDiscriminator, JudgesPatchesOf70Pixels) {
  const Pix2PixDiscriminator discriminator(4, RandomStream(1));
  EXPECT_EQ(discriminator.Forward(Noise(1, 3), Noise(1, 1)).sizes().vec(),
            (std::vector<int64_t>{1, 1, 30, 30}));
  const std::vector<Pix2PixLayer>& shapes = discriminator.layers().shapes();
  int64_t patch = 1;
  for (size_t i = shapes.size(); i-- > 0;) patch = (patch - 1) * shapes[i].stride + 4;
  EXPECT_EQ(patch, 70);
}

TEST(Pix2PixLayers, StartFromTheSeedAndComeBackFromDisk) {
  const Pix2PixGenerator a(4, RandomStream(1)), same(4, RandomStream(1)), other(4, RandomStream(2));
  const torch::Tensor& weight = a.layers().parameters()[0];
  EXPECT_TRUE(torch::equal(weight, same.layers().parameters()[0]));
  EXPECT_FALSE(torch::equal(weight, other.layers().parameters()[0]));
  const Pix2PixGenerator wide(16, RandomStream(1));
  EXPECT_NEAR(wide.layers().parameters()[2].std().item<double>(), 0.02, 0.002);

  Safetensors file;
  a.layers().Save(a.layers().parameters(), file);
  const torch::NoGradGuard no_grad;
  const torch::Tensor x = Noise(1, 3);
  EXPECT_TRUE(torch::equal(Pix2PixGenerator(4, file, "a.safetensors").Forward(x), a.Forward(x)));
  EXPECT_THAT(
      [&] { Pix2PixGenerator(8, file, "a.safetensors"); },
      ThrowsMessage<Error>(HasSubstr("a.safetensors: tensor down1.weight has another shape")));
  const float finite =
      std::exchange(file.tensors["up3.scale"].values[0], std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT([&] { Pix2PixGenerator(4, file, "a.safetensors"); },
              ThrowsMessage<Error>(HasSubstr("up3.scale holds numbers that are not finite")));
  file.tensors["up3.scale"].values[0] = finite;
  file.tensors.erase("up2.weight");
  EXPECT_THAT([&] { Pix2PixGenerator(4, file, "a.safetensors"); },
              ThrowsMessage<Error>(HasSubstr("no tensor 'up2.weight'")));
}

TEST(PaperTensor, LevelsThereAndBack) {
  PaperPlane plane(kPaperCount);
  for (size_t i = 0; i < kPaperCount; ++i) plane[i] = static_cast<uint8_t>(i % 256);
  const torch::Tensor tensor = PaperTensor(plane);
  EXPECT_EQ(tensor[0][0][0][0].item<float>(), -1);
  EXPECT_EQ(tensor[0][0][0][255].item<float>(), 1);
  EXPECT_EQ(PaperPlaneOf(tensor), plane);
}

}  // namespace
}  // namespace sandwright
