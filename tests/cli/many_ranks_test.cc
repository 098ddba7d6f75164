// Training on several processes that mpirun started, as a user starts them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "agents/run_folder.h"
#include "env/safetensors.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kTask =
    " device=cpu reference=Pendulum-v1 env.num_envs=4 network.hidden=8 network.normalize=true"
    " evaluation_tasks=2 evaluate_every=0 ppo.num_steps=16 ppo.minibatch_size=24";

std::filesystem::path Folder(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  return folder;
}

// More processes than cores, started by whoever runs the tests: both have to be allowed.
const std::string kMpirun =
    "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1 " SANDWRIGHT_MPIRUN
    " --oversubscribe ";

class ManyRanks : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::string(SANDWRIGHT_MPIRUN).empty()) GTEST_SKIP() << "built without MPI";
  }
};

size_t Times(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST_F(ManyRanks, TwoAreOne) {
  const auto one = Folder("one"), two = Folder("two");
  const std::string rest = std::string(kTask) + " total_steps=64 --seed 5 --threads 1 --out ";
  const Finished alone = Invoke("train" + rest + one.string());
  ASSERT_EQ(alone.exit_code, 0) << alone.output;
  const Finished spread = Invoke("train" + rest + two.string(), kMpirun + "-n 2 ");
  ASSERT_EQ(spread.exit_code, 0) << spread.output;
  EXPECT_EQ(Times(spread.output, "64 steps in"), 1u) << spread.output;
  const Safetensors a = ReadSafetensors(one / "agent.safetensors"),
                    b = ReadSafetensors(two / "agent.safetensors");
  for (const auto& [name, tensor] : a.tensors)
    for (size_t i = 0; i < tensor.values.size(); ++i)
      ASSERT_NEAR(tensor.values[i], b.Tensor(name, "two").values.at(i), 1e-5) << name;
}

TEST_F(ManyRanks, ADifferentStartIsOneError) {
  const auto folder = Folder("different");
  const auto part = [&](int seed) {
    return "-n 1 " SANDWRIGHT_PROGRAM " train" + std::string(kTask) + " total_steps=64 --seed " +
           std::to_string(seed) + " --out " + folder.string();
  };
  const Finished run = Shell(kMpirun + part(5) + " : " + part(6));
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_EQ(Times(run.output, "rank 1 differs from rank 0 at the start: --seed is 6 there, 5 here"), 1u)
      << run.output;
  EXPECT_EQ(Times(run.output, "error:"), 1u) << run.output;
}

// Trains on two ranks and kills number `lost` in the middle of it.
Finished Kill(int lost, const std::string& options, const std::filesystem::path& folder) {
  const std::string run = kMpirun + options + " -n 2 " SANDWRIGHT_PROGRAM " train" + kTask +
                          " total_steps=100000000 checkpoint_every=0 lost_rank_after_s=2 --threads 1 --out " +
                          folder.string();
  std::thread killer([&] {
    // The first update is over where the log has a row; the ranks say in their environment who they are.
    const std::string csv = (folder / "progress.csv").string();
    Shell("for i in $(seq 600); do [ $(cat " + csv + " 2>/dev/null | wc -l) -gt 3 ] && break; sleep 0.1; done; "
          "for p in $(pgrep -f -- '--out " + folder.string() + "'); do "
          "tr '\\0' '\\n' < /proc/$p/environ | grep -qx OMPI_COMM_WORLD_RANK=" + std::to_string(lost) +
          " && kill -9 $p; done");
  });
  const Finished finished = Shell(run);
  killer.join();
  return finished;
}

class ALostRank : public ManyRanks, public ::testing::WithParamInterface<int> {};

TEST_P(ALostRank, LeavesACheckpointThatTheRunGoesOnFrom) {
  const auto folder = Folder("lost_" + std::to_string(GetParam()));
  const Finished run = Kill(GetParam(), "", folder);
  EXPECT_NE(run.exit_code, 0);
  EXPECT_EQ(Times(run.output, "the last complete update is kept"), 1u) << run.output;
  const auto checkpoint = LastCheckpoint(folder);
  const int64_t steps = std::stoll(checkpoint.stem().string());
  EXPECT_GE(steps, 64);
  const Finished on = Invoke("train --resume " + folder.string() + " checkpoint_every=64 total_steps=" +
                             std::to_string(steps + 64));
  EXPECT_EQ(on.exit_code, 0) << on.output;
}

INSTANTIATE_TEST_SUITE_P(Either, ALostRank, ::testing::Values(0, 1));

TEST(OneProcess, OfSeveralIsRefusedWithoutMpi) {
  if (!std::string(SANDWRIGHT_MPIRUN).empty()) GTEST_SKIP() << "built with MPI";
  const Finished run = Invoke("train" + std::string(kTask) + " --out " + Folder("without").string(),
                              "OMPI_COMM_WORLD_SIZE=2 ");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, HasSubstr("built without MPI"));
}

}  // namespace
}  // namespace sandwright
