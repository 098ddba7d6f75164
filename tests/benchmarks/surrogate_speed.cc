// What a stroke of the surrogate costs, part by part: processor time of one thread on recorded
// strokes, and whole batches by threads. Floating-point rates stand beside the machine's peak.
//
//   surrogate_speed OUT.json MODEL.safetensors... -- STROKES.h5...
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "data/base/machine.h"
#include "data/stroke_dataset.h"
#include "env/surrogate.h"
#include "env/surrogate_encoding.h"

namespace sandwright {
namespace {

constexpr int kRepetitions = 15;

double ThreadTime_ms() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double WallTime_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// Best of several runs by the clock that is given.
double Best_ms(double (*clock)(), const std::function<void()>& work) {
  double best_ms = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRepetitions; ++i) {
    const double start_ms = clock();
    work();
    best_ms = std::min(best_ms, clock() - start_ms);
  }
  return best_ms;
}

// Chains of multiply-adds in registers, `kLanes` floats in each; returns how many operations.
template <int kLanes>
[[gnu::always_inline]] inline double MultiplyAdd(int rounds, float& result) {
  typedef float Vector [[gnu::vector_size(kLanes * sizeof(float))]];
  constexpr int kChains = 12;
  const Vector factor = Vector{} + 0.5f, term = Vector{} + result;
  Vector sums[kChains];
#pragma GCC unroll 12
  for (int i = 0; i < kChains; ++i) sums[i] = Vector{} + static_cast<float>(i);
  for (int round = 0; round < rounds; ++round) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) sums[i] = sums[i] * factor + term;
  }
  Vector sum = sums[0];
#pragma GCC unroll 12
  for (int i = 1; i < kChains; ++i) sum += sums[i];
  float first;
  std::memcpy(&first, &sum, sizeof first);
  result += first;
  return 2.0 * kChains * kLanes * rounds;
}

double MultiplyAddPlain(int rounds, float& result) { return MultiplyAdd<4>(rounds, result); }
#ifdef __x86_64__
[[gnu::target("avx2,fma")]] double MultiplyAddAvx2(int rounds, float& result) {
  return MultiplyAdd<8>(rounds, result);
}
[[gnu::target("avx512f,fma")]] double MultiplyAddAvx512(int rounds, float& result) {
  return MultiplyAdd<16>(rounds, result);
}
#endif

// Single precision, one thread [GFLOP/s].
double Peak_gflops() {
  auto* run = MultiplyAddPlain;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f"))
    run = MultiplyAddAvx512;
  else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    run = MultiplyAddAvx2;
#endif
  constexpr int kRounds = 200000;
  double operations = 0;
  volatile float sink = 0;
  const double ms = Best_ms(ThreadTime_ms, [&] {
    float result = sink;
    operations = run(kRounds, result);
    sink = result;
  });
  return 1e-6 * operations / ms;
}

struct Strokes {
  std::vector<SandState> before;
  std::vector<ToolPath> paths;
};

Strokes ReadStrokes(const std::vector<std::filesystem::path>& files, double cell_size_m) {
  Strokes strokes;
  for (const auto& file : files) {
    for (const StrokeRecord& record : ReadStrokeFile(file).strokes) {
      strokes.before.emplace_back(Resample(record.before, cell_size_m));
      strokes.paths.push_back(record.path);
    }
  }
  return strokes;
}

