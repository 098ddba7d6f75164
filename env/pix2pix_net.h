// The two nets of pix2pix (Isola, Zhu, Zhou, Efros, "Image-to-image translation with conditional
// adversarial networks", CVPR 2017, https://arxiv.org/abs/1611.07004), in torch.
#pragma once

#include <torch/types.h>

#include <optional>
#include <string>
#include <vector>

#include "data/base/random.h"
#include "env/paper_encoding.h"
#include "env/safetensors.h"

namespace sandwright {

// The shape of one 4 x 4 convolution.
struct Pix2PixLayer {
  std::string name;
  int64_t in = 0, out = 0;  // channels
  int64_t stride = 2;
  bool up = false;          // transposed: doubles rows and columns
  bool normalised = false;  // followed by a batch norm over the one picture, in place of a bias
};

// Convolutions with their weights. Batch norm takes the statistics of each picture by itself, as
// the original does with its batches of one, so there are no running means and nothing depends on
// the batch.
class Pix2PixLayers {
 public:
  // Weights from N(0, 0.02), scales of the norms from N(1, 0.02), as in the paper.
  Pix2PixLayers(std::vector<Pix2PixLayer> shapes, RandomStream stream);
  // Tensors of `file`; Error naming `source` where one is missing, has another shape or is not
  // finite.
  Pix2PixLayers(std::vector<Pix2PixLayer> shapes, const Safetensors& file,
                const std::string& source);

  torch::Tensor Run(size_t layer, const torch::Tensor& x) const;
  const std::vector<Pix2PixLayer>& shapes() const { return shapes_; }
  const std::vector<torch::Tensor>& parameters() const { return parameters_; }
  // By names: layer + ".weight", and ".bias" or ".scale" and ".shift". `values` are the parameters
  // or a copy of them.
  void Save(const std::vector<torch::Tensor>& values, Safetensors& file) const;

 private:
  Pix2PixLayers(std::vector<Pix2PixLayer> shapes);

  std::vector<Pix2PixLayer> shapes_;
  std::vector<std::string> names_;         // of parameters_
  std::vector<torch::Tensor> parameters_;  // of each layer: weight, then bias or scale and shift
  std::vector<size_t> first_;              // of a layer's parameters
};

// The U-Net of 256 x 256 pixels: eight halvings, eight doublings, skips between equals.
class Pix2PixGenerator {
 public:
  // `channels` at the first halving (ngf); eight times as many from the fourth on.
  Pix2PixGenerator(int64_t channels, RandomStream stream) : layers_(Shapes(channels), stream) {}
  Pix2PixGenerator(int64_t channels, const Safetensors& file, const std::string& source)
      : layers_(Shapes(channels), file, source) {}

  // input [N, 3, 256, 256] -> [N, 1, 256, 256], both in -1..1 (PaperTensor). With a generator of
  // random numbers, dropout of a half after the three innermost doublings (training only).
  torch::Tensor Forward(const torch::Tensor& input,
                        std::optional<at::Generator> dropout = {}) const;
  const Pix2PixLayers& layers() const { return layers_; }

 private:
  static std::vector<Pix2PixLayer> Shapes(int64_t channels);
  Pix2PixLayers layers_;
};

// The PatchGAN that judges each patch of 70 x 70 pixels by itself.
class Pix2PixDiscriminator {
 public:
  Pix2PixDiscriminator(int64_t channels, RandomStream stream) : layers_(Shapes(channels), stream) {}

  // input [N, 3, 256, 256], answer [N, 1, 256, 256] -> logits of "real" [N, 1, 30, 30].
  torch::Tensor Forward(const torch::Tensor& input, const torch::Tensor& answer) const;
  const Pix2PixLayers& layers() const { return layers_; }

 private:
  static std::vector<Pix2PixLayer> Shapes(int64_t channels);
  Pix2PixLayers layers_;
};

// The picture as a tensor [1, 3, 256, 256] (R, G, B), or one plane [1, 1, 256, 256]: level 0 is -1,
// 255 is 1.
torch::Tensor PaperTensor(const PaperInput& input);
torch::Tensor PaperTensor(const PaperPlane& plane);
// The nearest levels of a tensor [1, 1, 256, 256].
PaperPlane PaperPlaneOf(const torch::Tensor& tensor);

}  // namespace sandwright
