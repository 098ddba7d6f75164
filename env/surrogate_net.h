// The surrogate's net for prediction: a small fully convolutional U-Net, on the CPU and without
// torch, so that one immutable net serves any number of threads and one row's result never depends
// on the others in its batch. Training (fit_surrogate.h) builds the same net with torch.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "data/base/config.h"
#include "env/convolution.h"
#include "env/safetensors.h"

namespace sandwright {

//   channels -> [conv conv] ------------------------------ concat [conv conv] -> 1x1 -> residual
//                     \ pool                          upsample /
//                      [conv conv] ---------- concat [conv conv]
//                            \ pool         upsample /
//                             [conv      conv]
// Every conv is 3x3, zero padded, with ReLU. The width doubles with each pooling (mean of 2 x 2);
// upsampling repeats cells. With patch_cells = 2 the first level works on cells twice as large: the
// channels of 2 x 2 cells go in side by side, and the head gives one value for each of the four.
struct SurrogateNetConfig {
  int64_t base_channels = 16;
  int64_t poolings = 2;
  int64_t patch_cells = 1;

  void Fields(FieldList& f) {
    f.Add("base_channels", base_channels,
          "width of the first level; predicting, 16 channels cost as much as fewer", 4, 128);
    f.Add("poolings", poolings, "levels below the first", 0, 4);
    f.Add("patch_cells", patch_cells, "cells along each side that the first level takes as one", 1,
          4);
  }
  // Rows and columns must be multiples of it.
  int multiple() const { return static_cast<int>(patch_cells) << poolings; }
};

// One convolution: parameters `name`.weight [out, in, size, size] and `name`.bias [out].
struct ConvShape {
  std::string name;
  int in = 0, out = 0, size = 3;
  int level = 0;  // how many poolings lie before it
};

// All of them in the order in which they run: down0a, down0b, ..., up0a, up0b, head. Channels of a
// patch are in the order of torch's pixel_unshuffle and pixel_shuffle.
std::vector<ConvShape> SurrogateLayers(const SurrogateNetConfig& config);

class SurrogateNet {
 public:
  // Takes the parameters out of `file`; Error naming `source` and the tensor that is missing, of
  // another shape or not finite.
  SurrogateNet(const SurrogateNetConfig& config, const Safetensors& file,
               const std::string& source);

  const SurrogateNetConfig& config() const { return config_; }
  // channels [kSurrogateChannelCount, rows, columns] -> residual [rows, columns] in units of
  // kResidualScale_m; rows and columns are those of `active` and multiples of config().multiple().
  // A cell whose patch is not active is zero at every level, so that nothing is spent on it.
  std::vector<float> Forward(std::span<const float> channels, const ActiveCells& active) const;
  // Floating-point operations of Forward: two for each weight and cell that it is used on.
  double Flops(const ActiveCells& active) const;

 private:
  CellFeatures PackPatches(std::span<const float> channels, const ActiveCells& active) const;

  SurrogateNetConfig config_;
  std::vector<Convolution> layers_;
};

}  // namespace sandwright
