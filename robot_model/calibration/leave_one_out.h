// Each measurement as the others predict it: the error that a calibration states, and how a wrong
// measurement is found.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace sandwright {

// Root of the mean square; 0 of none.
inline double RootMeanSquare(const std::vector<double>& errors) {
  double square = 0;
  for (const double error : errors) square += error * error;
  return errors.empty() ? 0 : std::sqrt(square / static_cast<double>(errors.size()));
}

struct LeaveOneOut {
  std::vector<double> held_out_m;  // a measurement, as the others predict it
  size_t suspect = 0;              // without it the others agree best
  double others_m = 0;             // largest error among those others, then
};

// `fit(indices)` solves from those of `count` measurements; `error_m(solution, index)` is how far
// that measurement lies from the solution.
template <class Fit, class Error_m>
LeaveOneOut LeaveEachOut(size_t count, const Fit& fit, const Error_m& error_m) {
  LeaveOneOut result;
  double least_m = -1;
  for (size_t out = 0; out < count; ++out) {
    std::vector<size_t> in(count);
    std::iota(in.begin(), in.end(), size_t{0});
    in.erase(in.begin() + static_cast<std::ptrdiff_t>(out));
    const auto solution = fit(in);
    result.held_out_m.push_back(error_m(solution, out));
    double largest_m = 0;
    for (const size_t i : in) largest_m = std::max(largest_m, error_m(solution, i));
    if (least_m < 0 || largest_m < least_m) {
      least_m = largest_m;
      result.suspect = out;
    }
  }
  result.others_m = least_m;
  return result;
}

}  // namespace sandwright
