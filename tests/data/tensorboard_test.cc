#include "data/base/tensorboard.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

uint32_t Masked(std::string_view bytes) {
  const uint32_t crc = Crc32c(bytes);
  return ((crc >> 15) | (crc << 17)) + 0xa282ead8u;
}

template <class T>
T Take(std::string_view& bytes) {
  T value;
  EXPECT_GE(bytes.size(), sizeof value);
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

uint64_t TakeVarint(std::string_view& bytes) {
  uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const auto byte = Take<uint8_t>(bytes);
    value |= static_cast<uint64_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
}

// Fields of a message by number; eight- and four-byte fields as their bytes.
std::multimap<uint64_t, std::string> Parse(std::string_view bytes) {
  std::multimap<uint64_t, std::string> fields;
  while (!bytes.empty()) {
    const uint64_t key = TakeVarint(bytes);
    uint64_t length = 0;
    switch (key & 7) {
      case 0: fields.emplace(key >> 3, std::to_string(TakeVarint(bytes))); continue;
      case 1: length = 8; break;
      case 2: length = TakeVarint(bytes); break;
      case 5: length = 4; break;
      default: ADD_FAILURE() << "wire type " << (key & 7);
    }
    fields.emplace(key >> 3, bytes.substr(0, length));
    bytes.remove_prefix(length);
  }
  return fields;
}

TEST(Crc32c, KnownValues) {
  EXPECT_EQ(Crc32c("123456789"), 0xE3069283u);            // the check value of CRC-32C
  EXPECT_EQ(Crc32c(std::string(32, '\0')), 0x8A9136AAu);  // RFC 3720, B.4
  EXPECT_EQ(Crc32c(""), 0u);
}

TEST(TensorboardWriter, RecordsReadBack) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "tensorboard";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  {
    TensorboardWriter writer(folder);
    const std::pair<std::string, double> scalars[] = {{"train/loss", 0.5}, {"time/fps", 1234.25}};
    writer.Write(300, scalars);
    writer.WritePicture(301, "eval/tasks", 640, 200, "PNG bytes");
  }
  const auto file = std::filesystem::directory_iterator(folder)->path();
  EXPECT_EQ(file.filename().string().rfind("events.out.tfevents.", 0), 0u);

  const std::string content = ReadFile(file);
  std::string_view rest = content;
  std::vector<std::multimap<uint64_t, std::string>> events;
  while (!rest.empty()) {
    const std::string_view length_bytes = rest.substr(0, 8);
    const auto length = Take<uint64_t>(rest);
    EXPECT_EQ(Take<uint32_t>(rest), Masked(length_bytes));
    const std::string_view payload = rest.substr(0, length);
    rest.remove_prefix(length);
    EXPECT_EQ(Take<uint32_t>(rest), Masked(payload));
    events.push_back(Parse(payload));
  }
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(events[0].find(3)->second, "brain.Event:2");
  EXPECT_EQ(events[1].find(2)->second, "300");
  std::map<std::string, float> values;
  const auto summary = Parse(events[1].find(5)->second);
  for (const auto& [field, bytes] : summary) {
    EXPECT_EQ(field, 1u);
    const auto value = Parse(bytes);
    float number = 0;
    std::memcpy(&number, value.find(2)->second.data(), sizeof number);
    values[value.find(1)->second] = number;
  }
  const auto picture = Parse(Parse(events[2].find(5)->second).find(1)->second);
  EXPECT_EQ(picture.find(1)->second, "eval/tasks");
  const auto image = Parse(picture.find(4)->second);
  EXPECT_EQ(image.find(1)->second, "200");
  EXPECT_EQ(image.find(2)->second, "640");
  EXPECT_EQ(image.find(4)->second, "PNG bytes");
  EXPECT_EQ(values, (std::map<std::string, float>{{"train/loss", 0.5f}, {"time/fps", 1234.25f}}));
}

TEST(TensorboardWriter, SaysWhereItCannotWrite) {
  EXPECT_THROW(TensorboardWriter("/nonexistent/folder"), Error);
}

}  // namespace
}  // namespace sandwright
