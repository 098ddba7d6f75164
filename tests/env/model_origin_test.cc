#include "env/model_origin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

nlohmann::json Part(int strokes, const std::string& bed, const std::string& sha256) {
  return {{"strokes", strokes}, {"beds", {bed}}, {"files_sha256", {{bed + ".h5", sha256}}}};
}

Safetensors Model(const nlohmann::json& data) {
  Safetensors model;
  model.metadata["data"] = data.dump();
  return model;
}

TEST(ModelOrigin, KnowsWhatTheModelsBeforeItHaveSeen) {
  const nlohmann::json first = {{"training", Part(40, "a", "1")}, {"validation", Part(10, "b", "2")}};
  const nlohmann::json second = {{"training", Part(12, "c", "3")}, {"init", first}};
  const ModelOrigin origin = OriginOf(Model(second), "m.safetensors");
  EXPECT_EQ(origin.strokes, 12);
  EXPECT_THAT(origin.beds, ElementsAre("a", "b", "c"));
  EXPECT_THAT(origin.files_sha256, ElementsAre("1", "2", "3"));
}

TEST(ModelOrigin, SaysNothingWhereTheFileDoes) {
  const ModelOrigin origin = OriginOf({}, "m.safetensors");
  EXPECT_FALSE(origin.strokes.has_value());
  EXPECT_TRUE(origin.beds.empty());
  Safetensors broken;
  broken.metadata["data"] = "[]";
  EXPECT_THROW(OriginOf(broken, "m.safetensors"), Error);
  EXPECT_THROW(OriginOf(Model({{"training", {{"beds", 3}}}}), "m.safetensors"), Error);
}

TEST(ModelOrigin, NamesEachFileThatCannotJudge) {
  const std::filesystem::path seen = std::string(SANDWRIGHT_ROOT) + "/data/strokes/dem/bed_501.h5",
                              sister = std::string(SANDWRIGHT_ROOT) + "/data/strokes/dem/bed_502.h5",
                              fresh = std::string(SANDWRIGHT_ROOT) + "/data/strokes/dem/bed_503.h5";
  const auto origin = OriginOf(
      Model({{"training", Part(8, "bed_502", Sha256Hex(ReadFile(seen)))}}), "m.safetensors");
  const std::vector<std::filesystem::path> files = {seen, sister, fresh};
  EXPECT_THAT(SeenBefore(origin, files),
              ElementsAre(HasSubstr("bed_501.h5: the model was trained or chosen on this file"),
                          HasSubstr("bed_502.h5: the model was trained or chosen on other strokes")));
}

}  // namespace
}  // namespace sandwright
