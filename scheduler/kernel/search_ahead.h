#pragma once
/// First contacts that are searched ahead by helpers, before anybody asks for them.

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <vector>

#include "brink/core/base/helpers.h"
#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/first_contact/first_contact.h"

namespace brink {

/// A memory of answers. What first_contact() says is a function of the two motions and of what is asked, so an answer to
/// the same question is the same, whoever found it and when; one to another question is never used.
class SearchAhead {
 public:
  /// All that the answer depends on. Versions name motions.
  struct Question {
    PairKey pair;
    std::uint64_t version = 0, other_version = 0;
    double from = 0.0, to = 0.0;  ///< [s]
    int most_steps = 0;           ///< of an instalment

    bool operator==(const Question&) const = default;
  };

  /// `limits` must outlive it, and it the helpers: their threads use what it holds.
  SearchAhead(Helpers& helpers, const SearchLimits& limits);

  /// Somebody may search that from now on. Both are copied, motions included. False where it is not worth it, or where
  /// there is no room. @pre both motions are closed forms: they do not grow. Helpers that sleep are told by the caller.
  bool expect(const Question& question, const Mover& a, const Mover& b);
  /// What was found, until the next call; null: search yourself. `needed_until`: SearchLimits. The work of the search is
  /// added to `work`; what it threw is thrown.
  const PairAnswer* answer(const Question& question, double needed_until, WorkCounters& work);

 private:
  static constexpr std::size_t kPlaces = 256;

  /// What first_contact() counts.
  struct SearchWork {
    SearchWork() = default;
    explicit SearchWork(const WorkCounters& of);
    void add_to(WorkCounters& work) const;

    std::array<std::uint64_t, 6> counts{};
  };
  struct Search final : Helpers::Job {
    void run(int helper) noexcept override;

    SearchAhead* ahead = nullptr;
    bool is_expected =
        false;  ///< the owner's, as nothing else while it is posted: the answer may be asked for
    Question question;
    Mover a, b;
    Motion motion_a, motion_b;
    PairAnswer found;
    SearchWork work;
    std::exception_ptr thrown;
  };

  Search& place_of(const PairKey& pair);

  Helpers* helpers_;
  const SearchLimits* limits_;
  std::unique_ptr<Search[]> searches_;  ///< each pair has one place, which others may have, too
  std::vector<SearchScratch> scratch_;  ///< of the owner's thread, and of each helper
};

}  // namespace brink
