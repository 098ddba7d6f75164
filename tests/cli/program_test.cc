// The program as a user meets it: exit codes, messages, files that are never half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "data/base/atomic_file.h"
#include "data/depth_frame.h"
#include "data/height_map.h"
#include "data/stroke_dataset.h"
#include "data/task.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::Field;
using ::testing::HasSubstr;

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
                           "plan", "check", "export", "promote", "demo", "convert", "goal"}) {
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

TEST_F(ProgramTest, TaskSetsAreFixed) {
  const auto make = [&](const std::string& name, const std::string& more) {
    return Invoke("tasks --set easy --out " + Path(name) + more);
  };
  const Finished run = make("a.h5", " --threads 1 --picture " + Path("a.png") + " --json " + Path("a.json"));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  ASSERT_EQ(make("b.h5", " --threads 3").exit_code, 0);
  EXPECT_EQ(ReadFile(Path("a.h5")), ReadFile(Path("b.h5")));
  EXPECT_TRUE(ReadFile(Path("a.png")).starts_with("\x89PNG"));
  const auto json = nlohmann::json::parse(ReadFile(Path("a.json")));
  EXPECT_EQ(json["benchmark"], "easy-1");
  EXPECT_EQ(json["content_sha256"], TasksSha256(ReadTasks(Path("a.h5"))));
  const auto refused = [&](const std::string& arguments, const std::string& text) {
    EXPECT_THAT(Invoke("tasks --out " + Path("c.h5") + " " + arguments),
                AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr(text))));
  };
  refused("--set medium", "task set \"medium\" is unknown; allowed: easy, hard, scanned, real");
  refused("--set easy --seed 3", "--set easy is fixed: --seed and the keys tasks have no effect");
  refused("--set easy tasks.max_strokes=3", "--set easy is fixed");
  refused("--set easy --scans " + Path(""), "--scans DIR belongs to --set real");
  refused("--set easy --picture " + Path("a.jpg"), "the name must end in .png");
  refused("--set real", "--scans DIR belongs to --set real");
  refused("--set real --scans " + Path("none"), "none: no such folder");
  EXPECT_FALSE(std::filesystem::exists(Path("c.h5")));
}

TEST_F(ProgramTest, DrawingsBecomeGoals) {
  cv::Mat grey = cv::Mat::zeros(60, 60, CV_8U);
  cv::circle(grey, {30, 30}, 15, cv::Scalar(255), cv::FILLED);
  cv::imwrite(Path("disc.png"), grey);
  WriteHeightMap(HeightMap(30, 30, 0.01, 0.05f), Path("bed.h5"));
  const std::string flags = " --out " + Path("t.h5") + " --goal-image " + Path("disc.png");
  ASSERT_EQ(Invoke("tasks --terrain " + Path("bed.h5") + flags + " --range-mm 15").exit_code, 0);
  const Task task = ReadTasks(Path("t.h5")).at(0);
  EXPECT_NEAR(task.goal.At(15, 15) - task.goal.At(1, 1), 0.015, 1e-4);
  ASSERT_EQ(Invoke("tasks --generate --count 3" + flags + " --range-mm 15").exit_code, 0);
  EXPECT_EQ(ReadTasks(Path("t.h5")).size(), 3u);
  EXPECT_EQ(Invoke("tasks --generate" + flags).exit_code, 2);  // how high?
  EXPECT_THAT(Invoke("tasks --generate" + flags + " --range-mm 0").output,
              HasSubstr("--range-mm 0 makes nothing of a drawing"));
  cv::cvtColor(grey, grey, cv::COLOR_GRAY2BGR);
  cv::imwrite(Path("disc.png"), grey);
  EXPECT_THAT(Invoke("tasks --generate" + flags + " --range-mm 15"),
              AllOf(Field(&Finished::exit_code, 2),
                    Field(&Finished::output, HasSubstr("disc.png: a drawing is grey"))));
}

