#include "env/paired_bootstrap.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "data/base/error.h"
#include "data/base/random.h"

namespace sandwright {
namespace {

// Sums over the score windows of some strokes.
struct Sums {
  double cells = 0, squared_mm2 = 0, change_mm2 = 0;

  void Add(const Sums& other) {
    cells += other.cells;
    squared_mm2 += other.squared_mm2;
    change_mm2 += other.change_mm2;
  }
  std::optional<double> Explained(double floor_mm2) const {
    return ExplainedShare(squared_mm2 / cells, change_mm2 / cells, floor_mm2);
  }
};

struct Unit {
  Sums model, against;
};

Sums SumsOf(const StrokeScore& s) {
  return {static_cast<double>(s.cells), s.squared_mm2, s.change_mm2};
}

}  // namespace

PairedComparison CompareExplained(std::span<const StrokeScore> strokes,
                                  std::span<const StrokeScore> against, double floor_mm,
                                  uint64_t seed, int resamples) {
  std::map<std::pair<int, int>, const StrokeScore*> partner;
  for (const StrokeScore& s : against) partner[{s.file_index, s.stroke}] = &s;
  std::map<int, Unit> beds;
  std::vector<Unit> units;  // strokes at first
  for (const StrokeScore& s : strokes) {
    const auto other = partner.find({s.file_index, s.stroke});
    if (other == partner.end()) continue;
    units.push_back({SumsOf(s), SumsOf(*other->second)});
    beds[s.file_index].model.Add(units.back().model);
    beds[s.file_index].against.Add(units.back().against);
  }
  if (units.empty()) throw Error("the two models have no stroke in common");

  PairedComparison result;
  result.strokes = static_cast<int>(units.size());
  const bool whole_beds = std::ssize(beds) >= kFewestBedsToResample;
  result.unit = whole_beds ? "beds" : "strokes";
  if (whole_beds) {
    units.clear();
    for (const auto& [bed, unit] : beds) units.push_back(unit);
  }
  result.units = static_cast<int>(units.size());

  const double floor_mm2 = floor_mm * floor_mm;
  Unit all;
  for (const Unit& unit : units) all.model.Add(unit.model), all.against.Add(unit.against);
  const auto model = all.model.Explained(floor_mm2), rival = all.against.Explained(floor_mm2);
  if (!model || !rival) throw Error("nothing to compare: no stroke changes more than the floor");
  result.explained = *model;
  result.explained_against = *rival;
  result.difference = *model - *rival;

  RandomStream stream(seed, StreamId("paired bootstrap"));
  std::vector<double> differences;
  for (int k = 0; k < resamples; ++k) {
    Unit drawn;
    for (size_t i = 0; i < units.size(); ++i) {
      const Unit& unit = units[stream.Index(units.size())];
      drawn.model.Add(unit.model);
      drawn.against.Add(unit.against);
    }
    const auto a = drawn.model.Explained(floor_mm2), b = drawn.against.Explained(floor_mm2);
    if (a && b) differences.push_back(*a - *b);
  }
  SAND_CHECK(!differences.empty());
  std::ranges::sort(differences);
  const auto quantile = [&](double q) {
    return differences[static_cast<size_t>(q * static_cast<double>(differences.size() - 1) + 0.5)];
  };
  result.low95 = quantile(0.025);
  result.high95 = quantile(0.975);
  result.resamples = static_cast<int>(differences.size());
  result.better_share =
      static_cast<double>(std::ranges::count_if(differences, [](double d) { return d > 0; })) /
      static_cast<double>(differences.size());
  return result;
}

nlohmann::json PairedComparison::ToJson() const {
  return {{"explained", explained},
          {"explained_against", explained_against},
          {"difference", difference},
          {"low95", low95},
          {"high95", high95},
          {"better_share", better_share},
          {"unit", unit},
          {"units", units},
          {"strokes", strokes},
          {"resamples", resamples}};
}

}  // namespace sandwright
