// Hours unattended: what a run says of itself, whom it tells of its end, and how a model is replaced.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kData = SANDWRIGHT_ROOT "/data/";

class UnattendedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(Path(name)));
  }
  // Writes what it is told to the file `told`.
  std::string Notify() const {
    return " 'notify.command=echo \"$SANDWRIGHT_EVENT|$SANDWRIGHT_TEXT|$SANDWRIGHT_FOLDER\" > " +
           Path("told") + "'";
  }
  std::filesystem::path folder_;
};

TEST_F(UnattendedTest, RunShowsItselfAndTellsOfItsEnd) {
  const Finished run = Invoke("collect --strokes 5 --out " + Path("beds") + Notify());
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const nlohmann::json status = Json("beds/status.json");
  EXPECT_EQ(status["command"], "collect");
  EXPECT_EQ(status["state"], "done");
  EXPECT_EQ(status["done"], 5);
  EXPECT_EQ(status["total"], 5);
  EXPECT_THAT(status["text"].get<std::string>(), HasSubstr("5 strokes in"));
  const std::string page = ReadFile(Path("beds/live.html"));
  EXPECT_THAT(page, AllOf(HasSubstr("http-equiv=\"refresh\""), HasSubstr("data:image/png;base64,"),
                          HasSubstr(status["updated"].get<std::string>()), Not(HasSubstr("src=\"http"))));
  EXPECT_EQ(ReadFile(Path("told")),
            "done|" + status["text"].get<std::string>() + "|" + Path("beds") + "\n");
}

TEST_F(UnattendedTest, StopIsTold) {
  const Finished run = Invoke("collect --strokes 1000000 --sequence 100 --threads 1 --out " +
                                  Path("beds") + Notify(),
                              "timeout --foreground -s INT 3 ");
  EXPECT_THAT(ReadFile(Path("told")), HasSubstr("stopped|stopped by the user|")) << run.output;
  EXPECT_EQ(Json("beds/status.json")["state"], "stopped");
}

TEST_F(UnattendedTest, RunThatNeverBeganLeavesTheStateOfTheOneBefore) {
  const std::string flags = "fit --data " + kData + "strokes/dem/bed_501.h5 --out " +
                            Path("m.safetensors") + Notify();
  WriteFileAtomically(Path("m.safetensors.status.json"), "of the run before");
  const Finished run = Invoke(flags + " --validation " + kData + "strokes/dem/bed_501.h5");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(ReadFile(Path("m.safetensors.status.json")), "of the run before");
  EXPECT_THAT(ReadFile(Path("told")), AllOf(HasSubstr("failed|bed '"), HasSubstr("m.safetensors")));
}

TEST_F(UnattendedTest, CommandThatFailsIsAWarning) {
  const Finished run =
      Invoke("collect --strokes 1 --out " + Path("beds") + " 'notify.command=echo no net; exit 7'");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.output, HasSubstr("notify.command ended with 7: no net"));
}

TEST_F(UnattendedTest, ModelIsReplacedOnlyByAProvablyBetterOne) {
  std::string beds;
  for (const char* bed : {"bed_706_0", "bed_706_1", "short_707_0", "short_708_0", "short_708_1"})
    beds += " " + kData + "strokes/dem/" + bed + ".h5";
  const std::string old_model = kData + "models/fast_surrogate.safetensors",
                    new_model = kData + "models/default_surrogate.safetensors";
  std::filesystem::copy_file(old_model, Path("rig.safetensors"));
  const auto promote = [&](const std::string& candidate, const std::string& data) {
    return Invoke("promote --floor-mm 1.43 --candidate " + candidate + " --current " +
                  Path("rig.safetensors") + " --out " + Path("rig.safetensors") + " --json " +
                  Path("r.json") + " --data " + data);
  };
  const Finished better = promote(new_model, beds);
  ASSERT_EQ(better.exit_code, 0) << better.output;
  EXPECT_EQ(ReadFile(Path("rig.safetensors")), ReadFile(new_model));
  EXPECT_EQ(ReadFile(Path("rig.previous.safetensors")), ReadFile(old_model));
  EXPECT_EQ(Json("r.json")["accepted"], true);
  EXPECT_EQ(Json("r.json")["difference"]["unit"], "beds");
  EXPECT_THAT(better.output, HasSubstr("it takes two models of this rig"));

  const Finished worse = promote(old_model, beds);
  EXPECT_EQ(worse.exit_code, 3) << worse.output;
  EXPECT_THAT(Json("r.json")["reasons"].dump(), HasSubstr("not provably better"));
  const Finished seen = promote(new_model, beds + " " + kData + "strokes/dem/bed_501.h5");
  EXPECT_EQ(seen.exit_code, 3) << seen.output;
  EXPECT_THAT(Json("r.json")["reasons"].dump(), HasSubstr("bed_501.h5: the model was trained"));
  EXPECT_EQ(ReadFile(Path("rig.safetensors")), ReadFile(new_model));
  EXPECT_EQ(ReadFile(Path("rig.previous.safetensors")), ReadFile(old_model));

  const Finished other = Invoke("promote --candidate " + new_model + " --current " + old_model +
                                " --data " + beds + " --out " + Path("rig.safetensors"));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("another model than --current"));
}

}  // namespace
}  // namespace sandwright
