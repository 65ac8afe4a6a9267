/// Local clocks (Lubachevsky 1991; Mirtich & Canny 1995): every body keeps its own time.
///
///   until the end
///     serve the body whose view expires first:
///       it leaves its cell             -> look at what came near
///       its view ends                  -> look at everything near it again
///       it may meet something          -> search that pair; clear: forget it, or ask again later
///       it meets something, and nothing else comes first
///                                      -> advance these two alone, resolve; both look around anew
///
/// A pair is in view of one of its bodies (body_clock.h). Two bodies in free flight are bounded by a
/// quadratic (flight.h) and searched only when their bounding discs meet; so a body that is resolved makes no
/// work for its neighbours, whose candidates are found stale when they are met. Cost: O(log N) a collision.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "brink/core/base/limits.h"
#include "brink/scheduler/events/event_queue.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/policies/body_clocks/due_soon.h"
#include "brink/scheduler/policies/body_clocks/found_contacts.h"
#include "brink/scheduler/policies/body_clocks/views.h"
#include "brink/scheduler/policies/body_clocks/worth_telling.h"
#include "brink/scheduler/policies/horizon.h"
#include "brink/scheduler/policies/order.h"
#include "brink/scheduler/policies/policy.h"

namespace brink {

namespace {

constexpr std::uint64_t kBetweenPauses = 2048;  ///< servings between places where a run may be resumed from
constexpr std::uint64_t kBetweenPolls = 64;
constexpr int kInstalment = 3;      ///< search steps at a time: most contacts ahead are overtaken by others
constexpr unsigned kPlain = 16;     ///< of instalments in a row of one search; then they double:
constexpr unsigned kDoublings = 8;  ///< so often, if it comes to no end
// At their longest, so many instalments make a million steps: then the search is given up.
constexpr unsigned kMostInstalments = 1000000 / (kInstalment << kDoublings);

/// Steps of the next instalment of a search that so many in a row have brought to no end.
constexpr int instalment(unsigned undecided) {
  return kInstalment << (undecided < kPlain ? 0U : std::min(undecided - kPlain + 1, kDoublings));
}

class BodyClocks final : public Policy {
 public:
  bool steps_islands() const override { return true; }
  bool looks_at_all_pairs() const override { return false; }
  void run(Kernel& kernel, double until) override {
    kernel_ = &kernel;
    until_ = until;
    if (!views_ || revision_ != kernel.revision()) look_around_all();
    views_->set_end(seen_end());
    tells_ = false;
    quick_ = kernel.has_quick_way() && !picks_among_all(kernel.order());
    const bool is_helped = kernel.has_helpers();
    while (!kernel.halt() && std::min(queue_.time(), kernel.next_step()) <= end()) {
      if (++served_ % kBetweenPauses == 0 || kernel.much_to_forget()) pause();
      if (served_ % kBetweenPolls == 0 && !kernel.poll()) break;
      if (is_helped && (tells_ = worth_.asked()) && soon_.is_time(queue_.time())) tell_helpers();
      // A contact at the very end of a step comes before the step, as in take_earliest().
      if (kernel.next_step() < queue_.time())
        step_island();
      else
        serve(queue_.body());
    }
    if (!kernel.halt()) kernel.follow_motions_all_the_way(end());  // of sites that nobody has in view
    if (kernel.halt()) return views_.reset();  // in the middle of something: to go on, look at all anew
    if (!kernel.record_frames(end())) return views_.reset();
    kernel.advance_all(end());
    kernel.fail_before(until);
  }

 private:
  /// Everything anew, from the present state alone: where there are no views, or where the state was changed
  /// from outside the verbs.
  void look_around_all() {
    views_.emplace(*kernel_);
    views_->set_end(seen_end());
    revision_ = kernel_->revision();
    found_.emplace(kernel_->body_count());
    queue_.reset(kernel_->body_count(), kernel_->time());
    views_->begin_round();
    for (int k = 0; k < kernel_->body_count() && kernel_->poll(); ++k) {
      look_around(k, kernel_->time());
      wait_for(k);
    }
    soon_ = DueSoon();
  }

  /// Puts body k where its clock says. To be called whenever its view has changed.
  void wait_for(int k) {
    kernel_->note_queue_operations(1);
    queue_.update(k, views_->clock(k).expiry());
    if (tells_ && views_->clock(k).expiry() < soon_.end() && tell_of(k)) kernel_->wake_helpers();
  }

