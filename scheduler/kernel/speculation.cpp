#include "brink/scheduler/kernel/speculation.h"

#include <algorithm>
#include <limits>

namespace brink {

/// What it was before the first collision that is not certain.
const BodyTrack& Speculation::certain(int k) const {
  const auto collisions = of(k);
  return collisions.empty() ? trajectories_->body(k) : collisions.front()->former_of(k);
}

/// The motions of body k are a chain: what it was before of(k)[0], of(k)[1], ..., and last the one in Trajectories.
/// The first of them is certain; each other begins in the collision ahead of time before it.
const BodyTrack* Speculation::track(int k, std::uint64_t version) const {
  if (trajectories_->body(k).version == version) return &trajectories_->body(k);
  for (const Entry& c : of(k))
    if (const BodyTrack& former = c->former_of(k); former.version == version) return &former;
  return nullptr;
}

std::vector<std::uint64_t> Speculation::versions(int k) const {
  std::vector<std::uint64_t> all;
  all.reserve(of(k).size() + 1);
  for (const Entry& c : of(k)) all.push_back(c->former_of(k).version);
  all.push_back(trajectories_->body(k).version);
  return all;
}

/// A motion ends where the collision begins that keeps it as a former one.
std::optional<double> Speculation::end_of_version(int k, std::uint64_t version) const {
  if (trajectories_->body(k).version == version) return std::numeric_limits<double>::infinity();
  for (const Entry& c : of(k))
    if (c->former_of(k).version == version) return c->time;
  return std::nullopt;
}

/// Copies of tracks share the pieces of their motions: it costs no trajectory.
Speculation::Entry Speculation::before(const PairKey& pair) const {
  auto entry = std::make_shared<AheadCollision>();
  entry->time = run_->time();
  const auto keep = [&](int k) {
    const BodyTrack& b = trajectories_->body(k);
    // A collision restarts a component whole: all its bodies are kept, and where its integrator began,
    // once.
    if (b.component < 0) return entry->former.push_back({k, b});
    const auto kept = [&](const ComponentStart& s) { return s.component == b.component; };
    if (std::any_of(entry->starts.begin(), entry->starts.end(), kept)) return;
    entry->starts.push_back(trajectories_->start_of(b.component));
    for (const int j : trajectories_->members(b.component))
      entry->former.push_back({j, trajectories_->body(j)});
  };
  keep(pair.body);
  if (!pair.with_site()) keep(pair.other_body);
  return entry;
}

/// The entry is shared by all its bodies: it is taken out for all of them at once (remove).
void Speculation::add(const Entry& entry) {
  for (const AheadCollision::Former& f : entry->former) {
    if (static_cast<std::size_t>(f.body) >= of_.size()) of_.resize(f.body + 1);
    of_[f.body].push_back(entry);
  }
  kept_ += entry->former.size();
}

void Speculation::remove(const Entry& entry) {
  for (const AheadCollision::Former& f : entry->former) std::erase(of_[f.body], entry);
  kept_ -= entry->former.size();
}

/// Versions that are undone are never given again: a certificate of one must stay stale for ever (raise_version).
void Speculation::undo(const Entry& entry) {
  for (const AheadCollision::Former& f : entry->former) {
    BodyTrack& b = trajectories_->body(f.body);
    // the track that is put back knows nothing of the versions that are undone here, which must not be
    // given again
    const std::uint64_t undone = std::max(b.version, b.last_undone);
    b = f.track;
    b.last_undone = undone;
  }
  // an integrator has no former state: it is started again where it began, and makes the same steps
  for (const ComponentStart& s : entry->starts) trajectories_->go_back_to(s);
  remove(entry);
}

/// Undoes the last collision that a body has ahead of time, and first all that hangs on it.
void Speculation::undo_last(int body, std::vector<Undone>& taken_back) {
  const Entry entry = of(body).back();
  for (const AheadCollision::Former& f : entry->former)
    // later collisions of any of its bodies began from what this one left: they go first
    while (of(f.body).back() != entry) undo_last(f.body, taken_back);
  for (const AheadCollision::Former& f : entry->former) {
    const auto known =
        std::find_if(taken_back.begin(), taken_back.end(), [&](const Undone& u) { return u.body == f.body; });
    if (known == taken_back.end())
      taken_back.push_back({f.body, entry->end, entry->time});
    else
      // later ones are undone first: the way that is taken back grows towards earlier times
      known->to = entry->time;
  }
  // now nothing hangs on it
  undo(entry);
}

/// Work that is thrown away is counted by body: from where it had come to where it goes on.
void Speculation::roll_back(int body, std::uint64_t version, double t, std::vector<int>& undone) {
  std::vector<Undone> taken_back;
  while (trajectories_->body(body).version != version) undo_last(body, taken_back);
  for (Undone& u : taken_back) {
    // the body goes on within the motion that it is left with, up to t
    if (u.body == body) u.to = t;
    // one that had not come so far as it now goes on to has lost nothing
    const double from = std::max(u.from, u.to);
    ++run_->work().rollbacks;
    run_->work().body_seconds_thrown_away += from - u.to;
    run_->mark(TraceKind::roll_back, u.body, -1, from, u.to);
    undone.push_back(u.body);
  }
}

void Speculation::roll_back_all() {
  std::vector<int> undone;
  for (int k = 0; k < trajectories_->body_count() && !empty(); ++k)
    // takes others along, so the log may be empty before all have been asked
    roll_back(k, certain(k).version, run_->time(), undone);
}

/// Called in twos, with nothing resolved in between: the second call puts everything back.
void Speculation::swap_with_certain() {
  for (int k = 0; k < trajectories_->body_count() && !empty(); ++k) {
    const auto collisions = of(k);
    if (collisions.empty()) continue;
    for (AheadCollision::Former& f : collisions.front()->former)
      if (f.body == k) std::swap(f.track, trajectories_->body(k));
  }
}

}  // namespace brink
