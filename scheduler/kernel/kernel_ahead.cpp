/// The kernel's verbs for collisions ahead of time: resolve, confirm, roll back.
#include <algorithm>
#include <limits>

#include "brink/scheduler/kernel/kernel.h"

namespace brink {

const BodyTrack& Kernel::certain(int k) const {
  const auto collisions = ahead_.of(k);
  return collisions.empty() ? bodies_[k] : collisions.front()->former_of(k);
}

const BodyTrack* Kernel::track(int k, std::uint64_t version) const {
  if (bodies_[k].version == version) return &bodies_[k];
  for (const AheadLog::Entry& c : ahead_.of(k))
    if (const BodyTrack& former = c->former_of(k); former.version == version) return &former;
  return nullptr;
}

std::vector<std::uint64_t> Kernel::versions(int k) const {
  std::vector<std::uint64_t> all;
  for (const AheadLog::Entry& c : ahead_.of(k)) all.push_back(c->former_of(k).version);
  all.push_back(bodies_[k].version);
  return all;
}

std::optional<double> Kernel::end_of_version(int k, std::uint64_t version) const {
  if (bodies_[k].version == version) return std::numeric_limits<double>::infinity();
  for (const AheadLog::Entry& c : ahead_.of(k))
    if (c->former_of(k).version == version) return c->time;
  return std::nullopt;
}

std::optional<Certificate> Kernel::search(const PairKey& pair, std::uint64_t version,
                                          std::uint64_t other_version, double from, double to) {
  const BodyTrack* other = pair.with_site() ? nullptr : track(pair.other_body, other_version);
  return search_between(pair, *track(pair.body, version), other, from, to);
}

/// Everything that a collision of the pair can change, as it is now.
AheadLog::Entry Kernel::before(const PairKey& pair) const {
  auto entry = std::make_shared<AheadCollision>();
  entry->time = time_;
  const auto keep = [&](int k) {
    const int component = bodies_[k].component;
    if (component < 0) return entry->former.push_back({k, bodies_[k]});
    const auto kept = [&](const auto& s) { return s.component == component; };
    if (std::any_of(entry->starts.begin(), entry->starts.end(), kept)) return;
    const Coupled& c = components_[component];
    entry->starts.push_back({component, c.started, c.start_states});
    for (const int j : c.component.bodies) entry->former.push_back({j, bodies_[j]});
  };
  keep(pair.body);
  if (!pair.with_site()) keep(pair.other_body);
  return entry;
}

bool Kernel::resolve_ahead(const Certificate& c, double end, std::vector<int>& changed) {
  const double present = time_;
  advance_pair(c.pair, c.time);
  const AheadLog::Entry entry = before(c.pair);
  const auto outcome = settle(c.pair, c.contact, changed);
  bool done = outcome.has_value();
  for (const int k : changed) done = done && extend_motion(k, end);
  time_ = present;
  if (outcome) entry->outcome = *outcome;
  entry->end = end;
  ahead_.add(entry);
  work_.states_kept = std::max<std::uint64_t>(work_.states_kept, ahead_.kept());
  if (done) return true;
  if (halt_ && halt_->termination == Termination::failed) halt_.reset();  // it may never come to pass
  changed.clear();
  undo(entry);
  return false;
}

bool Kernel::is_resolved_ahead(const Certificate& c) const {
  const auto collisions = ahead_.of(c.pair.body);
  if (collisions.empty()) return false;
  const Outcome& first = collisions.front()->outcome;
  return first.pair == c.pair && first.contact.time == c.contact.time &&
         first.contact.site == c.contact.site && first.contact.sample == c.contact.sample &&
         first.contact.sample_on_a == c.contact.sample_on_a;
}

bool Kernel::confirm(const Certificate& c, std::vector<int>& changed) {
  const AheadLog::Entry entry = ahead_.of(c.pair.body).front();
  ahead_.remove(entry);
  time_ = entry->time;
  if (watched_) hold_to_known(time_);
  for (const AheadCollision::Former& f : entry->former) changed.push_back(f.body);
  return tell(entry->outcome);
}

void Kernel::roll_back(int body, std::uint64_t version, double t, std::vector<int>& undone) {
  std::vector<Undone> taken_back;
  while (bodies_[body].version != version) undo_last(body, taken_back);
  for (Undone& u : taken_back) {
    if (u.body == body) u.to = t;
    const double from = std::max(u.from, u.to);
    ++work_.rollbacks;
    work_.body_seconds_thrown_away += from - u.to;
    if (run_.trace) run_.trace->mark({TraceKind::roll_back, u.body, -1, from, u.to});
    undone.push_back(u.body);
  }
}

/// Undoes the last collision that a body has ahead of time, and first all that hangs on it.
void Kernel::undo_last(int body, std::vector<Undone>& taken_back) {
  const AheadLog::Entry entry = ahead_.of(body).back();
  for (const AheadCollision::Former& f : entry->former)
    while (ahead_.of(f.body).back() != entry) undo_last(f.body, taken_back);
  for (const AheadCollision::Former& f : entry->former) {
    const auto known =
        std::find_if(taken_back.begin(), taken_back.end(), [&](const Undone& u) { return u.body == f.body; });
    if (known == taken_back.end())
      taken_back.push_back({f.body, entry->end, entry->time});
    else
      known->to = entry->time;
  }
  undo(entry);
}

void Kernel::undo(const AheadLog::Entry& entry) {
  for (const AheadCollision::Former& f : entry->former) {
    BodyTrack& b = bodies_[f.body];
    const std::uint64_t undone = std::max(b.version, b.last_undone);
    b = f.track;
    b.last_undone = undone;
  }
  for (const AheadCollision::Start& s : entry->starts) {
    Coupled& c = components_[s.component];
    const double end = bodies_[c.component.bodies.front()].motion.end();
    start_component(c, s.time, s.states);
    cover(c, end);
  }
  ahead_.remove(entry);
}

void Kernel::roll_back_all() {
  std::vector<int> undone;
  for (int k = 0; k < body_count() && !ahead_.empty(); ++k) roll_back(k, certain(k).version, time_, undone);
}

/// Swaps bodies that were resolved ahead of time with what they certainly are.
void Kernel::swap_with_certain() {
  for (int k = 0; k < body_count() && !ahead_.empty(); ++k) {
    const auto collisions = ahead_.of(k);
    if (collisions.empty()) continue;
    for (AheadCollision::Former& f : collisions.front()->former)
      if (f.body == k) std::swap(f.track, bodies_[k]);
  }
}

}  // namespace brink