  /// Of the run, as far as is known: a motion that fails may be started afresh before.
  double end() const { return std::min(until_, kernel_->reach()); }

  /// As far as is looked.
  double seen_end() const { return seen_beyond(until_); }

  /// A run may be resumed from between two instants only: within one, bodies may be a rounding past each
  /// other. Where nothing collides for long the clock goes on all the same, halfway to what is due next.
  void pause() {
    const double now = kernel_->time(), next = std::min({queue_.time(), kernel_->next_step(), end()});
    if (next <= now + 2.0 * same_instant(now)) return;
    if (kernel_->much_to_forget()) {
      const double halfway = now + 0.5 * (next - now);
      kernel_->record_frames(halfway);
      kernel_->advance_all(halfway);
      kernel_->forget_before(views_->earliest_search(halfway));
    }
    kernel_->pause_point();
  }

  /// A little later: a search that ends on a contact's instant may miss it by the rounding of its first
  /// guess.
  static double beyond(double t) { return t + 64.0 * same_instant(t); }

  /// Of what is due soon, so that they may do it meanwhile.
  void tell_helpers() {
    soon_.look(queue_, [this](const EventQueue::Entry& e) { return tell_of(e.body); });
    kernel_->wake_helpers();
  }

  /// Of what body k comes to within what is soon; true if that is of use.
  bool tell_of(int k) {
    const BodyClock& clock = views_->clock(k);
    bool any = false;
    for (std::size_t i = 0; i < clock.candidates.size() && clock.candidates[i].time <= soon_.end(); ++i)
      any = expect_search(k, clock.candidates[i]) || any;
    return any;
  }

  /// As sharpen() will ask, if nobody it is about is resolved before.
  bool expect_search(int k, const Candidate& c) {
    if (c.exact || views_->stale(c) || (quick_ && views_->plain_pair(k, c))) return false;
    const auto pair = kernel_->pair_of(k, c.other, c.image);
    return pair && kernel_->expect_search(*pair, c.clear, search_end(c, views_->end_of(k, c)),
                                          instalment(views_->clock(k).undecided));
  }

  /// How far a candidate is searched of which the end in its view is known.
  double search_end(const Candidate& c, double end) const {
    return std::min(beyond(end), std::max(c.time, seen_end()));
  }

  /// Does what is due first for body k, which is the first of all.
  void serve(int k) {
    const Due due = due_of(k);
    // asked before body k's time changes: who else is due next, and when
    const EventQueue::Entry second = queue_.second();
    expect(k, second.body);
    switch (due.kind) {
      case Due::Kind::leaves_cell:
        views_->look_ahead(k, due.time);
        break;
      case Due::Kind::view_ends:
        look_alone(k, due.time);
        break;
      case Due::Kind::may_meet:
        if (quick_ && (meet_quickly(k, second) || meet_wall_quickly(k, second))) return;
        sharpen(k, second.time);
        // what was just found may be next in any case: that saves a turn in the queue
        if (is_next(k, second.time)) return meet(k, second.time);
        break;
      case Due::Kind::meets:
        return meet(k, second.time);
    }
    wait_for(k);
  }

  /// What comes first for a body.
  struct Due {
    enum class Kind { leaves_cell, view_ends, may_meet, meets };
    double time;
    Kind kind;
  };
  Due due_of(int k) const {
    const BodyClock& clock = views_->clock(k);
    const double now = clock.expiry();
    if (clock.candidates.empty() || clock.candidates.front().time != now)
      return {now, now == clock.exit ? Due::Kind::leaves_cell : Due::Kind::view_ends};
    const Candidate& first = clock.candidates.front();
    return {now, first.exact && !views_->stale(first) ? Due::Kind::meets : Due::Kind::may_meet};
  }

  /// In a round of its own: everybody near is seen, whoever has looked before.
  void look_alone(int k, double now) {
    views_->begin_round();
    look_around(k, now);
  }

  /// In the present round. The contact that was found in the view before is void.
  void look_around(int k, double now) {
    found_->forget(k);
    views_->look_around(k, now);
  }

