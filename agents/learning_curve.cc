#include "agents/learning_curve.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr int kResamples = 2000;

std::vector<std::string> CellsOf(const std::string& row) {
  std::vector<std::string> cells(1);
  for (const char c : row) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

// The column's numbers by step.
std::map<int64_t, double> ReadColumn(const std::filesystem::path& folder,
                                     const std::string& column) {
  const auto file = folder / "progress.csv";
  std::istringstream rows(ReadFile(file));
  std::string row;
  std::getline(rows, row);
  const auto names = CellsOf(row);
  const auto found = std::ranges::find(names, column);
  if (found == names.end() || found == names.begin())
    throw Error(fmt::format("{}: no column \"{}\"; it has {}", file.string(), column, row));
  const auto at = static_cast<size_t>(found - names.begin());
  std::map<int64_t, double> values;
  while (std::getline(rows, row)) {
    const auto cells = CellsOf(row);
    if (cells.size() != names.size() || cells[at].empty()) continue;
    try {
      values[std::stoll(cells[0])] = std::stod(cells[at]);
    } catch (const std::exception&) {
      throw Error(fmt::format("{}: not a row of numbers: {}", file.string(), row));
    }
  }
  return values;
}

}  // namespace

double InterquartileMean(std::vector<double> values) {
  SAND_CHECK(!values.empty());
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  const double low = count / 4, high = count - count / 4;
  double sum = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const auto at = static_cast<double>(i);
    sum += values[i] * std::max(0.0, std::min(at + 1, high) - std::max(at, low));
  }
  return sum / (high - low);
}

Spread SpreadOf(const std::vector<double>& values, RandomStream& stream) {
  std::vector<double> means(kResamples);
  for (double& mean : means) {
    std::vector<double> drawn;
    for (size_t i = 0; i < values.size(); ++i) drawn.push_back(values[stream.Index(values.size())]);
    mean = InterquartileMean(std::move(drawn));
  }
  std::ranges::sort(means);
  return {InterquartileMean(values), means[kResamples / 40], means[kResamples - 1 - kResamples / 40]};
}

LearningCurve ReadLearningCurve(std::span<const std::filesystem::path> run_folders,
                                const std::string& column, uint64_t seed) {
  SAND_CHECK(!run_folders.empty());
  std::vector<std::map<int64_t, double>> runs;
  for (const auto& folder : run_folders) runs.push_back(ReadColumn(folder, column));
  LearningCurve curve;
  curve.runs = static_cast<int>(runs.size());
  RandomStream stream(seed, StreamId("learning curve"));
  for (const auto& [step, unused] : runs.front()) {
    std::vector<double> values;
    for (const auto& run : runs)
      if (const auto at = run.find(step); at != run.end()) values.push_back(at->second);
    if (values.size() != runs.size()) continue;
    const Spread spread = SpreadOf(values, stream);
    curve.steps.push_back(static_cast<double>(step));
    curve.iqm.push_back(spread.iqm);
    curve.low95.push_back(spread.low95);
    curve.high95.push_back(spread.high95);
  }
  if (curve.steps.empty())
    throw Error(fmt::format("{}: \"{}\" has no step that all {} runs share",
                            run_folders.front().string(), column, runs.size()));
  return curve;
}

}  // namespace sandwright
