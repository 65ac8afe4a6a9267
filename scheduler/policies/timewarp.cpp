/// Timewarp (Jefferson 1985; of rigid bodies Mirtich 2000): bodies run ahead of what is certain.
///
///   until the end
///     choose a horizon; certificates of every pair that can meet before it
///     until nothing is left before the horizon
///       every body that something is new to has a turn:
///         its first contact is also the first of the other    -> resolve it ahead of time; both look around
///         the other has already gone on from there: it is late -> roll the other back, and what hangs on
///         that
///       take the earliest contact of what is certain
///         it was resolved ahead of time -> confirm it
///         it was not                    -> roll its bodies back to it, resolve it
///
/// A body's motions since the last that is certain are all kept until the horizon, or until they are undone;
/// certificates speak of two motions, not of the present, and so hold whatever is undone and done again.
/// Contacts of one body at one instant wait until they are the earliest, and so does everything where an
/// order takes contacts together: what is certain is decided as by every other policy, so that the events are
/// the same. No more former states than the option `kept_states` are kept; then nobody goes further ahead.
#include <algorithm>
#include <deque>

#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/policies/horizon.h"
#include "brink/scheduler/policies/order.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/policies/tolerances.h"

namespace brink {

namespace {

/// Contacts closer than this in time are left to the order [s].
double too_close(double t) { return 4.0 * same_instant(t); }

/// In a world of few bodies a horizon may end early after so many collisions (knows_enough()).
constexpr std::uint64_t kManyCollisions = 512;

/// States that may be kept at least for bodies ahead; and of so many motions, confirmed or undone, it is asked whether there
/// should be more.
constexpr std::size_t kLeastRoom = 4, kLookBack = 32;

/// Nobody goes further ahead by itself than so many collisions: a series of bounces that comes to its end ahead of time has no
/// last one, and each is looked for among all that there are.
constexpr std::size_t kMostAhead = 64;

/// Steps of a search whose answer may never be asked for: most take ten, and who creeps along another for thousands has
/// often been thrown off its way by then.
constexpr int kStepsAhead = 256;

class Timewarp final : public Policy {
 public:
  bool steps_islands() const override { return true; }
  void run(Kernel& kernel, double until) override {
    kernel_ = &kernel;
    undecided_ = 0;
    searched_on_ = -1.0;  // of another run, or of later than now
    room_ = kernel.options().kept_states;
    group_bodies();
    run_horizons(kernel, until,
                 [&](double end) { return run_horizon(end) ? std::optional(had_) : std::nullopt; });
  }

 private:
  /// One horizon, contact by contact. False on a halt.
  bool run_horizon(double end) {
    end_ = look_ahead(*kernel_, seen_beyond(end));
    const double begin = kernel_->time();
    const std::uint64_t before = kernel_->collisions();
    if (!look_at_all()) return false;
    // Each round: those who have news go ahead; then the one next contact that is certain is confirmed or
    // resolved. `last` is as far as this horizon comes by what is known now.
    double last = begin;
    for (;;) {
      run_ahead();
      if (kernel_->halt()) return false;
      last = last_beginning(*kernel_, begin, end, end_);
      // Where nothing touches for a while the next horizon finds again what is left. Asked before anything is taken, as
      // an order may draw what it takes.
      if (knows_enough(kernel_->collisions() - before) && !agenda_.empty() &&
          std::min(agenda_.earliest().time, kernel_->next_step()) > long_after(kernel_->time())) {
        last = kernel_->time();
        break;
      }
      const auto next = take_earliest(*kernel_, agenda_, last);
      if (!next) break;
      if (!kernel_->record_frames(next->time)) return false;
      changed_.clear();
      if (!make_certain(*next)) return false;
      make_room();
      had_.restarts += changed_.size();
    }
    // what is ahead of an end that a failure has brought nearer, or in the last instant
    kernel_->roll_back_all();
    if (!kernel_->record_frames(last)) return false;
    kernel_->advance_all(last);
    return true;
  }

  /// Certificates are kept for a horizon, and every turn looks through a body's: of one with so many collisions, what is
  /// known is forgotten before its end.
  bool knows_enough(std::uint64_t collisions) const {
    return collisions > kManyCollisions + 16 * static_cast<std::uint64_t>(kernel_->body_count());
  }
  /// Far beyond what one instant holds: what ends a horizon there cuts no instant in two.
  static double long_after(double t) { return t + 4096.0 * same_instant(t); }