// A goal of a file must fit its terrain.
TEST_F(ProgramTest, GoalsThatDoNotFitAreNamed) {
  WriteHeightMap(HeightMap(30, 30, 0.01, 0.05f), Path("bed.h5"));
  const auto refused = [&](const HeightMap& goal, const std::string& text) {
    WriteHeightMap(goal, Path("goal.h5"));
    EXPECT_THAT(Invoke("tasks --terrain " + Path("bed.h5") + " --goal " + Path("goal.h5") +
                       " --out " + Path("t.h5")),
                AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr(text))));
  };
  refused(HeightMap(40, 30, 0.01, 0.05f), "30 x 30 cells of 0.01 m, the goal 40 x 30 of 0.01 m");
  refused(HeightMap(30, 30, 0.02, 0.05f), "the goal 30 x 30 of 0.02 m");
  refused(HeightMap(30, 30, 0.01, -0.002f), "the goal reaches 2.0 mm below the floor");
  refused(HeightMap(30, 30, 0.01, 0.0f), "the goal holds no sand");
  HeightMap masked(30, 30, 0.01, 0.05f);
  masked.mask.assign(900, 0);
  refused(masked, "the goal counts no cell");
  EXPECT_FALSE(std::filesystem::exists(Path("t.h5")));
}

TEST_F(ProgramTest, BenchPutsSpeedBesideError) {
  const Finished bench =
      Invoke("bench --suite sand --threads 1 --data " SANDWRIGHT_ROOT
             "/data/strokes/dem/bed_504.h5 --json " + Path("bench.json"));
  ASSERT_EQ(bench.exit_code, 0) << bench.output;
  const auto json = nlohmann::json::parse(ReadFile(Path("bench.json")));
  EXPECT_TRUE(json["machine"].contains("isa"));
  int exact = 0, strokes = 0;
  for (const auto& row : json["rows"]) {
    EXPECT_EQ(row["suite"], "sand");
    EXPECT_GT(row["ms_per_stroke"], 0.0) << row;
    const std::string name = row["name"];
    exact += name.starts_with("exact: ") && row.contains("rmse_mm");
    strokes += name.starts_with("strokes: ") && row.contains("r2_change") && row.contains("mae_mm");
  }
  EXPECT_EQ(exact, 26);
  EXPECT_EQ(strokes, 6);  // none, heightfield on four grids, the shipped surrogate
  EXPECT_EQ(Invoke("bench --suite agents").exit_code, 2);  // not measured yet, so not offered
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

TEST_F(ProgramTest, ConfigurationFilesAreCheckedAndOverridden) {
  const std::string flags = "tasks --generate --count 1 --out " + Path("t.h5") + " --config ";
  EXPECT_THAT(
      Invoke(flags + Path("none.yaml")),
      AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr("none.yaml"))));
  WriteFileAtomically(Path("c.yaml"), "tasks: {cell_size: 0.01}\n");
  EXPECT_THAT(Invoke(flags + Path("c.yaml")),
              AllOf(Field(&Finished::exit_code, 2),
                    Field(&Finished::output, HasSubstr("did you mean 'tasks.cell_size_m'?"))));
  WriteFileAtomically(Path("c.yaml"), "tasks: {max_strokes: 5, cell_size_m: 0.02}\n");
  ASSERT_EQ(Invoke(flags + Path("c.yaml") + " tasks.max_strokes=6").exit_code, 0);
  EXPECT_EQ(ReadTasks(Path("t.h5"))[0].max_strokes, 6);
  EXPECT_EQ(ReadTasks(Path("t.h5"))[0].terrain.cell_size_m, 0.02);
}

TEST_F(ProgramTest, UnwritableResultsAreSaidBeforeTheWork) {
  const Finished json =
      Invoke("tasks --generate --out " + Path("t.h5") + " --json " + Path("no/r.json"));
  EXPECT_EQ(json.exit_code, 2);
  EXPECT_THAT(json.output, HasSubstr("no/r.json"));
  EXPECT_THAT(Files(), ::testing::IsEmpty());
  WriteFileAtomically(Path("file"), "in the way");
  EXPECT_THAT(
      Invoke("collect --strokes 1 --out " + Path("file/beds")),
      AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr("file/beds"))));
  EXPECT_THAT(
      Invoke("demo --out " + Path("file/demo")),
      AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr("file/demo"))));
}

