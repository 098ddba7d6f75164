// The surrogate's net for prediction: a small fully convolutional U-Net, on the CPU and without
// torch, so that one immutable net serves any number of threads and one row's result never depends
// on the others in its batch. Training (fit_surrogate.h) builds the same net with torch.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "data/base/config.h"
#include "env/safetensors.h"

namespace sandwright {

//   channels -> [conv conv] ------------------------------ concat [conv conv] -> 1x1 -> residual
//                     \ pool                          upsample /
//                      [conv conv] ---------- concat [conv conv]
//                            \ pool         upsample /
//                             [conv      conv]
// Every conv is 3x3, zero padded, with ReLU. The width doubles with each pooling (mean of 2 x 2);
// upsampling repeats cells.
struct SurrogateNetConfig {
  int64_t base_channels = 16;
  int64_t poolings = 2;

  void Fields(FieldList& f) {
    f.Add("base_channels", base_channels, "width of the first level, a multiple of 4", 4, 128);
    f.Add("poolings", poolings, "levels below the first", 0, 4);
  }
  int multiple() const { return 1 << poolings; }  // rows and columns must be multiples of it
};

// One convolution: parameters `name`.weight [out, in, size, size] and `name`.bias [out].
struct ConvShape {
  std::string name;
  int in = 0, out = 0, size = 3;
};

// All of them in the order in which they run: down0a, down0b, ..., up0a, up0b, head. Error where
// base_channels is no multiple of 4.
std::vector<ConvShape> SurrogateLayers(const SurrogateNetConfig& config);

class SurrogateNet {
 public:
  // Takes the parameters out of `file`; Error naming `source` and the tensor that is missing, of
  // another shape or not finite.
  SurrogateNet(const SurrogateNetConfig& config, const Safetensors& file,
               const std::string& source);

  const SurrogateNetConfig& config() const { return config_; }
  // channels [kSurrogateChannelCount, rows, columns] -> residual [rows, columns]; rows and columns
  // are multiples of config().multiple().
  std::vector<float> Forward(std::span<const float> channels, int rows, int columns) const;

 private:
  struct Layer {
    ConvShape shape;
    std::vector<float> weights;  // [out / 4][in][3 x 3][4]; the head: [in]
    std::vector<float> bias;
  };

  SurrogateNetConfig config_;
  std::vector<Layer> layers_;
};

}  // namespace sandwright
