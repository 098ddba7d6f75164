#include "data/base/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

struct InnerConfig {
  double clip_range = 0.2;
  std::string schedule = "linear";
  void Fields(FieldList& f) {
    f.Add("clip_range", clip_range, "clipping of the ratio", 0.0, 1.0);
    f.Add("schedule", schedule, "learning rate over time", {"const", "linear"});
  }
};
struct OuterConfig {
  int64_t total_steps = 1000;
  bool normalize = true;
  std::vector<double> size_m = {1.2, 0.8};
  InnerConfig ppo;
  void Fields(FieldList& f) {
    f.Add("total_steps", total_steps, "environment steps", 1);
    f.Add("normalize", normalize, "scale the observation");
    f.Add("size_m", size_m, "box [m]", 0.01, 10);
    f.Section("ppo", ppo);
  }
};

auto Fails(const std::string& text) {
  return Throws<Error>(Property(&Error::what, HasSubstr(text)));
}

class ConfigTest : public ::testing::Test {
 protected:
  void Override(const std::string& text) {
    ApplyOverrides(fields_, std::vector<std::string>{text});
  }
  OuterConfig config_;
  FieldList fields_ = FieldsOf(config_);
};

TEST_F(ConfigTest, OverridesReachNestedFields) {
  Override("ppo.clip_range=0.1");
  Override("total_steps=50000");
  Override("normalize=false");
  Override("size_m=[0.3, 0.3]");
  EXPECT_EQ(config_.ppo.clip_range, 0.1);
  EXPECT_EQ(config_.total_steps, 50000);
  EXPECT_FALSE(config_.normalize);
  EXPECT_THAT(config_.size_m, ::testing::ElementsAre(0.3, 0.3));
}

TEST_F(ConfigTest, UnknownKeySuggestsTheNearest) {
  EXPECT_THAT([&] { Override("ppo.clip_rage=0.1"); }, Fails("did you mean 'ppo.clip_range'?"));
  EXPECT_THAT([&] { Override("xyzzy_quux_frobnicate=1"); },
              Throws<Error>(Property(&Error::what, ::testing::Not(HasSubstr("did you mean")))));
}

TEST_F(ConfigTest, RangeTypeAndChoiceAreNamed) {
  EXPECT_THAT([&] { Override("ppo.clip_range=1.5"); },
              Fails("ppo.clip_range = 1.5 is not allowed; allowed: 0..1"));
  EXPECT_THAT([&] { Override("total_steps=0"); }, Fails("allowed: >= 1"));
  EXPECT_THAT([&] { Override("total_steps=many"); }, Fails("expected a whole number"));
  EXPECT_THAT([&] { Override("ppo.clip_range=.nan"); }, Fails("not allowed"));
  EXPECT_THAT([&] { Override("ppo.schedule=cosine"); }, Fails("allowed: const, linear"));
  EXPECT_THAT([&] { Override("size_m=[0.3, -1]"); }, Fails("size_m = -1"));
  EXPECT_THAT([&] { Override("total_steps"); }, Fails("key=value"));
}

TEST_F(ConfigTest, AnErrorChangesNothing) {
  const std::vector<std::string> overrides = {"total_steps=5", "ppo.clip_range=7"};
  EXPECT_THROW(ApplyOverrides(fields_, overrides), Error);
  EXPECT_EQ(config_.total_steps, 1000);
}

TEST_F(ConfigTest, ResolvedYamlLoadsBack) {
  Override("ppo.clip_range=0.125");
  Override("ppo.schedule=const");
  const std::string file = ::testing::TempDir() + "config_test.yaml";
  WriteFileAtomically(file, ToYaml(fields_));
  OuterConfig copy;
  LoadYaml(FieldsOf(copy), file);
  EXPECT_EQ(ToJson(FieldsOf(copy)), ToJson(fields_));
  OuterConfig from_json;
  LoadJson(FieldsOf(from_json), ToJson(fields_), "test");
  EXPECT_EQ(ToYaml(FieldsOf(from_json)), ToYaml(fields_));
}

TEST_F(ConfigTest, BadFilesNameTheFile) {
  EXPECT_THAT([&] { LoadYaml(fields_, "missing.yaml"); }, Fails("missing.yaml: no such file"));
  const std::string file = ::testing::TempDir() + "config_test_bad.yaml";
  WriteFileAtomically(file, "ppo: [1, 2\n");
  EXPECT_THAT([&] { LoadYaml(fields_, file); }, Fails("config_test_bad.yaml: not YAML"));
  WriteFileAtomically(file, "ppo:\n  clip_rang: 1\n");
  EXPECT_THAT([&] { LoadYaml(fields_, file); }, Fails("unknown key 'ppo.clip_rang'"));
  WriteFileAtomically(file, "? [1, 2]\n: 3\n");
  EXPECT_THAT([&] { LoadYaml(fields_, file); }, Fails("a key must be a word"));
}

TEST_F(ConfigTest, HelpStatesDefaultAndRange) {
  EXPECT_THAT(Help(fields_), HasSubstr("(default 0.2, 0..1)"));
  EXPECT_THAT(Help(fields_), HasSubstr("const | linear"));
}

}  // namespace
}  // namespace sandwright