TEST_F(ProgramTest, BadStrokesAreNamedAndUnsafeOnesRefused) {
  WriteHeightMap(HeightMap(80, 120, 0.01, 0.05f), Path("bed.h5"));
  const auto plan = [&](const std::string& points) {
    WriteFileAtomically(Path("plan.yaml"),
                        "schema: sandwright-plan\nschema_version: 1\nframe: box\nstrokes:\n"
                        "  - {control_points_m: [" +
                            points + "], degree: 1, speed_mps: 0.1}\n");
  };
  const auto simulate = [&](const std::string& points) {
    plan(points);
    return Invoke("simulate --terrain " + Path("bed.h5") + " --strokes " + Path("plan.yaml") +
                  " --out " + Path("after.h5"));
  };
  const std::string a = "[0.5, 0.4, 0.03]", b = "[0.6, 0.4, 0.03]";
  for (const auto& [points, message] : {std::pair{a, "has 1 points; allowed: 2..4"},
                                        {a + "," + b + "," + a + "," + b + "," + a, "has 5 points"},
                                        {a + "," + a, "points 0 and 1 are 0 m apart"},
                                        {a + ", [.nan, 0.4, 0.03]", "must be finite"}}) {
    const Finished run = simulate(points);
    EXPECT_EQ(run.exit_code, 2) << message;
    EXPECT_THAT(run.output, AllOf(HasSubstr("strokes[0]"), HasSubstr(message)));
  }
  EXPECT_FALSE(std::filesystem::exists(Path("after.h5")));

  for (const auto& [points, reason] :
       {std::pair{a + ", [0.7, 0.4, -0.004]", "below the box floor"},
        {"[1.1, 0.4, 0.03], [1.25, 0.4, 0.03]", "beyond the box wall"}}) {
    plan(points);
    const std::string before = ReadFile(Path("plan.yaml"));
    const Finished run =
        Invoke("check --seal --plan " + Path("plan.yaml") + " --terrain " + Path("bed.h5") +
               " --workcell " SANDWRIGHT_ROOT "/configs/workcell.yaml --json " + Path("r.json"));
    EXPECT_EQ(run.exit_code, 3) << run.output;
    const auto result = nlohmann::json::parse(ReadFile(Path("r.json")));
    EXPECT_EQ(result["accepted"], false);
    EXPECT_THAT(result["reasons"].dump(), HasSubstr(reason));
    EXPECT_EQ(ReadFile(Path("plan.yaml")), before);
  }
}

TEST_F(ProgramTest, BadDepthFramesAreNamedAndOthersRefused) {
  const auto scan = [&](const DepthFrame& frame) {
    WriteDepthFrame(frame, Path("frame.png"));
    return Invoke("scan --depth " + Path("frame.png") + " --out " + Path("bed.h5") + " --json " +
                  Path("r.json"));
  };
  EXPECT_THAT(
      scan({64, 48, std::vector<float>(64 * 48, 1.2f)}),
      AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr("64 x 48 px"))));
  EXPECT_THAT(scan({512, 424, std::vector<float>(512 * 424, 0)}),
              AllOf(Field(&Finished::exit_code, 2),
                    Field(&Finished::output, HasSubstr("every pixel is 0"))));
  EXPECT_FALSE(std::filesystem::exists(Path("r.json")));
  EXPECT_EQ(scan({512, 424, std::vector<float>(512 * 424, 2)}).exit_code, 3);
  const auto result = nlohmann::json::parse(ReadFile(Path("r.json")));
  EXPECT_EQ(result["accepted"], false);
  EXPECT_FALSE(result["reasons"].empty());
  EXPECT_FALSE(std::filesystem::exists(Path("bed.h5")));
}

TEST_F(ProgramTest, CollectKeepsWhatIsDoneAndContinuesToTheSameBytes) {
  const std::string flags =
      "collect --source heightfield --strokes 300 --sequence 6 --seed 3 --threads 1 --out ";
  // Ctrl-C as soon as the third bed is begun (or after half a minute, in vain).
  const std::string wait = " & run=$!; for i in $(seq 3000); do [ -e " + Path("a/bed_00002.h5") +
                           " ] && break; sleep 0.01; done; kill -INT $run; wait $run )";
  const Finished first = Invoke(flags + Path("a"), "( ", wait);
  EXPECT_EQ(first.exit_code, 130) << first.output;
  EXPECT_LT(FindStrokeFiles({Path("a")}).size(), 50u);
  for (const auto& file : FindStrokeFiles({Path("a")})) EXPECT_NO_THROW(ReadStrokeFile(file));
  ASSERT_EQ(Invoke(flags + Path("a")).exit_code, 0);
  ASSERT_EQ(Invoke(flags + Path("b")).exit_code, 0);
  const auto a = FindStrokeFiles({Path("a")}), b = FindStrokeFiles({Path("b")});
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(ReadFile(a[i]), ReadFile(b[i])) << a[i];
}

}  // namespace
}  // namespace sandwright
