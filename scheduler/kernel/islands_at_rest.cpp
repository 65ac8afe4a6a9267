// Of many at rest only those wake who are moved, and the others are leant on; who stands while others go on comes to rest.
//
// Two at rest who touch are of one island, so what leans on one moves. An island that is leant on knows the contacts of that, and
// its own contacts have forces that balance them. Each step of who leans asks whether they can still (RestCheck).
#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "brink/scheduler/kernel/islands.h"

namespace brink {

namespace {

/// Those who stand are laid to rest where others are no more than one of so many of them and those at rest: what leans on a long
/// rim costs more to ask for than it saves. And after that was in vain, not for some steps, twice as many each time.
constexpr std::size_t kOneOf = 8;
/// Where more than one of so many of an island would have to yield, all do.
constexpr std::size_t kMostRoused = 2;
constexpr int kMostWaits = 5;  // powers of two
/// So often it is asked with fewer of them.
constexpr int kTries = 3;

bool any_of(const std::set<int>& bodies, const PairKey& pair) {
  return bodies.count(pair.body) > 0 || (!pair.with_site() && bodies.count(pair.other_body) > 0);
}

bool any_of(const std::set<int>& bodies, const Island& island) {
  return std::any_of(bodies.begin(), bodies.end(), [&](int k) { return has(island, k); });
}

}  // namespace

RestCheck Islands::rest_check() {
  return {*world_,
          *trajectories_,
          *search_,
          *response_,
          solver_,
          run_->time(),
          [this] { return !run_->is_cut(); }};
}

bool Islands::stands_among_many(int body) const {
  const auto lead = lead_of_.find(body);
  if (lead == lead_of_.end()) return false;
  const Island& island = islands_.at(lead->second);
  return island.rests && island.members.size() > kFewMembers;
}

/// With whom springs couple to them.
void Islands::rouse(Attempt& attempt) {
  while (!attempt.roused.empty()) {
    const int body = *attempt.roused.begin();
    const auto lead = lead_of_.find(body);
    if (lead == lead_of_.end() || !stands_among_many(body)) {
      gather(body, attempt.members);
      attempt.roused.erase(body);
      continue;
    }
    const Island& island = islands_.at(lead->second);
    std::set<int> roused;
    for (const int k : attempt.roused)
      if (has(island, k)) roused.insert(k);
    for (const int k : roused) attempt.roused.erase(k);
    for (std::vector<int> more(roused.begin(), roused.end()); !more.empty();) {
      const int k = more.back();
      more.pop_back();
      for (const int j : trajectories_->coupled_to(k))
        if (roused.insert(j).second) more.push_back(j);
    }
    if (island.members.size() <= roused.size() + kFewMembers)
      gather(body, attempt.members);
    else
      rouse(islands_.extract(lead->second).mapped(), roused, attempt);
  }
}

/// The others stay at rest, under what those who wake press them with, until a step of these says otherwise. Who leans on those who
/// wake joins: their step has taken them to stand.
void Islands::rouse(Island island, const std::set<int>& roused, Attempt& attempt) {
  attempt.were_at_rest.insert(roused.begin(), roused.end());
  std::vector<HeldContact> stay, part, lean;
  for (const HeldContact& c : island.contacts) {
    if (!any_of(roused, c.pair)) {
      stay.push_back(c);
      continue;
    }
    part.push_back(c);
    search_->search_again(c.pair);
    const bool across =
        !c.pair.with_site() && roused.count(c.pair.body) + roused.count(c.pair.other_body) == 1;
    if (across) lean.push_back(c);
  }
  attempt.warm.add(part);
  taken_out_.add(pressing(part));
  std::set<int> join;
  for (const HeldContact& c : island.leaning) {
    if (any_of(roused, c.pair))
      join.insert(who_leans(island, c));
    else
      lean.push_back(c);
  }
  std::sort(lean.begin(), lean.end(), in_order);
  for (const int k : roused) lead_of_.erase(k);
  std::erase_if(island.members, [&](int k) { return roused.count(k) > 0; });
  island.contacts = std::move(stay);
  island.leaning = std::move(lean);
  const int lead = island.members.front();
  for (const int k : island.members) lead_of_[k] = lead;
  islands_[lead] = std::move(island);
  attempt.members.insert(roused.begin(), roused.end());
  for (const int k : join) gather(k, attempt.members);
}

/// False: some of them are moved, and wake; or the run is cut. What leans on an island at rest is noted as the step has it.
bool Islands::carries(const IslandMotion& motion, Attempt& attempt) {
  const std::vector<HeldContact> lean = motion.parting().that_lean();
  const RestCheck check = rest_check();
  double moved = 0.0;
  for (auto& [lead, island] : islands_) {
    if (!island.rests || (lean.empty() && island.leaning.empty())) continue;
    std::vector<HeldContact> leaning;
    for (const HeldContact& c : island.leaning)
      if (attempt.members.count(who_leans(island, c)) == 0) leaning.push_back(c);
    for (const HeldContact& c : lean)
      if (has(island, c.pair.body) || has(island, c.pair.other_body)) leaning.push_back(c);
    if (leaning.empty() && island.leaning.empty()) continue;
    std::sort(leaning.begin(), leaning.end(), in_order);
    const std::vector<int> pressed = check.differs(island, leaning);
    island.leaning = std::move(leaning);
    if (pressed.empty()) continue;
    const RestCheck::Answer answer = check.ask(island, pressed, motion.duration());
    if (run_->is_cut()) return false;
    tally_.friction_residual = std::max(tally_.friction_residual, answer.beyond);
    if (answer.stays) continue;
    moved = std::max(moved, answer.moves_by);
    // What leans may find another way to press if those near it yield. What so many lean on is no saving, and where they have
    // yielded and it is no better than it was, it will not be after more of them.
    const bool many = kMostRoused * (attempt.members.size() + answer.near.size()) > island.members.size() ||
                      (attempt.moved > 0.0 && answer.moves_by >= attempt.moved);
    const std::vector<int>& yield = many ? island.members : answer.near;
    attempt.roused.insert(yield.begin(), yield.end());
  }
  attempt.moved = moved;
  return attempt.roused.empty();
}

/// Who stands, or all where they have come to rest, and those at rest that they touch, are one island from now on, if its contacts
/// hold it.
bool Islands::lay_to_rest(IslandMotion& motion, bool all, Attempt& attempt) {
  IslandPace& pace = attempt.pace;
  const IslandMembers& members = motion.members();
  if (!all && pace.waits > 0 && attempt.were_at_rest.empty()) {
    --pace.waits;
    return false;
  }
  std::vector<int> still(members.count());
  std::iota(still.begin(), still.end(), 0);
  if (!all) still = motion.still();
  std::size_t at_rest = 0;
  for (const auto& [lead, other] : islands_)
    if (other.rests && any_of(attempt.supports, other)) at_rest += other.members.size();
  bool asked = false;
  for (int tries = 0; tries < kTries && !run_->is_cut(); ++tries) {
    const std::size_t move = members.count() - still.size(), stand = at_rest + still.size();
    if (still.empty() || stand <= kFewMembers || stand < kOneOf * move) break;
    asked = true;
    motion.put_to_rest(still);
    std::set<int> with;
    Island island = at_rest_with(motion, still, attempt, with);
    std::vector<int> laid;
    for (const int i : still) laid.push_back(members.bodies()[i]);
    const RestCheck::Answer answer = rest_check().ask(island, laid, motion.duration());
    if (answer.stays) {
      pace.in_vain = 0;
      tally_.friction_residual = std::max(tally_.friction_residual, answer.beyond);
      enter_at_rest(std::move(island), with, laid, motion.parting().no_force(), attempt);
      return true;
    }
    // what friction had held, by what sweeps left of it, goes on
    if (all) break;
    std::erase_if(still, [&](int i) {
      return std::find(answer.moved.begin(), answer.moved.end(), members.bodies()[i]) != answer.moved.end();
    });
  }
  motion.wake_again();
  if (asked) pace.waits = 1 << std::min(pace.in_vain++, kMostWaits);
  return false;
}

/// The island that these members would be with those at rest that they touch: `with`, by their least members.
Island Islands::at_rest_with(const IslandMotion& motion, const std::vector<int>& still,
                             const Attempt& attempt, std::set<int>& with) const {
  const IslandMembers& members = motion.members();
  Island island;
  island.rests = true;
  island.pace = attempt.pace;
  for (const int i : still) {
    island.members.push_back(members.bodies()[i]);
    island.due = std::min(island.due, members.next_break(i));
  }
  island.contacts = motion.parting().that_hold();
  for (const HeldContact& c : island.contacts)
    if (!c.pair.with_site())
      for (const int k : {c.pair.body, c.pair.other_body})
        if (const auto lead = lead_of_.find(k); lead != lead_of_.end()) with.insert(lead->second);
  for (const int lead : with) {
    const Island& other = islands_.at(lead);
    island.members.insert(island.members.end(), other.members.begin(), other.members.end());
    island.contacts.insert(island.contacts.end(), other.contacts.begin(), other.contacts.end());
    island.due = std::min(island.due, other.due);
    for (const HeldContact& c : other.leaning)
      if (attempt.members.count(who_leans(other, c)) == 0) island.leaning.push_back(c);
  }
  std::sort(island.members.begin(), island.members.end());
  std::sort(island.contacts.begin(), island.contacts.end(), in_order);
  for (const HeldContact& c : motion.parting().that_lean())
    if (has(island, c.pair.body) || has(island, c.pair.other_body)) island.leaning.push_back(c);
  std::sort(island.leaning.begin(), island.leaning.end(), in_order);
  return island;
}

/// In place of the islands that it has been made with. `laid`: who has come to rest.
void Islands::enter_at_rest(Island island, const std::set<int>& with, const std::vector<int>& laid,
                            double no_force, Attempt& attempt) {
  for (HeldContact& c : island.contacts)
    c.mode = std::max(c.normal_force, std::abs(c.tangential_force)) > no_force ? ContactMode::rest
                                                                               : ContactMode::none;
  for (const int lead : with) {
    taken_out_.add(pressing(islands_.at(lead).contacts));  // their stretches go on (put_in)
    islands_.erase(lead);
  }
  lean_no_more(laid);
  const auto new_here =
      std::find_if(laid.begin(), laid.end(), [&](int k) { return attempt.were_at_rest.count(k) == 0; });
  if (new_here != laid.end()) note_change(EventKind::sleep, *new_here);
  for (const int k : laid) attempt.were_at_rest.erase(k);
  put_in(std::move(island));
}

/// Who is let go leans on nobody.
void Islands::lean_no_more(const std::vector<int>& bodies) {
  if (bodies.empty()) return;
  const std::set<int> free(bodies.begin(), bodies.end());
  for (auto& [lead, island] : islands_)
    std::erase_if(island.leaning,
                  [&, &of = island](const HeldContact& c) { return free.count(who_leans(of, c)) > 0; });
}

}  // namespace brink