  /// Bodies go less far ahead where more of that is undone than confirmed, and farther where it is not: every motion ahead is
  /// searched against all that its neighbours may have, and a body that buzzes between two others would fill what there is
  /// to keep. Source: adaptive throttles of optimistic simulation, Das 2000.
  void make_room() {
    if (in_vain_ + confirmed_ < kLookBack) return;
    room_ = in_vain_ > confirmed_ ? std::max(room_ / 2, kLeastRoom) : 2 * room_;
    room_ = std::min<std::size_t>(room_, kernel_->options().kept_states);
    in_vain_ = confirmed_ = 0;
  }

  // -- what is certain --

  /// False on a halt.
  bool make_certain(const Certificate& next) {
    if (next.kind == Certificate::Kind::undecided) return search_on(next);
    if (next.kind == Certificate::Kind::island) {  // its members never run ahead
      if (!kernel_->step_island(changed_)) return false;
      end_ = look_ahead(*kernel_, end_);
      return look_around(next.time);
    }
    if (kernel_->is_resolved_ahead(next)) {
      const std::uint64_t steps = kernel_->island_steps();
      if (!kernel_->confirm(next, changed_)) return false;
      ++confirmed_;
      // an island that it began has taken its bodies elsewhere than they had gone
      if (kernel_->island_steps() != steps) {
        end_ = look_ahead(*kernel_, end_);
        return look_around(next.time);
      }
      // who changes together with whom is different from now on
      if (groupings_ != kernel_->groupings()) return look_at_groups(next.time);
      count_from_now_on();
      return true;
    }
    // Nobody has resolved it: what its bodies did after it cannot stand.
    for (const int k : {next.pair.body, next.pair.other_body})
      if (k >= 0) roll_back(k, kernel_->versions(k).front(), next.time);
    kernel_->advance_pair(next.pair, next.time);
    if (!kernel_->resolve(next.pair, next.contact, changed_)) return false;
    if (groupings_ != kernel_->groupings()) return look_at_groups(next.time);
    end_ = look_ahead(*kernel_, end_);
    return look_around(next.time);
  }

  /// Bodies have been grouped anew, and nobody is ahead any more. False on a halt.
  bool look_at_groups(double now) {
    group_bodies();
    end_ = look_ahead(*kernel_, end_);
    for (int k = 0; k < kernel_->body_count(); ++k) give_a_turn_to(k);
    return look_around(now);
  }

  /// Certificates of motions that have just become certain join the agenda.
  void count_from_now_on() {
    for (const int k : changed_)
      for (const Certificate& c : known_[k]) {
        const int other = other_body(c, k);
        // Of two changed bodies both know it: it joins with the lower one.
        const bool twice = other >= 0 && other < k && is_changed(other);
        if (!twice && kernel_->fresh(c)) put_on_agenda(c);
      }
  }

  /// Goes on with a search that stopped at its cap. False on a halt.
  bool search_on(const Certificate& c) {
    const auto again = kernel_->search(c.pair, c.version_body, c.version_other, c.time, end_);
    const bool undecided = again && again->kind == Certificate::Kind::undecided;
    undecided_ = undecided ? undecided_ + 1 : 0;
    if (undecided && (again->time <= c.time || undecided_ > kMostUndecided)) kernel_->give_up(*again);
    // Certificates of searches that stopped before are answered now: may_be() passes over them.
    searched_on_ = c.time;
    if (again) note(*again);
    return kernel_->poll();
  }

  // -- what is known --

  /// Certificates of every pair that can meet before the horizon. False on a halt.
  /// Everything that was known is dropped: horizons begin where nobody is ahead.
  bool look_at_all() {
    agenda_.clear();
    known_.assign(kernel_->body_count(), {});
    restless_.clear();
    is_restless_.assign(kernel_->body_count(), false);
    const double from = kernel_->time();
    const std::vector<PairKey> pairs = kernel_->near_pairs(from, end_);
    had_ = {pairs.size(), 0};
    for (const PairKey& pair : pairs) {
      if (!kernel_->poll()) return false;
      if (const auto c = kernel_->search(pair, from, end_)) note(*c);
    }
    for (int k = 0; k < kernel_->body_count(); ++k) give_a_turn_to(k);
    return kernel_->poll();
  }

  /// Certificates of the newest motions of bodies that have changed, with every motion of others that may
  /// come to be. False on a halt.
  bool look_around(double now) {
    pairs_.clear();
    for (const int k : changed_) {
      const std::vector<PairKey> near = kernel_->near_pairs_of(k, now, end_);
      pairs_.insert(pairs_.end(), near.begin(), near.end());
    }
    std::sort(pairs_.begin(), pairs_.end());  // a pair of two changed bodies is met from both
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    for (const PairKey& pair : pairs_) {
      find_concerned(pair.body, concerned_);
      find_concerned(pair.other_body, concerned_others_);
      for (const std::uint64_t version : concerned_)
        for (const std::uint64_t other : concerned_others_)
          if (const auto c = kernel_->search(pair, version, other, now, end_, {kStepsAhead})) note(*c);
    }
    for (const int k : changed_) wake(k);
    return kernel_->poll();
  }

