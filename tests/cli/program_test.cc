// The program as a user meets it: exit codes, messages, files that are never half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "data/height_map.h"
#include "data/stroke_dataset.h"
#include "data/task.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Finished {
  int exit_code;
  std::string output;  // stdout and stderr
};

// SANDWRIGHT_PROGRAM comes from CMake.
Finished Invoke(const std::string& arguments, const std::string& before = "") {
  const std::string line = before + SANDWRIGHT_PROGRAM " " + arguments + " 2>&1";
  FILE* pipe = ::popen(line.c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer;
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), output};
}

class ProgramTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(::testing::TempDir()) /
        ("program_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  // Files in the test's folder, hidden ones too.
  std::vector<std::string> Files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      names.push_back(entry.path().filename().string());
    return names;
  }
  std::filesystem::path folder_;
};

TEST_F(ProgramTest, HelpNamesEverySubcommandAndItsKeys) {
  const Finished help = Invoke("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* name : {"scan", "collect", "fit", "score", "simulate", "train", "eval", "tasks",
                           "plan", "check", "export", "demo"}) {
    EXPECT_THAT(help.output, HasSubstr(name));
    EXPECT_EQ(Invoke(std::string(name) + " --help").exit_code, 0) << name;
  }
  EXPECT_THAT(Invoke("tasks --help").output,
              AllOf(HasSubstr("--seed"), HasSubstr("--json"), HasSubstr("tasks.difficulty_low_m")));
}

TEST_F(ProgramTest, BadUsageExitsWith2AndNamesTheCure) {
  EXPECT_EQ(Invoke("").exit_code, 2);
  EXPECT_EQ(Invoke("frobnicate").exit_code, 2);
  const Finished unknown =
      Invoke("tasks --generate --out " + Path("t.h5") + " tasks.dificulty_low_m=0.1");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("did you mean 'tasks.difficulty_low_m'?"));
  const Finished range = Invoke("tasks --generate --out " + Path("t.h5") + " tasks.max_strokes=0");
  EXPECT_EQ(range.exit_code, 2);
  EXPECT_THAT(range.output, HasSubstr("tasks.max_strokes = 0 is not allowed; allowed: 1..10000"));
  EXPECT_THAT(Files(), ::testing::IsEmpty());
}

TEST_F(ProgramTest, UnwritableOutputIsNamedAndNothingIsLeft) {
  const Finished run = Invoke("tasks --generate --count 1 --out " + Path("no/such/folder/t.h5"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, HasSubstr("no/such/folder/t.h5"));
  EXPECT_THAT(Files(), ::testing::IsEmpty());
}

TEST_F(ProgramTest, ResultsCarryConfigSeedAndMachine) {
  const Finished run = Invoke("tasks --generate --count 2 --seed 5 --out " + Path("t.h5") +
                              " --json " + Path("r.json") + " tasks.max_strokes=7");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto result = nlohmann::json::parse(ReadFile(Path("r.json")));
  EXPECT_EQ(result["seed"], 5);
  EXPECT_EQ(result["config"]["tasks"]["max_strokes"], 7);
  EXPECT_FALSE(result["machine"]["cpu"].get<std::string>().empty());
  EXPECT_EQ(ReadTasks(Path("t.h5")).size(), 2u);
  // The same seed gives the same bytes, whatever the thread count.
  const std::string first = ReadFile(Path("t.h5"));
  ASSERT_EQ(Invoke("tasks --generate --count 2 --seed 5 --threads 1 --out " + Path("t.h5") +
                   " tasks.max_strokes=7")
                .exit_code,
            0);
  EXPECT_EQ(ReadFile(Path("t.h5")), first);
}

TEST_F(ProgramTest, AFailedRunReplacesNothing) {
  WriteFileAtomically(Path("terrain.h5"), "not a height map");
  WriteFileAtomically(Path("t.h5"), "precious");
  const Finished run =
      Invoke("tasks --terrain " + Path("terrain.h5") + " --goals mound --out " + Path("t.h5"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, HasSubstr("terrain.h5: not an HDF5 file"));
  EXPECT_EQ(ReadFile(Path("t.h5")), "precious");
}

TEST_F(ProgramTest, CollectKeepsWhatIsDoneAndContinuesToTheSameBytes) {
  const std::string flags =
      "collect --source heightfield --strokes 600 --sequence 6 --seed 3 --threads 1 --out ";
  // Interrupted in the middle (SIGINT after a while), then continued.
  const Finished first = Invoke(flags + Path("a"), "timeout -s INT 2 ");
  EXPECT_THAT(first.exit_code, ::testing::AnyOf(130, 124, 0)) << first.output;
  const size_t kept = Files().empty() ? 0 : FindStrokeFiles({Path("a")}).size();
  EXPECT_GE(kept, 1u);
  for (const auto& file : FindStrokeFiles({Path("a")})) EXPECT_NO_THROW(ReadStrokeFile(file));
  ASSERT_EQ(Invoke(flags + Path("a")).exit_code, 0);
  ASSERT_EQ(Invoke(flags + Path("b")).exit_code, 0);
  const auto a = FindStrokeFiles({Path("a")}), b = FindStrokeFiles({Path("b")});
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(ReadFile(a[i]), ReadFile(b[i])) << a[i];
}

}  // namespace
}  // namespace sandwright