  /// Waiting for the memory of bodies that are met in no order is much of what an event costs.
  void expect(int k, int next) const {
    if (!views_->are_many()) return;
    if (next < kernel_->body_count()) {
      queue_.expect(next);
      views_->expect(next);
    }
    const BodyClock& clock = views_->clock(k);
    if (quick_ || clock.candidates.empty()) return;  // quickly: expect_quickly() has been asked before
    kernel_->expect(k);
    const int other = clock.candidates.front().other;
    if (other >= kernel_->body_count()) return;
    kernel_->expect(other);
    views_->expect(other);
  }

  /// True if body k's first candidate is a contact and comes before everything else, of which the queue's
  /// second is due first.
  bool is_next(int k, double second) const {
    const BodyClock& clock = views_->clock(k);
    if (clock.candidates.empty() || kernel_->halt()) return false;
    const Candidate& c = clock.candidates.front();
    if (!c.exact || views_->stale(c)) return false;
    const double time = c.time;
    return time <= std::min(end(), kernel_->next_step()) && time < second &&
           time < std::min(clock.exit, clock.horizon);
  }

  /// The first candidate of body k is dropped if it is stale, and searched if it is not. Nothing else is due before
  /// `next`: until then the search would go on at once.
  void sharpen(int k, double next) {
    BodyClock& clock = views_->clock(k);
    Candidate c = clock.candidates.front();
    clock.candidates.pop_front();
    if (views_->stale(c)) {
      kernel_->note_stale();
      return;
    }
    const double now = c.time, end = views_->end_of(k, c), to = search_end(c, end);
    const auto found = kernel_->search(*kernel_->pair_of(k, c.other, c.image), c.clear, to,
                                       {instalment(clock.undecided), next});
    const bool undecided = found && found->kind == Certificate::Kind::undecided;
    clock.undecided = undecided ? clock.undecided + 1 : 0;
    // no headway, or a million steps: the run ends and says so
    if (undecided && (found->time <= c.clear || clock.undecided > kMostInstalments))
      return kernel_->give_up(*found);
    if (found) {
      c.time = found->time;
      c.exact = !undecided;
      if (undecided) c.clear = c.time;
    } else if (to < end) {
      // Clear to as far as this run looks: the candidate stays, for a run that goes on. Else nothing of it
      // is left in this view.
      c.time = c.clear = std::nextafter(to, kForever);  // not before the end of this run
    } else {
      return;
    }
    if (c.exact) {
      // Of each body one contact is kept. An earlier find is a time to search from again: its `clear` is
      // still where its search must begin.
      for (std::size_t i = 0; i < clock.candidates.size(); ++i) clock.candidates[i].exact = 0;
      found_->set(k, *found);
      clock.has_found = true;
    }
    clock.see(c, now);
  }

  /// Search, collision and two looks around in one go, where body k's first candidate may be met now, both are plain
  /// discs and nothing else is due in the instant of their contact: what sharpen(), is_next() and meet() come to.
  /// False, and nothing that matters has changed, if it is for those.
  bool meet_quickly(int k, EventQueue::Entry second) {
    const BodyClock& clock = views_->clock(k);
    const Candidate& c = clock.candidates.front();
    if (!views_->plain_pair(k, c) || views_->stale(c)) return false;
    const int other = c.other;
    // hardly ever an image; and which of the two has the lower number cannot be foreseen
    const int above = other - k, to_lower = above & (above >> 31);
    const PairKey pair{k + to_lower, other - to_lower, -1,
                       c.image != Image{} && above < 0 ? -c.image : c.image};
    DiscContact contact;
    views_->expect_cells(c.other);
    views_->expect_look(k);
    if (!kernel_->search_discs(pair, c.clear, std::max(c.time, seen_end()), contact)) return false;
    expect_quickly(second.body);
    views_->expect_look(c.other);
    const double now = contact.time, instant = now + same_instant(now);
    if (clock.exit <= instant || clock.horizon <= instant || now > std::min(end(), kernel_->next_step()) ||
        clock.candidates.second_time() <= instant)
      return false;
    if (second.time <= instant && second.body == c.other && drops_copy(c, k)) second = queue_.second();
    if (second.time <= instant) return false;
    if (!kernel_->record_frames(now)) return true;
    kernel_->advance_pair(pair, now);
    if (!kernel_->resolve_discs(pair, contact)) {
      changed_.clear();
      if (kernel_->resolve(pair, kernel_->contact_of_discs(pair, contact), changed_)) look_around_changed();
      return true;
    }
    if (kernel_->halt()) return true;
    for (const int j : {pair.body, pair.other_body})
      if (views_->clock(j).has_found) found_->forget(j);
    views_->look_around_after(pair.body, pair.other_body, now);
    wait_for(k);  // first: whom it meets on its way up the queue is known from second()
    wait_for(other);
    return true;
  }

