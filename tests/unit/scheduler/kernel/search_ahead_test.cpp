// Searches ahead: the answer to the same question is that of first_contact(), with its work; there is none to another.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "brink/scheduler/kernel/search_ahead.h"
#include "tests/support/gases.h"

namespace brink::search_ahead_test {
namespace {

TEST(SearchAhead, AnswersTheSameQuestionAlone) {
  const auto outline = testing::outline(testing::star(5, 1.0));
  const auto index = make_brute_force_index(outline);
  const Motion motion_a = Motion::ballistic(0.0, {{{-3.0, 0.1}, 0.0}, {{1.0, 0.0}, 0.7}}, {}),
               motion_b = Motion::ballistic(0.0, {{{3.0, 0.0}, 0.3}, {{-1.0, 0.0}, -1.1}}, {});
  const Mover a{index.get(), &motion_a}, b{index.get(), &motion_b};
  SearchLimits limits;
  SearchScratch scratch;
  WorkCounters counted;
  const PairAnswer direct = first_contact(a, b, 0.0, 10.0, limits, scratch, counted);
  ASSERT_EQ(direct.status, PairAnswer::Status::contact);

  std::unique_ptr<SearchAhead> ahead;
  Helpers helpers(1);  // ends first
  ahead = std::make_unique<SearchAhead>(helpers, limits);
  SearchAhead::Question question{{0, 1, -1, {}}, 1, 1, 0.0, 10.0, 0};
  WorkCounters work;
  const PairAnswer* found = nullptr;
  EXPECT_TRUE(ahead->expect(question, a, b));
  while (!found) {
    ahead->expect(question, a, b);  // again, where a helper was late; false while it searches still
    helpers.wake();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    SearchAhead::Question other = question;
    other.version = 2;
    EXPECT_EQ(ahead->answer(other, 0.0, work), nullptr);
    found = ahead->answer(question, 0.0, work);
  }
  EXPECT_EQ(found->status, direct.status);
  EXPECT_EQ(found->until, direct.until);
  EXPECT_EQ(found->contact.point, direct.contact.point);
  EXPECT_EQ(work.search_iterations, counted.search_iterations);
  EXPECT_EQ(work.candidate_evaluations, counted.candidate_evaluations);
  EXPECT_EQ(work.pair_searches, 1U);
  EXPECT_EQ(ahead->answer(question, 0.0, work), nullptr) << "it is told once";

  // an instalment that stops before it is needed is no answer
  question.most_steps = 1;
  limits.max_iterations = 1;
  const PairAnswer part = first_contact(a, b, 0.0, 10.0, limits, scratch, counted);
  ASSERT_EQ(part.status, PairAnswer::Status::undecided);
  for (found = nullptr; !found;) {
    ahead->expect(question, a, b);
    helpers.wake();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    found = ahead->answer(question, part.until, work);
  }
  EXPECT_EQ(found->until, part.until);
  EXPECT_TRUE(ahead->expect(question, a, b));
  helpers.wake();
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(ahead->answer(question, std::nextafter(part.until, 10.0), work), nullptr);
}

}  // namespace
}  // namespace brink::search_ahead_test