nlohmann::json Measure(const std::filesystem::path& file,
                       const std::vector<std::filesystem::path>& data, double peak_gflops) {
  const Surrogate model = ReadSurrogate(file, 1);
  const SurrogateConfig& config = model.config();
  const SurrogateNet net(config.net, ReadSafetensors(file), file.string());
  const Heightfield heightfield(config.heightfield);
  const Strokes strokes = ReadStrokes(data, config.cell_size_m);
  const auto count = static_cast<double>(strokes.paths.size());
  double encode_ms = 0, heightfield_ms = 0, net_ms = 0, all_ms = 0, flops = 0;
  for (size_t i = 0; i < strokes.paths.size(); ++i) {
    std::vector<SandState> after;
    heightfield_ms += Best_ms(ThreadTime_ms, [&] {
      after = {strokes.before[i]};
      heightfield.Apply(after, std::span(&strokes.paths[i], 1));
    });
    SurrogateInput input;
    encode_ms += Best_ms(ThreadTime_ms, [&] {
      input = EncodeStroke(strokes.before[i].map(), after[0].map(), strokes.paths[i], model.blade(),
                           config.net.multiple(), config.reach_m);
    });
    const ActiveCells active(input.rows, input.columns, input.active);
    net_ms += Best_ms(ThreadTime_ms, [&] { net.Forward(input.channels, active); });
    flops += net.Flops(active);
    all_ms += Best_ms(ThreadTime_ms, [&] {
      after = {strokes.before[i]};
      model.Apply(after, std::span(&strokes.paths[i], 1));
    });
  }
  nlohmann::json row = {{"model", file.filename().string()},
                        {"cell_size_m", config.cell_size_m},
                        {"strokes", strokes.paths.size()},
                        {"heightfield_ms", heightfield_ms / count},
                        {"encode_ms", encode_ms / count},
                        {"net_ms", net_ms / count},
                        {"end_to_end_ms", all_ms / count},
                        {"net_mflop", 1e-6 * flops / count},
                        {"net_gflops", 1e-6 * flops / net_ms},
                        {"net_share_of_peak", 1e-6 * flops / net_ms / peak_gflops}};
  for (const int threads : {1, 2}) {
    const Surrogate threaded = ReadSurrogate(file, threads);
    for (const size_t batch : {size_t{1}, size_t{20}, size_t{64}}) {
      std::vector<SandState> before;
      std::vector<ToolPath> paths;
      for (size_t i = 0; i < batch; ++i) {
        before.push_back(strokes.before[i % strokes.before.size()]);
        paths.push_back(strokes.paths[i % strokes.paths.size()]);
      }
      row["batch_ms"].push_back(
          {{"threads", threads}, {"batch", batch}, {"ms", Best_ms(WallTime_ms, [&] {
                                                      std::vector<SandState> states = before;
                                                      threaded.Apply(states, paths);
                                                    })}});
    }
  }
  return row;
}

void Main(int count, char** arguments) {
  std::vector<std::filesystem::path> models, data;
  bool behind = false;
  for (int i = 2; i < count; ++i) {
    if (std::string_view(arguments[i]) == "--")
      behind = true;
    else
      (behind ? data : models).emplace_back(arguments[i]);
  }
  if (models.empty() || data.empty())
    throw Error("usage: surrogate_speed OUT.json MODEL.safetensors... -- STROKES.h5...");
  double load = 0;
  if (getloadavg(&load, 1) != 1) load = -1;
  const double peak_gflops = Peak_gflops();
  fmt::print("peak {:.1f} GFLOP/s\n", peak_gflops);
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& model : models) {
    rows.push_back(Measure(model, data, peak_gflops));
    fmt::print("{}\n", rows.back().dump());
  }
  WriteFileAtomically(arguments[1], nlohmann::json{{"machine", MachineDescription()},
                                                   {"commit", BuildCommit()},
                                                   {"load", load},
                                                   {"peak_gflops", peak_gflops},
                                                   {"clock",
                                                    "best of 15; parts: processor time of the "
                                                    "thread; batches: wall clock"},
                                                   {"rows", rows}}
                                            .dump(1) +
                                        "\n");
}

}  // namespace
}  // namespace sandwright

int main(int count, char** arguments) {
  try {
    sandwright::Main(count, arguments);
  } catch (const std::exception& e) {
    fmt::print(stderr, "surrogate_speed: {}\n", e.what());
    return 1;
  }
}
