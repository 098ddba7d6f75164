// The density of a handful of values, and where it is highest: a mode that needs no bins.
#pragma once

#include <span>
#include <vector>

namespace sandwright {

// Gaussian kernels whose width follows Silverman's rule of thumb ("Density Estimation for Statistics
// and Data Analysis", 1986, equation 3.31).
class KernelDensity {
 public:
  // At least one value.
  explicit KernelDensity(std::span<const double> values);

  double bandwidth() const { return bandwidth_; }  // 0: all values are one
  // Density at x, in one over the unit of the values; only where the bandwidth is not 0.
  double At(double x) const;
  // The highest of 512 points over the range of the values.
  double Mode() const;

 private:
  std::vector<double> sorted_;
  double bandwidth_ = 0;
};

}  // namespace sandwright
