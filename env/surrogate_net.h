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

//   channels -> [conv conv] ------------------------------ concat [conv conv] -> 1x1 -> outputs
//                     \ pool                          upsample /
//                      [conv conv] ---------- concat [conv conv]
//                            \ pool         upsample /
//                             [conv      conv]
// Every conv is 3x3, zero padded, with ReLU. The width doubles with each pooling (mean of 2 x 2);
// upsampling repeats cells. With patch_cells = 2 the first level works on cells twice as large: the
// channels of 2 x 2 cells go in side by side, and the head gives one value for each of the four.
// The architecture `linear` is one convolution of LinearFeatures instead.
struct SurrogateNetConfig {
  std::string architecture = "residual";
  int64_t base_channels = 16;
  int64_t poolings = 2;
  int64_t patch_cells = 1;
  int64_t linear_cells = 7;

  void Fields(FieldList& f) {
    f.Add(
        "architecture", architecture,
        "what the net says: residual (what is added to the heightfield), flux (what flows through "
        "each cell face after the heightfield), direct (what is added to the terrain, without a "
        "heightfield), linear (a residual that is linear in the terrain)",
        {"residual", "flux", "direct", "linear"});
    f.Add("base_channels", base_channels,
          "width of the first level; predicting, 16 channels cost as much as fewer", 4, 128);
    f.Add("poolings", poolings, "levels below the first", 0, 4);
    f.Add("patch_cells", patch_cells, "cells along each side that the first level takes as one", 1,
          4);
    f.Add("linear_cells", linear_cells,
          "of the architecture linear: side of its one convolution, an odd number of patches", 1,
          31);
  }
  bool linear() const { return architecture == "linear"; }
  bool uses_heightfield() const { return architecture != "direct"; }
  int inputs() const;   // channels of a cell that go in
  int outputs() const;  // values of a cell that come out
  // Rows and columns must be multiples of it.
  int multiple() const { return static_cast<int>(patch_cells) << (linear() ? 0 : poolings); }
};

// The input of the architecture `linear`, [inputs, rows, columns] from the channels of a stroke:
// inside, height, cut, near, ahead and change, each times 1, cos, sin, cos 2 and sin 2 of the
// direction of travel at the nearest pose. A convolution of them is linear in the heights, with
// a kernel that turns with the stroke: the action-dependent linear map of Suh and Tedrake (2020),
// https://arxiv.org/abs/2002.09093, for a continuous action.
std::vector<float> LinearFeatures(std::span<const float> channels, size_t cells);

// One convolution: parameters `name`.weight [out, in, size, size] and `name`.bias [out].
struct ConvShape {
  std::string name;
  int in = 0, out = 0, size = 3;
  int level = 0;  // how many poolings lie before it
};

// All of them in the order in which they run: down0a, down0b, ..., up0a, up0b, head; linear: head
// alone. Channels of a patch are in the order of torch's pixel_unshuffle and pixel_shuffle. Error
// where linear_cells is even.
std::vector<ConvShape> SurrogateLayers(const SurrogateNetConfig& config);

class SurrogateNet {
 public:
  // Takes the parameters out of `file`; Error naming `source` and the tensor that is missing, of
  // another shape or not finite.
  SurrogateNet(const SurrogateNetConfig& config, const Safetensors& file,
               const std::string& source);

  const SurrogateNetConfig& config() const { return config_; }
  // channels [kSurrogateChannelCount, rows, columns] -> [outputs, rows, columns] in units of
  // kResidualScale_m; rows and columns are those of `active` and multiples of config().multiple().
  // A cell whose patch is not active is zero at every level, so that nothing is spent on it.
  std::vector<float> Forward(std::span<const float> channels, const ActiveCells& active) const;
  // Floating-point operations of Forward: two for each weight and cell that it is used on.
  double Flops(const ActiveCells& active) const;

 private:
  // inputs [config().inputs(), rows, columns] on the patches of the first level, `active` there.
  CellFeatures PackPatches(std::span<const float> inputs, const ActiveCells& active) const;
  // All layers but the head; `levels` are the active cells of each.
  CellFeatures ForwardUNet(CellFeatures current, std::span<const ActiveCells> levels) const;

  SurrogateNetConfig config_;
  std::vector<Convolution> layers_;
};

}  // namespace sandwright
