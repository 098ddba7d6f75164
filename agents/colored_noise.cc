#include "agents/colored_noise.h"

#include <torch/torch.h>

#include <algorithm>
#include <cmath>

namespace sandwright {

std::vector<float> ColoredNoise(int64_t count, double color, RandomStream& stream) {
  std::vector<float> noise(static_cast<size_t>(count));
  if (color == 0) {
    for (float& value : noise) value = static_cast<float>(stream.Normal());
    return noise;
  }
  const int64_t last = count / 2;
  auto spectrum = torch::zeros({last + 1, 2}, torch::kFloat64);
  auto entries = spectrum.accessor<double, 2>();
  double power = 0;  // of the series, expected
  for (int64_t k = 0; k <= last; ++k) {
    // The mean gets the power of the slowest wave: within an episode it cannot be told from one.
    const double amplitude = std::pow(static_cast<double>(std::max<int64_t>(k, 1)), -0.5 * color);
    const bool single = k == 0 || 2 * k == count;  // no mirrored frequency, no imaginary part
    const double real = stream.Normal(), imaginary = stream.Normal();
    entries[k][0] = amplitude * real * (single ? std::sqrt(2.0) : 1.0);
    entries[k][1] = single ? 0.0 : amplitude * imaginary;
    power += (single ? 2.0 : 4.0) * amplitude * amplitude;
  }
  const auto series = torch::fft::irfft(torch::view_as_complex(spectrum), count, -1, "forward");
  const double scale = 1.0 / std::sqrt(power);
  for (size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<float>(scale * series.data_ptr<double>()[i]);
  return noise;
}

}  // namespace sandwright