  /// The same where that candidate is a wall.
  bool meet_wall_quickly(int k, EventQueue::Entry second) {
    const BodyClock& clock = views_->clock(k);
    const Candidate& c = clock.candidates.front();
    const int site = c.other - kernel_->body_count();
    if (site < 0 || !views_->plain_at_wall(k, site, c.image)) return false;
    const PairKey pair{k, -1, site, {}};
    WallContact contact;
    const double until = std::min(clock.exit, clock.horizon);
    if (!kernel_->search_wall(pair, c.clear, until, contact)) return false;
    const double now = contact.time, instant = now + same_instant(now);
    if (until <= instant || now > std::min(end(), kernel_->next_step()) ||
        clock.candidates.second_time() <= instant || second.time <= instant)
      return false;
    if (!kernel_->record_frames(now)) return true;
    kernel_->advance_pair(pair, now);
    if (!kernel_->resolve_at_wall(pair, contact)) {
      changed_.clear();
      if (kernel_->resolve(pair, kernel_->contact_with_wall(pair, contact), changed_)) look_around_changed();
      return true;
    }
    if (kernel_->halt()) return true;
    if (clock.has_found) found_->forget(k);
    views_->look_around_after(k, now);
    wait_for(k);
    return true;
  }

  /// Starts to fetch what meet_quickly() will read for that body, whose own clock and flight are at hand.
  void expect_quickly(int next) const {
    if (!views_->are_many() || next >= kernel_->body_count()) return;
    const BodyClock& clock = views_->clock(next);
    kernel_->expect_disc(next);
    views_->expect_cells(next);
    const int other = clock.candidates.empty() ? next : clock.candidates.front().other;
    if (other >= kernel_->body_count()) return;
    queue_.expect(other);
    kernel_->expect_disc(other);
    views_->expect(other);
  }

  /// A pair may be in both views. If what candidate c of body k is has body k for its own first candidate, by the same
  /// image, that is dropped.
  bool drops_copy(const Candidate& c, int k) {
    BodyClock& clock = views_->clock(c.other);
    if (clock.candidates.empty()) return false;
    const Candidate& first = clock.candidates.front();
    // from the other's place the image is as far the other way
    if (first.other != k || first.image != -c.image || views_->stale(first)) return false;
    clock.candidates.pop_front();
    wait_for(c.other);
    return true;
  }

  /// Body k's first candidate is a contact, and nothing is due before it.
  void meet(int k, double second) {
    const BodyClock& clock = views_->clock(k);
    const double now = found_->of(k).time, instant = now + same_instant(now);
    // Alone in its instant: nobody else is due in it, and nothing else of body k, so there is nothing to
    // choose from.
    const bool alone = !picks_among_all(kernel_->order()) && second > instant && clock.exit > instant &&
                       clock.horizon > instant && clock.candidates.second_time() > instant;
    if (alone) return collide(Certificate(found_->of(k)));
    wait_for(k);  // a contact may be told for a little before the time that the queue knows
    const std::vector<Certificate> group = contacts_until(instant);
    // none: what was found by a view that has ended, the next view does not find by the end of the instant
    if (kernel_->halt() || group.empty()) return;
    collide(at_its_time(*kernel_, group[first_by_order(*kernel_, group)], group.front().time));
  }

  /// Every contact of the present instant that the run comes to, in the total order of events.
  std::vector<Certificate> contacts_until(double instant) {
    std::vector<Certificate> group;
    std::vector<int> asked, looked_again;
    // a motion may fail in the midst of the instant
    const double last = std::min(instant, kernel_->reach());
    // Whose view may hide something of the instant takes its next step here, until every view that is due by
    // `last` begins with a contact.
    while (queue_.time() <= last && kernel_->poll()) {
      const int k = queue_.body();
      const BodyClock& clock = views_->clock(k);
      const bool lasts = clock.exit > last && clock.horizon > last;
      if (lasts && clock.candidates.front().exact && !views_->stale(clock.candidates.front())) {
        add_contacts(k, last, group);
        asked.push_back(k);
        // Out of the way, so that the next one of the instant comes up; put back below.
        queue_.update(k, kForever);
      } else {
        take_next_step(k, last, looked_again);
      }
    }
    for (const int k : asked) queue_.update(k, views_->clock(k).expiry());
    const auto before = [](const Certificate& a, const Certificate& b) { return a.order() < b.order(); };
    std::sort(group.begin(), group.end(), before);
    const auto same = [](const Certificate& a, const Certificate& b) { return a.order() == b.order(); };
    group.erase(std::unique(group.begin(), group.end(), same), group.end());
    return group;
  }