  /// Versions of a body (< 0: a site) that a new search must look at.
  void find_concerned(int k, std::vector<std::uint64_t>& versions) const {
    if (k < 0)
      versions.assign(1, 0);
    else if (is_changed(k))
      versions.assign(1, kernel_->body(k).version);
    else
      versions = kernel_->versions(k);
  }
  bool is_changed(int k) const { return std::find(changed_.begin(), changed_.end(), k) != changed_.end(); }

  /// Known to both bodies from now on; on the agenda, too, if both motions are certain.
  void note(const Certificate& c) {
    known_[c.pair.body].push_back(c);
    if (!c.pair.with_site()) known_[c.pair.other_body].push_back(c);
    if (kernel_->fresh(c)) put_on_agenda(c);
  }

  /// With the pair's other features at that time, where the order chooses among all.
  void put_on_agenda(const Certificate& c) {
    agenda_.insert(c);
    if (c.kind != Certificate::Kind::contact || !picks_among_all(kernel_->order())) return;
    for (const Certificate& other : kernel_->simultaneous(c)) agenda_.insert(other);
  }

  // -- what is ahead --

  /// Everyone to whom something is new has a turn.
  void run_ahead() {
    if (takes_together(kernel_->order()) || kernel_->by_passes()) return;
    // One turn for each who waits now. Turns that these give to others come after the next contact that
    // is certain.
    for (std::size_t turns = restless_.size(); turns > 0 && !kernel_->halt(); --turns) {
      const int k = restless_.front();
      restless_.pop_front();
      is_restless_[k] = false;
      take_turn(k);
    }
  }

  /// Body k's first contact, if it can be told: the other is rolled back where it has gone on without it;
  /// else it is resolved ahead, if it comes first for the other as well.
  void take_turn(int k) {
    const auto c = first_of(k);
    if (!c || c->kind != Certificate::Kind::contact || c->time > end_) return;
    if (roll_back_late(*c, k)) return give_a_turn_to(k);
    if (!is_first_of_all(*c)) return;
    changed_.clear();
    if (kernel_->resolve_ahead(*c, end_, changed_)) look_around(c->time);
  }

  /// True if the contact comes late for body k's other, which then is rolled back to it.
  bool roll_back_late(const Certificate& c, int k) {
    const int other = other_body(c, k);
    if (other < 0) return false;
    const std::uint64_t version = other == c.pair.body ? c.version_body : c.version_other;
    // Left in the same instant: the order says what comes first. (The motion is known: first_of() has
    // dropped what speaks of others.)
    if (*kernel_->end_of_version(other, version) <= c.time + too_close(c.time)) return false;
    if (kernel_->body(other).version == version) return false;
    roll_back(other, version, c.time);
    return true;
  }

  /// All whose motions were undone have news.
  void roll_back(int body, std::uint64_t version, double t) {
    undone_.clear();
    kernel_->roll_back(body, version, t, undone_);
    in_vain_ += undone_.size();
    for (const int k : undone_) wake(k);
  }

  /// True if the contact comes first, clearly, for everyone whom it concerns, and there is room to keep what
  /// they were.
  bool is_first_of_all(const Certificate& c) {
    std::size_t concerned = 0;
    for (const int body : {c.pair.body, c.pair.other_body}) {
      if (body < 0) continue;
      for (const int k : group_of(body)) {
        ++concerned;
        // A motion that has begun in this instant: both collisions belong to one group.
        if (kernel_->body(k).motion.begin() + too_close(c.time) >= c.time) return false;
        if (kernel_->motions_ahead(k) >= kMostAhead) return false;
        if (!is_clear_of_others(k, c)) return false;
      }
    }
    return kernel_->states_kept() + concerned <= room_;
  }

  /// True if nothing that body k knows of comes before c or close upon it; and, if c is body k's, it speaks
  /// of newest motions.
  bool is_clear_of_others(int k, const Certificate& c) {
    for (const Certificate& other : known_[k])
      if (other.time <= c.time + too_close(c.time) && other.order() != c.order() && may_be(k, other))
        return false;
    const int other = other_body(c, k);  // k itself is in c, or is only coupled to one that is
    return other == kNobody || is_newest(c);
  }

