// What ranks agree on, with threads for ranks.
#include "agents/collective.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agents/own_rows.h"
#include "data/base/error.h"
#include "tests/support/thread_ranks.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;

std::string MessageOf(const std::exception_ptr& thrown) {
  if (!thrown) return "nothing";
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(Collective, AloneChangesNothing) {
  std::vector<float> numbers = {1, 2};
  Alone().Sum(numbers);
  EXPECT_THAT(numbers, ElementsAre(1, 2));
  EXPECT_THAT(GatherSteps(Alone(), numbers, 1, 1), ElementsAre(1, 2));
  EXPECT_THAT(GatherTexts(Alone(), "text"), ElementsAre("text"));
  CheckAlike(Alone(), {{"a", "1"}}, "here");
  EXPECT_THROW(AllOrNone(Alone(), [] { throw Error("no", ErrorKind::kRefused); }), Error);
}

TEST(Collective, TextsOfAnyLength) {
  ThreadRanks(3).Run([](Collective& ranks) {
    const std::string mine(static_cast<size_t>(2 * ranks.rank()), 'x');
    EXPECT_THAT(GatherTexts(ranks, mine), ElementsAre("", "xx", "xxxx"));
  });
}

TEST(Collective, StepsOfAllEnvironmentsInOneOrder) {
  // Two steps of one environment a rank, two numbers each: step, then rank, then number.
  ThreadRanks(2).Run([](Collective& ranks) {
    const float r = 10.0f * static_cast<float>(ranks.rank());
    EXPECT_THAT(GatherSteps(ranks, std::vector<float>{r, r + 1, r + 2, r + 3}, 1, 2),
                ElementsAre(0, 1, 10, 11, 2, 3, 12, 13));
  });
}

TEST(Collective, AFaultOfOneIsThatOfAll) {
  const auto thrown = ThreadRanks(3).Run([](Collective& ranks) {
    AllOrNone(ranks, [] {});
    AllOrNone(ranks, [&] {
      if (ranks.rank() > 0) throw Error("no file on " + std::to_string(ranks.rank()));
    });
  });
  for (const auto& fault : thrown) EXPECT_EQ(MessageOf(fault), "rank 1: no file on 1");
}

TEST(Collective, ADifferenceIsNamed) {
  const auto thrown = ThreadRanks(2).Run([](Collective& ranks) {
    CheckAlike(ranks, {{"seed", "7"}}, "before");
    CheckAlike(ranks, {{"same", "1"}, {"seed", ranks.leads() ? "7" : "8"}}, "at the start");
  });
  for (const auto& fault : thrown)
    EXPECT_EQ(MessageOf(fault), "rank 1 differs from rank 0 at the start: seed is 8 there, 7 here");
}

TEST(OwnRows, EachRowIsOneRanks) {
  // Two steps of two ranks of two environments: rows 0 1 | 2 3 of the first step, 4 5 | 6 7.
  const std::vector<int64_t> order = {7, 0, 2, 5, 1, 6, 3, 4};
  ThreadRanks(2).Run([&](Collective& ranks) {
    const OwnRows own(order, 2, ranks);
    if (ranks.leads()) {
      EXPECT_THAT(own.position, ElementsAre(1, 3, 4, 7));
      EXPECT_THAT(own.row, ElementsAre(0, 3, 1, 2));
    } else {
      EXPECT_THAT(own.position, ElementsAre(0, 2, 5, 6));
      EXPECT_THAT(own.row, ElementsAre(3, 0, 2, 1));
      EXPECT_EQ(own.Before(3), 2);
    }
  });
}

}  // namespace
}  // namespace sandwright
