// What the sum of a gradient over ranks costs, by the number of its parameters.
//
//   mpirun -n RANKS rank_figures OUT.json
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "agents/join_ranks.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/machine.h"

namespace sandwright {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRounds = 400;

// Quantiles, as a machine that is busy with other work gives outliers of milliseconds.
nlohmann::json SumTimes(Collective& ranks, size_t parameters) {
  std::vector<float> gradient(parameters, 1.0f);
  std::vector<double> ms;
  for (int round = 0; round < kRounds; ++round) {
    std::ranges::fill(gradient, 1.0f);
    ranks.Gather({});  // all start together
    const auto start = Clock::now();
    ranks.Sum(gradient);
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  SAND_CHECK(gradient.back() == static_cast<float>(ranks.size()), gradient.back());
  std::ranges::sort(ms);
  const auto quantile = [&](double share) {
    return std::round(1e4 * ms[static_cast<size_t>(share * (kRounds - 1))]) / 1e4;
  };
  return {{"parameters", parameters},
          {"ms_least", quantile(0)},
          {"ms_tenth", quantile(0.1)},
          {"ms_median", quantile(0.5)},
          {"ms_nine_tenths", quantile(0.9)}};
}

int Main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: mpirun -n RANKS rank_figures OUT.json\n"), 2;
  const auto ranks = JoinRanks(60);
  auto rows = nlohmann::json::array();
  for (const size_t parameters : {1000, 10000, 34000, 100000, 300000, 1000000})
    rows.push_back(SumTimes(*ranks, parameters));
  const nlohmann::json result = {{"ranks", ranks->size()},
                                 {"rounds", kRounds},
                                 {"sums", rows},
                                 {"commit", BuildCommit()},
                                 {"machine", MachineDescription()}};
  if (ranks->leads()) WriteFileAtomically(argv[1], result.dump(1) + "\n");
  ranks->Leave();
  return 0;
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) {
  try {
    return sandwright::Main(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
