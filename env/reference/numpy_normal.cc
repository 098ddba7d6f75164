// The ziggurat of Marsaglia and Tsang ("The ziggurat method for generating random variables", 2000)
// in 256 layers of equal area, the lowest with the tail beyond kEdge.
#include "env/reference/numpy_normal.h"

#include <array>
#include <cmath>

namespace sandwright {
namespace {

constexpr size_t kLayers = 256, kBottom = 0, kWidest = kLayers - 1;
constexpr double kEdge = 3.6541528853610088, kArea = 0.004928673233974652;
constexpr double kSteps = 0x1p52;  // a draw is a whole number of steps across its layer

struct Ziggurat {
  std::array<double, kLayers> step;      // width of a layer / kSteps
  std::array<double, kLayers> density;   // exp(-x^2 / 2) at that width; 1 for the bottom
  std::array<uint64_t, kLayers> inside;  // draws below it lie under the curve for sure

  Ziggurat() {
    double x = kEdge;
    step[kWidest] = x / kSteps;
    density[kWidest] = std::exp(-0.5 * x * x);
    step[kBottom] = kArea / density[kWidest] / kSteps;
    density[kBottom] = 1;
    inside[kBottom] = static_cast<uint64_t>(x * density[kWidest] / kArea * kSteps);
    for (size_t i = kWidest - 1; i > 0; --i) {
      const double narrower = std::sqrt(-2 * std::log(kArea / x + density[i + 1]));
      inside[i + 1] = static_cast<uint64_t>(std::nearbyint(narrower / x * kSteps));
      x = narrower;
      step[i] = x / kSteps;
      density[i] = std::exp(-0.5 * x * x);
      // The exp that numpy's tables were made with rounded this one layer up.
      if (i == 38) density[i] = std::nextafter(density[i], 1);
    }
    inside[1] = 0;
  }
};

}  // namespace

double StandardNormal(NumpyRandom& random) {
  static const Ziggurat ziggurat;
  while (true) {
    const uint64_t bits = random.Next64();
    const size_t layer = bits & 0xff;
    const uint64_t steps = bits >> 9 & 0xfffffffffffff;
    const double size = static_cast<double>(steps) * ziggurat.step[layer];
    const double x = bits >> 8 & 1 ? -size : size;
    if (steps < ziggurat.inside[layer]) return x;
    if (layer == kBottom) {
      while (true) {
        const double beyond = -(1 / kEdge) * std::log1p(-random.Uniform(0, 1));
        const double height = -std::log1p(-random.Uniform(0, 1));
        if (height + height > beyond * beyond)
          return steps >> 8 & 1 ? -(kEdge + beyond) : kEdge + beyond;
      }
    }
    const double low = ziggurat.density[layer], high = ziggurat.density[layer - 1];
    if ((high - low) * random.Uniform(0, 1) + low < std::exp(-0.5 * x * x)) return x;
  }
}

}  // namespace sandwright
