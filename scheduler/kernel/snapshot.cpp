#include "brink/scheduler/kernel/snapshot.h"

#include <cstring>
#include <type_traits>

#include "brink/core/base/error.h"
#include "brink/core/base/hash.h"
#include "brink/core/world/world_hash.h"

namespace brink {

namespace {

constexpr std::uint64_t kMagic = 0x314b4e4952420007ULL;  // "\7\0BRINK1"

class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    const std::size_t place = bytes_.size();
    bytes_.resize(place + sizeof(T));
    std::memcpy(bytes_.data() + place, &value, sizeof(T));
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  void operator()(T& value) {
    if (bytes_.size() < sizeof(T)) throw BadInput("snapshot: it ends early");
    std::memcpy(static_cast<void*>(&value), bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
  }
  /// A count of things of which each takes at least so many bytes.
  std::uint64_t count(std::size_t least) {
    std::uint64_t n = 0;
    (*this)(n);
    if (n > bytes_.size() / least) throw BadInput("snapshot: it ends early");
    return n;
  }
  bool done() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// What a snapshot must agree on with the world it is restored into: everything that decides the motion.
std::uint64_t fingerprint(const World& world, const SolverOptions& options,
                          const std::vector<std::vector<int>>& together) {
  StateHash hash;
  hash.add(world_hash(world));
  for (const std::string* word :
       {&options.policy, &options.integrator, &options.order, &options.response, &options.detector}) {
    hash.add(static_cast<std::uint64_t>(word->size()));
    for (const char c : *word) hash.add(static_cast<std::uint64_t>(c));
  }
  hash.add(options.tolerance);
  hash.add(options.absolute_tolerance);
  hash.add(options.step);
  hash.add(options.contact_tolerance);
  hash.add(options.seed);
  for (const std::vector<int>& set : together) {
    hash.add(static_cast<std::uint64_t>(set.size()));
    for (const int k : set) hash.add(static_cast<std::uint64_t>(k));
  }
  return hash.value();
}

/// Reads or writes numbers of fixed size, in one order.
template <class Each, class Run>
void scalars(Each&& each, Run& run) {
  each(run.time);
  each(run.horizon);
  each(run.watch.max_overlap);
  each(run.watch.start_overlap);
  each(run.records.seq);
  each(run.records.frame);
  each(run.records.last_frame);
  each(run.records.last_event);
  each(run.endings.instant);
  each(run.endings.in_instant);
  each(run.taken);
  each(run.random);
  WorkCounters::for_each(run.work, [&](auto, auto& value, auto) { each(value); });
}

template <class Each, class Track>
void track(Each&& each, Track& b) {
  each(b.version);
  each(b.velocity_rounding);
  each(b.resolved_at);
  each(b.last_partner);
  each(b.streak);
}

void write_islands(Writer& out, const Islands::Saved& islands) {
  out(islands.tally);
  out(static_cast<std::uint64_t>(islands.islands.size()));
  for (const Island& i : islands.islands) {
    out(i.rests);
    out(i.due);
    out(static_cast<std::uint64_t>(i.members.size()));
    for (const int k : i.members) out(k);
    out(static_cast<std::uint64_t>(i.contacts.size()));
    for (const HeldContact& c : i.contacts) out(c);
  }
}

void read_islands(Reader& in, Islands::Saved& islands) {
  in(islands.tally);
  for (std::uint64_t n = in.count(sizeof(double)); n > 0; --n) {
    Island i;
    in(i.rests);
    in(i.due);
    i.members.resize(in.count(sizeof(int)));
    for (int& k : i.members) in(k);
    i.contacts.resize(in.count(sizeof(HeldContact)));
    for (HeldContact& c : i.contacts) in(c);
    islands.islands.push_back(std::move(i));
  }
}

}  // namespace

std::vector<std::byte> encode(const SavedRun& saved, const World& world, const SolverOptions& options,
                              const Trajectories& trajectories) {
  Writer out;
  out(kMagic);
  out(fingerprint(world, options, trajectories.together()));
  scalars(out, saved);
  for (const BodyTrack& b : saved.trajectories.bodies) {
    track(out, b);
    out(b.component == BodyTrack::kHeld);
    if (b.component >= 0) continue;
    out(b.motion.origin());
    out(b.motion.start());
    out(b.motion.start_low());
  }
  for (const ComponentStart& s : saved.trajectories.starts) {
    out(s.time);
    for (const BodyState& state : s.states) out(state);
  }
  write_islands(out, saved.islands);
  out(saved.endings.often);
  out(static_cast<std::uint64_t>(saved.endings.bodies.size()));
  for (const int k : saved.endings.bodies) out(k);
  out(static_cast<std::uint64_t>(saved.endings.bounces.size()));
  for (const auto& [feature, bounce] : saved.endings.bounces) {
    out(feature);
    out(bounce);
  }
  return out.take();
}

SavedRun decode(std::span<const std::byte> bytes, const World& world, const SolverOptions& options,
                const Trajectories& trajectories) {
  Reader in(bytes);
  std::uint64_t magic = 0, print = 0;
  in(magic);
  in(print);
  if (magic != kMagic) throw BadInput("snapshot: these bytes are not a snapshot of this version");
  if (print != fingerprint(world, options, trajectories.together()))
    throw BadInput("snapshot: it was taken of another world or with other options");
  SavedRun saved;
  scalars(in, saved);
  for (int k = 0; k < trajectories.body_count(); ++k) {
    BodyTrack b;
    track(in, b);
    bool held = false;
    in(held);
    b.component = held ? BodyTrack::kHeld : trajectories.own_component(k);
    if (b.component < 0) {
      double origin = 0.0;
      BodyState start, low;
      in(origin);
      in(start);
      in(low);
      b.motion = Motion::ballistic(origin, start, {}, std::numeric_limits<double>::infinity(), low);
    }
    saved.trajectories.bodies.push_back(b);
  }
  for (int c = 0; c < static_cast<int>(trajectories.component_count()); ++c) {
    ComponentStart s{c, 0.0, std::vector<BodyState>(trajectories.members(c).size())};
    in(s.time);
    for (BodyState& state : s.states) in(state);
    saved.trajectories.starts.push_back(std::move(s));
  }
  read_islands(in, saved.islands);
  in(saved.endings.often);
  saved.endings.bodies.resize(in.count(sizeof(int)));
  for (int& k : saved.endings.bodies) in(k);
  for (std::uint64_t n = in.count(sizeof(ZenoWatch::Feature)); n > 0; --n) {
    ZenoWatch::Feature feature;
    ZenoWatch::Bounce bounce;
    in(feature);
    in(bounce);
    saved.endings.bounces.emplace(feature, bounce);
  }
  if (!in.done()) throw BadInput("snapshot: bytes left over");
  return saved;
}

}  // namespace brink
