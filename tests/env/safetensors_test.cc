#include "env/safetensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

std::filesystem::path TestFile(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / name;
}

// A file with any header text and data.
std::filesystem::path Handmade(const std::string& header, const std::string& data) {
  const uint64_t length = header.size();
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  const auto file = TestFile("handmade.safetensors");
  std::ofstream(file, std::ios::binary) << bytes << header << data;
  return file;
}

std::string MessageOf(const std::filesystem::path& file) {
  try {
    ReadSafetensors(file);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(e.what(), HasSubstr(file.string()));
    return e.what();
  }
  return "no error";
}

Safetensors Sample() {
  Safetensors content;
  content.tensors["layer.weight"] = {{2, 3}, {1, 2, 3, 4, 5, -6.5f}};
  content.tensors["scale"] = {{}, {0.25f}};
  content.tensors["nothing"] = {{0, 4}, {}};
  content.metadata = {{"config", "{\"a\": 1}"}, {"commit", "\"quoted\" \n text"}};
  return content;
}

TEST(Safetensors, RoundTripKeepsEverything) {
  const auto file = TestFile("round.safetensors");
  WriteSafetensors(Sample(), file);
  const Safetensors read = ReadSafetensors(file);
  EXPECT_EQ(read.metadata, Sample().metadata);
  ASSERT_EQ(read.tensors.size(), 3u);
  for (const auto& [name, tensor] : Sample().tensors) {
    EXPECT_EQ(read.tensors.at(name).shape, tensor.shape) << name;
    EXPECT_EQ(read.tensors.at(name).values, tensor.values) << name;
  }
  const std::string first = ReadFile(file);
  WriteSafetensors(read, file);
  EXPECT_EQ(ReadFile(file), first);
}

TEST(Safetensors, ReadsTheFormatAsPublished) {
  const float value = 1.5f;
  std::string data(sizeof value, '\0');
  std::memcpy(data.data(), &value, sizeof value);
  const auto file = Handmade(
      R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},"__metadata__":{"k":"v"}})", data);
  const Safetensors read = ReadSafetensors(file);
  EXPECT_EQ(read.Tensor("x", "f").values, std::vector<float>{1.5f});
  EXPECT_EQ(read.Metadata("k", "f"), "v");
}

TEST(Safetensors, RejectsForeignAndDamagedFiles) {
  const auto foreign = TestFile("foreign.safetensors");
  std::ofstream(foreign) << "hello";
  EXPECT_THAT(MessageOf(foreign), HasSubstr("shorter than 8 bytes"));
  std::ofstream(foreign) << "this is a text file of some length";
  EXPECT_THAT(MessageOf(foreign), HasSubstr("truncated or of another kind"));
  EXPECT_THAT(MessageOf(TestFile("missing.safetensors")), HasSubstr("no such file"));
  EXPECT_THAT(MessageOf(Handmade("{nonsense", "")), HasSubstr("header is wrong"));

  const auto cut = TestFile("cut.safetensors");
  WriteSafetensors(Sample(), cut);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 4);
  EXPECT_THAT(MessageOf(cut), HasSubstr("offsets of tensor"));
}

TEST(Safetensors, RejectsTensorsThatDoNotFit) {
  EXPECT_THAT(
      MessageOf(Handmade(R"({"x":{"dtype":"BF16","shape":[2],"data_offsets":[0,4]}})", "1234")),
      HasSubstr("element type BF16; allowed: F32"));
  EXPECT_THAT(
      MessageOf(Handmade(R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,4]}})", "1234")),
      HasSubstr("do not fit"));
  EXPECT_THAT(
      MessageOf(Handmade(R"({"x":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", "1234")),
      HasSubstr("negative dimension"));
  const std::string huge = "4611686018427387904";  // times 4 bytes overflows 64 bits
  EXPECT_THAT(MessageOf(Handmade(
                  R"({"x":{"dtype":"F32","shape":[)" + huge + R"(],"data_offsets":[0,0]}})", "")),
              HasSubstr("larger than the file"));
  EXPECT_THAT(
      MessageOf(Handmade(R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[0]}})", "1234")),
      HasSubstr("do not fit"));
}

TEST(Safetensors, NamesWhatIsMissing) {
  EXPECT_THROW(
      {
        try {
          Sample().Tensor("absent", "model.safetensors");
        } catch (const Error& e) {
          EXPECT_STREQ(e.what(), "model.safetensors: no tensor 'absent'");
          throw;
        }
      },
      Error);
}

TEST(Safetensors, FailureLeavesTheOldFile) {
  EXPECT_THROW(WriteSafetensors(Sample(), TestFile("no_such_folder/x.safetensors")), Error);
}

}  // namespace
}  // namespace sandwright
