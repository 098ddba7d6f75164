#include "env/rank_correlation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "data/base/error.h"

namespace sandwright {
namespace {

std::vector<double> Ranks(std::span<const double> values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (size_t first = 0, next = 0; first < order.size(); first = next) {
    while (next < order.size() && values[order[next]] == values[order[first]]) ++next;
    for (size_t i = first; i < next; ++i)
      ranks[order[i]] = static_cast<double>(first + next - 1) / 2;
  }
  return ranks;
}

}  // namespace

std::optional<double> SpearmanCorrelation(std::span<const double> a, std::span<const double> b) {
  SAND_CHECK(a.size() == b.size(), a.size(), b.size());
  const std::vector<double> rank_a = Ranks(a), rank_b = Ranks(b);
  const double middle = (static_cast<double>(a.size()) - 1) / 2;
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double da = rank_a[i] - middle, db = rank_b[i] - middle;
    aa += da * da;
    bb += db * db;
    ab += da * db;
  }
  if (!(aa > 0 && bb > 0)) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

}  // namespace sandwright
