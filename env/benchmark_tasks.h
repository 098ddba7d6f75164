// Fixed sets of tasks, the same for everybody, to compare agents on.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "env/task_generator.h"

namespace sandwright {

// Drawn from streams of their own, so no seed of training or evaluation yields one of them.
inline constexpr uint64_t kBenchmarkTasks = StreamId("benchmark task");
static_assert(kBenchmarkTasks != kTrainingTasks && kBenchmarkTasks != kEvaluationTasks &&
              kBenchmarkTasks != StreamId("validation task"));

// A change of any task is another version.
inline constexpr int kBenchmarkVersion = 1;
inline constexpr int kBenchmarkSize = 100;

// easy:    hills and simple shapes, the whole bed counts
// hard:    beds worked by strokes, letters among the goals, a part of the bed counts, more to move
// scanned: terrains as a Kinect v2 and the scan see smooth and worked beds
// real:    the terrains are cut from real scans
inline constexpr std::array<std::string_view, 4> kBenchmarkNames = {"easy", "hard", "scanned",
                                                                    "real"};

struct Benchmark {
  std::string id;  // name and version: "easy-1"
  std::vector<Task> tasks;
};

// What a set's tasks are drawn by, all on 300 x 300 mm with cells of 10 mm. Throws Error that lists the
// names where there is no such set.
TaskConfig BenchmarkConfig(const std::string& name);

// The kBenchmarkSize tasks of a set but `real`; the same bytes for any number of threads.
Benchmark MakeBenchmark(const std::string& name, int threads);

// Set `real` from accepted scans: pieces of 300 x 300 mm at random places, turn by turn. What lies under real
// sand is not known: a piece is laid on a floor so that its sand is 80 mm deep on average. Throws Error
// where no scan has such a piece with sand above the floor everywhere and a goal error in range.
Benchmark MakeRealBenchmark(std::span<const HeightMap> scans);

}  // namespace sandwright
