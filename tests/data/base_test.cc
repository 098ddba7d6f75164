// Random streams, atomic files, errors, parallel loops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/parallel.h"
#include "data/base/random.h"

namespace sandwright {
namespace {

TEST(RandomStreamTest, PhiloxKnownAnswer) {
  // Random123's known-answer file kat_vectors: philox4x32 10, counter 0, key 0.
  RandomStream stream(RandomStream::State{{0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, 4});
  EXPECT_EQ(stream.Next32(), 0x6627e8d5u);
  EXPECT_EQ(stream.Next32(), 0xe169c58du);
  EXPECT_EQ(stream.Next32(), 0xbc57ac4cu);
  EXPECT_EQ(stream.Next32(), 0x9b00dbd8u);
}

TEST(RandomStreamTest, SameNamesSameNumbersOtherNamesOthers) {
  RandomStream a(7, StreamId("episode"), 3), b(7, StreamId("episode"), 3);
  RandomStream other_seed(8, StreamId("episode"), 3), other_purpose(7, StreamId("task"), 3),
      other_index(7, StreamId("episode"), 4);
  const uint64_t first = a.Next64();
  EXPECT_EQ(first, b.Next64());
  EXPECT_NE(first, other_seed.Next64());
  EXPECT_NE(first, other_purpose.Next64());
  EXPECT_NE(first, other_index.Next64());
}

TEST(RandomStreamTest, ContinuesFromASavedState) {
  RandomStream stream(1);
  stream.Next32();
  RandomStream continued(stream.state());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(stream.Normal(), continued.Normal());
}

TEST(RandomStreamTest, MomentsAndBounds) {
  RandomStream stream(2);
  const int count = 100000;
  double uniform_sum = 0, normal_sum = 0, normal_squares = 0;
  std::array<int, 3> hits{};
  for (int i = 0; i < count; ++i) {
    const double u = stream.Uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    uniform_sum += u;
    const double n = stream.Normal();
    normal_sum += n;
    normal_squares += n * n;
    ++hits.at(stream.Index(3));
  }
  // Five standard deviations of each estimate.
  EXPECT_NEAR(uniform_sum / count, 0.5, 5 * 0.2887 / std::sqrt(count));
  EXPECT_NEAR(normal_sum / count, 0, 5 / std::sqrt(count));
  EXPECT_NEAR(normal_squares / count, 1, 5 * std::sqrt(2.0 / count));
  for (int hit : hits) EXPECT_NEAR(hit, count / 3.0, 5 * std::sqrt(count * 2 / 9.0));
}

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / "atomic_file_test";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
  }
  size_t FilesLeft() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
  std::filesystem::path folder_;
};

TEST_F(AtomicFileTest, ReplacesWhole) {
  WriteFileAtomically(folder_ / "a.txt", "old");
  WriteFileAtomically(folder_ / "a.txt", "new");
  EXPECT_EQ(ReadFile(folder_ / "a.txt"), "new");
  EXPECT_EQ(FilesLeft(), 1u);
}

TEST_F(AtomicFileTest, WithoutCommitTheOldFileStays) {
  WriteFileAtomically(folder_ / "a.txt", "old");
  {
    const AtomicFile file(folder_ / "a.txt");
    EXPECT_EQ(file.temporary().extension(), ".txt");
  }
  EXPECT_EQ(ReadFile(folder_ / "a.txt"), "old");
  EXPECT_EQ(FilesLeft(), 1u);
}

TEST_F(AtomicFileTest, UnwritableTargetsAreNamed) {
  EXPECT_THAT([&] { WriteFileAtomically(folder_ / "none" / "a.txt", "x"); },
              ::testing::Throws<Error>(
                  ::testing::Property(&Error::what, ::testing::HasSubstr("none/a.txt"))));
  EXPECT_THROW(WriteFileAtomically(folder_, "x"), Error);
  EXPECT_THROW(ReadFile(folder_ / "missing"), Error);
}

TEST(ErrorTest, RefusalListsItsReasons) {
  const Error refusal("not sand",
                      std::vector<std::string>{"too rough: 30 mm (limit 5 mm)", "no walls"});
  EXPECT_EQ(refusal.kind(), ErrorKind::kRefused);
  EXPECT_EQ(refusal.reasons().size(), 2u);
  EXPECT_THAT(refusal.what(), ::testing::HasSubstr("too rough"));
}

TEST(ErrorTest, ChecksPrintTheirValues) {
  const int rows = 3;
  EXPECT_THAT([&] { SAND_CHECK(rows == 4, rows); },
              ::testing::Throws<Error>(
                  ::testing::Property(&Error::what, ::testing::HasSubstr("rows == 4 [3]"))));
}

TEST(ParallelForTest, VisitsEachOnceAndRethrows) {
  std::vector<int> visits(1000);
  ParallelFor(1000, 4, [&](int i) { ++visits[static_cast<size_t>(i)]; });
  EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), 1000);
  EXPECT_THAT(visits, ::testing::Each(1));
  EXPECT_THROW(ParallelFor(10, 2,
                           [](int i) {
                             if (i == 5) throw Error("five");
                           }),
               Error);
  ParallelFor(0, 4, [](int) { FAIL(); });
}

}  // namespace
}  // namespace sandwright