  /// What is due first for body k, short of meeting. A view that ends after a contact of this instant is
  /// begun again at that contact, not beyond it: once, as it may always end that soon.
  void take_next_step(int k, double last, std::vector<int>& looked_again) {
    const Due due = due_of(k);
    const BodyClock& clock = views_->clock(k);
    const bool again = std::find(looked_again.begin(), looked_again.end(), k) != looked_again.end();
    if (due.kind == Due::Kind::may_meet)
      sharpen(k, last);
    else if (clock.exit <= clock.horizon)
      views_->look_ahead(k, clock.exit);
    else if (due.kind == Due::Kind::meets && !again)
      look_again(k, due.time, looked_again);
    else
      look_alone(k, clock.horizon);
    wait_for(k);
  }

  /// At the contact, and not again in this instant.
  void look_again(int k, double contact, std::vector<int>& looked_again) {
    looked_again.push_back(k);
    look_alone(k, contact);
  }

  /// Contacts of body k that are in its view and due by `instant`.
  void add_contacts(int k, double instant, std::vector<Certificate>& group) {
    const bool features = picks_among_all(kernel_->order());
    const auto add = [&](const Certificate& c) {
      group.push_back(c);
      if (!features || c.kind != Certificate::Kind::contact) return;
      for (const Certificate& other : kernel_->simultaneous(c)) group.push_back(other);
    };
    add(found_->of(k));
    const auto& candidates = views_->clock(k).candidates;
    for (std::size_t i = 1; i < candidates.size() && candidates[i].time <= instant; ++i) {
      const Candidate& c = candidates[i];
      if (views_->stale(c)) continue;
      // Not in instalments: here it must be known whether it belongs to the instant.
      const auto found = kernel_->search(*kernel_->pair_of(k, c.other, c.image), c.clear,
                                         std::min(views_->end_of(k, c), beyond(instant)));
      if (found && found->kind == Certificate::Kind::contact && found->time <= instant) add(*found);
    }
  }

  /// Frames up to the contact first: they show the motions before it.
  void collide(const Certificate& c) {
    if (!kernel_->record_frames(c.time)) return;
    kernel_->advance_pair(c.pair, c.time);
    views_->expect_look(c.pair.body);
    if (!c.pair.with_site()) views_->expect_look(c.pair.other_body);
    changed_.clear();
    if (kernel_->resolve(c.pair, c.contact, changed_)) look_around_changed();
  }

  /// An island's step ends, and nothing comes before.
  void step_island() {
    if (!kernel_->record_frames(kernel_->next_step())) return;
    changed_.clear();
    if (kernel_->step_island(changed_)) look_around_changed();
  }

  /// Each looks at all but those that have looked before it: so each only once, though a collision in an
  /// island tells of its bodies twice.
  void look_around_changed() {
    if (changed_.size() > 2) {
      std::set<int> seen;
      std::erase_if(changed_, [&](int k) { return !seen.insert(k).second; });
    }
    // all flights before the first look: nobody must see another's former motion
    for (const int k : changed_) views_->take_up(k);
    views_->begin_round();
    for (std::size_t i = 0; i < changed_.size() && !kernel_->halt(); ++i) {
      look_around(changed_[i], kernel_->time());
      wait_for(changed_[i]);
    }
  }

  Kernel* kernel_ = nullptr;
  double until_ = 0.0;
  std::uint64_t revision_ = 0;
  std::uint64_t served_ = 0;
  bool quick_ = false;  ///< plain discs go the quick way
  bool tells_ = false;  ///< helpers are told
  WorthTelling worth_;
  DueSoon soon_;
  std::optional<Views> views_;
  EventQueue queue_;
  std::optional<FoundContacts> found_;  ///< of each body's exact candidate
  std::vector<int> changed_;
};

}  // namespace

std::unique_ptr<Policy> make_body_clocks() { return std::make_unique<BodyClocks>(); }

}  // namespace brink