  /// The first contact of body k as far as it has come, with motions that others have, or had then.
  std::optional<Certificate> first_of(int k) {
    std::vector<Certificate>& known = known_[k];
    std::erase_if(known, [&](const Certificate& c) { return is_void(c); });
    std::optional<Certificate> first;
    for (const Certificate& c : known)
      if (may_be(k, c) && (!first || c.order() < first->order())) first = c;
    return first;
  }

  /// True if one of its motions has been undone, or has ended for certain.
  bool is_void(const Certificate& c) const {
    return !kernel_->end_of_version(c.pair.body, c.version_body) ||
           (!c.pair.with_site() && !kernel_->end_of_version(c.pair.other_body, c.version_other));
  }

  /// True if it speaks of body k's newest motion, and of one that the other has not left before.
  bool may_be(int k, const Certificate& c) const {
    const auto end = kernel_->end_of_version(c.pair.body, c.version_body);
    const auto other_end = c.pair.with_site() ? std::optional<double>(std::numeric_limits<double>::infinity())
                                              : kernel_->end_of_version(c.pair.other_body, c.version_other);
    if (!end || !other_end || c.time > *end || c.time > *other_end) return false;
    if (c.kind == Certificate::Kind::undecided && c.time <= searched_on_) return false;
    return kernel_->body(k).version == (k == c.pair.body ? c.version_body : c.version_other);
  }

  /// True if neither body has gone on from the motion of which c speaks.
  bool is_newest(const Certificate& c) const {
    return kernel_->body(c.pair.body).version == c.version_body &&
           (c.pair.with_site() || kernel_->body(c.pair.other_body).version == c.version_other);
  }

  static constexpr int kNobody = -2;
  /// The other body of a certificate that speaks of body k; -1: a site; kNobody: it does not speak of k.
  static int other_body(const Certificate& c, int k) {
    if (c.pair.body == k) return c.pair.other_body;
    return c.pair.other_body == k ? c.pair.body : kNobody;
  }

  // -- who has a turn --

  /// At most one turn waits for each body.
  void give_a_turn_to(int k) {
    if (is_restless_[k]) return;
    is_restless_[k] = true;
    restless_.push_back(k);
  }
  /// Body k has a new motion, or an old one again: that is news to everyone whom it may meet, too.
  void wake(int k) {
    give_a_turn_to(k);
    for (const Certificate& c : known_[k])
      if (const int other = other_body(c, k); other >= 0) give_a_turn_to(other);
  }

  /// Bodies that change together with body k.
  std::span<const int> group_of(int k) const { return groups_[group_[k]]; }
  /// By component; a body in none is a group of its own.
  void group_bodies() {
    groupings_ = kernel_->groupings();
    groups_.clear();
    group_.assign(kernel_->body_count(), -1);
    std::vector<int> of_component;
    for (int k = 0; k < kernel_->body_count(); ++k) {
      const int component = kernel_->body(k).component;
      if (component >= static_cast<int>(of_component.size())) of_component.resize(component + 1, -1);
      const bool known = component >= 0 && of_component[component] >= 0;
      group_[k] = known ? of_component[component] : static_cast<int>(groups_.size());
      if (!known) groups_.emplace_back();
      if (component >= 0) of_component[component] = group_[k];
      groups_[group_[k]].push_back(k);
    }
  }

  Kernel* kernel_ = nullptr;
  double end_ = 0.0;                             ///< as far as the present horizon looks
  Agenda agenda_;                                ///< of what is certain
  std::vector<std::vector<Certificate>> known_;  ///< of every body, certain or not
  std::deque<int> restless_;                     ///< bodies to whom something is new
  std::vector<bool> is_restless_;
  std::vector<int> group_;  ///< of every body
  std::vector<std::vector<int>> groups_;
  std::uint64_t groupings_ = 0;  ///< as of the groups
  std::vector<int> changed_, undone_;
  std::vector<PairKey> pairs_;                               ///< of look_around()
  std::vector<std::uint64_t> concerned_, concerned_others_;  ///< versions of a pair of these
  HorizonTally had_;                                         ///< of the present horizon
  std::size_t room_ = 0;                                     ///< states that may be kept, see make_room()
  std::size_t confirmed_ = 0, in_vain_ = 0;                  ///< motions ahead, since it was asked for
  int undecided_ = 0;                                        ///< searches in a row that met their cap
  double searched_on_ = -1.0;                                ///< where the last of them was taken up again
};

}  // namespace

std::unique_ptr<Policy> make_timewarp() { return std::make_unique<Timewarp>(); }

}  // namespace brink
