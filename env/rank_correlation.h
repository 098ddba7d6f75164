// Whether one figure grows with another, whatever the shape of the relation.
#pragma once

#include <optional>
#include <span>

namespace sandwright {

// Spearman's rank correlation: Pearson's of the ranks, equal values sharing their mean rank. None
// for fewer than two pairs, or where one side is all equal. The spans have one length.
std::optional<double> SpearmanCorrelation(std::span<const double> a, std::span<const double> b);

}  // namespace sandwright
