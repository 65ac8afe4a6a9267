#include "brink/scheduler/kernel/search_ahead.h"

namespace brink {

SearchAhead::SearchAhead(Helpers& helpers, const SearchLimits& limits)
    : helpers_(&helpers),
      limits_(&limits),
      searches_(std::make_unique<Search[]>(kPlaces)),
      scratch_(static_cast<std::size_t>(helpers.count()) + 1) {
  for (std::size_t k = 0; k < kPlaces; ++k) searches_[k].ahead = this;
}

SearchAhead::Search& SearchAhead::place_of(const PairKey& pair) {
  const auto first = static_cast<std::uint32_t>(pair.body),
             second = static_cast<std::uint32_t>(pair.with_site() ? ~pair.other_site : pair.other_body);
  return searches_[(first * 2654435761U ^ second * 2246822519U) >> 16 & (kPlaces - 1)];
}

bool SearchAhead::expect(const Question& question, const Mover& a, const Mover& b) {
  Search& s = place_of(question.pair);
  if (s.is_expected && s.question == question)
    return true;  // as for the body whose view the pair is in still
  if (helpers_->settle(s, Helpers::Patience::none) == Helpers::Settled::late) return false;
  s.is_expected = true;
  s.question = question;
  s.a = a;
  s.b = b;
  s.motion_a = *a.motion;
  s.motion_b = *b.motion;
  s.a.motion = &s.motion_a;
  s.b.motion = &s.motion_b;
  helpers_->post(s);
  return true;
}

SearchAhead::SearchWork::SearchWork(const WorkCounters& w)
    : counts{w.pair_searches,    w.search_iterations,     w.closed_forms,
             w.distance_queries, w.candidate_evaluations, w.let_go} {}

void SearchAhead::SearchWork::add_to(WorkCounters& w) const {
  std::size_t k = 0;
  for (std::uint64_t* c : {&w.pair_searches, &w.search_iterations, &w.closed_forms, &w.distance_queries,
                           &w.candidate_evaluations, &w.let_go})
    *c += counts[k++];
}

/// As an instalment that is needed no farther than it goes in any case: of one that stops before `needed_until` the rest
/// is not known.
void SearchAhead::Search::run(int helper) noexcept {
  SearchLimits limits = *ahead->limits_;
  if (question.most_steps > 0) limits.max_iterations = question.most_steps;
  WorkCounters counted;
  thrown = nullptr;
  try {
    found = first_contact(a, b, question.from, question.to, limits, ahead->scratch_[helper], counted);
  } catch (...) {
    thrown = std::current_exception();
  }
  work = SearchWork(counted);
}

const PairAnswer* SearchAhead::answer(const Question& question, double needed_until, WorkCounters& work) {
  Search& s = place_of(question.pair);
  if (!s.is_expected || !(s.question == question)) return nullptr;
  const Helpers::Settled settled = helpers_->settle(s, Helpers::Patience::little);
  s.is_expected = false;  // told once: a search is work that is counted as often as it is asked for
  if (settled != Helpers::Settled::done) return nullptr;
  if (s.thrown) std::rethrow_exception(s.thrown);
  if (s.found.status == PairAnswer::Status::undecided && s.found.until < needed_until) return nullptr;
  s.work.add_to(work);
  return &s.found;
}

}  // namespace brink
