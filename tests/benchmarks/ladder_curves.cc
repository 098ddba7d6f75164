// Learning curves of the ladder: the interquartile mean over seeds of training returns by steps, with
// its 95 % bootstrap interval (Agarwal et al., "Deep reinforcement learning at the edge of the
// statistical precipice", NeurIPS 2021).
//
//   ladder_curves LADDER.json FOLDER      FOLDER/ladder_<rung>.svg for each row that has curves
#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "agents/learning_curve.h"
#include "cli/svg_chart.h"
#include "data/base/atomic_file.h"

namespace sandwright {
namespace {

Chart CurveOf(const nlohmann::json& row) {
  const nlohmann::json& seeds = row.at("seeds");
  const size_t points = seeds[0].at("curve").size();
  const double stretch = row.at("steps").get<double>() / static_cast<double>(points);
  ChartSeries mean{.name = fmt::format("{} {}: {} seeds, 95 % interval",
                                       row.at("algorithm").get<std::string>(),
                                       row.at("reference").get<std::string>(), seeds.size()),
                   .colour = "#1f6fb4",
                   .markers = false};
  RandomStream stream(1, StreamId("learning curve"));
  for (size_t i = 0; i < points; ++i) {
    std::vector<double> values;
    for (const nlohmann::json& seed : seeds)
      if (const auto& value = seed.at("curve")[i]; !value.is_null()) values.push_back(value);
    if (values.empty()) continue;
    const Spread spread = SpreadOf(values, stream);
    mean.x.push_back((static_cast<double>(i) + 0.5) * stretch);
    mean.y.push_back(spread.iqm);
    mean.low.push_back(spread.low95), mean.high.push_back(spread.high95);
  }
  Chart chart{.x_label = "steps", .y_label = "return", .series = {mean}, .from_zero = false};
  if (row.contains("published")) {
    const nlohmann::json& published = row["published"].back();
    chart.reference_y = published.at("mean");
    chart.reference_name = published.at("source");
  }
  return chart;
}

int Run(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: ladder_curves LADDER.json FOLDER\n");
    return 2;
  }
  const auto ladder = nlohmann::json::parse(ReadFile(argv[1]));
  for (const nlohmann::json& row : ladder.at("rows")) {
    if (!row.at("seeds").at(0).contains("curve")) continue;
    const auto file = std::filesystem::path(argv[2]) /
                      fmt::format("ladder_{}.svg", row.at("rung").get<std::string>());
    WriteFileAtomically(file, DrawChartFile(CurveOf(row)));
    fmt::print("{}\n", file.string());
  }
  return 0;
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) {
  try {
    return sandwright::Run(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "ladder_curves: {}\n", e.what());
    return 1;
  }
}
