/// Snapshots: bytes from which a run goes on with the same bits.
///
/// Every motion is kept as what it was started from (time and states of its component); restoring starts the
/// integrators there again and lets them run on, which gives the same pieces, since their steps depend on
/// their own history alone.
#include <cmath>
#include <cstring>

#include "brink/core/base/error.h"
#include "brink/core/base/hash.h"
#include "brink/core/world/world_hash.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

namespace {

constexpr std::uint64_t kMagic = 0x314b4e4952420006ULL;  // "\6\0BRINK1"

class Writer {
 public:
  template <class T>
  void put(const T& value) {
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
  void get(T& value) {
    if (bytes_.size() < sizeof(T)) throw BadInput("snapshot: it ends early");
    std::memcpy(static_cast<void*>(&value), bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
  }
  bool done() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// What a snapshot must agree on with the world it is restored into: everything that decides the motion.
std::uint64_t fingerprint(const World& world, const SolverOptions& options) {
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
  return hash.value();
}

}  // namespace

/// Reads or writes the members of a kernel in one order.
class SnapshotCodec {
 public:
  template <class Archive, class K>
  static void scalars(Archive&& each, K& k) {
    each(k.time_);
    each(k.horizon_);
    each(k.max_overlap_);
    each(k.start_overlap_);
    each(k.seq_);
    each(k.frame_);
    each(k.last_frame_);
    each(k.last_event_);
    each(k.instant_);
    each(k.in_instant_);
    each(k.taken_);
  }
};

std::vector<std::byte> Kernel::snapshot() const {
  Writer out;
  out.put(kMagic);
  out.put(fingerprint(world_, options_));
  SnapshotCodec::scalars([&](const auto& v) { out.put(v); }, *this);
  out.put(random_.state());
  WorkCounters::for_each(work_, [&](auto, const auto& v, auto) { out.put(v); });
  for (const BodyTrack& b : bodies_) {
    out.put(b.version);
    out.put(b.velocity_rounding);
    out.put(b.resolved_at);
    out.put(b.last_partner);
    out.put(b.streak);
    if (b.component >= 0) continue;
    out.put(b.motion.origin());
    out.put(b.motion.start());
    out.put(b.motion.start_low());
  }
  for (const Coupled& c : components_) {
    out.put(c.started);
    for (const BodyState& s : c.start_states) out.put(s);
  }
  const std::vector<int> in_instant = bodies_in_instant_.list();
  out.put(bodies_in_instant_.often());
  out.put(static_cast<std::uint64_t>(in_instant.size()));
  for (const int k : in_instant) out.put(k);
  out.put(static_cast<std::uint64_t>(zeno_.bounces().size()));
  for (const auto& [feature, bounce] : zeno_.bounces()) {
    out.put(feature);
    out.put(bounce);
  }
  return out.take();
}

/// From its start to the present time.
void Kernel::integrate_again(Coupled& c) {
  while (follow(c, time_) < time_) {
    if (std::isfinite(c.failure.time)) throw BadInput("snapshot: " + c.failure.why);
    c.integrator->forget_before(time_);
  }
}

void Kernel::restore(std::span<const std::byte> bytes) {
  Reader in(bytes);
  std::uint64_t magic = 0, print = 0;
  in.get(magic);
  in.get(print);
  if (magic != kMagic) throw BadInput("snapshot: these bytes are not a snapshot of this version");
  if (print != fingerprint(world_, options_))
    throw BadInput("snapshot: it was taken of another world or with other options");
  SnapshotCodec::scalars([&](auto& v) { in.get(v); }, *this);
  auto random = random_.state();
  in.get(random);
  random_.set_state(random);
  WorkCounters counted;
  WorkCounters::for_each(counted, [&](auto, auto& v, auto) { in.get(v); });
  for (BodyTrack& b : bodies_) {
    in.get(b.version);
    in.get(b.velocity_rounding);
    in.get(b.resolved_at);
    in.get(b.last_partner);
    in.get(b.streak);
    if (b.component >= 0) continue;
    double origin = 0.0;
    BodyState start, low;
    in.get(origin);
    in.get(start);
    in.get(low);
    b.motion = Motion::ballistic(origin, start, b.motion.acceleration(), b.motion.end(), low);
  }
  halt_.reset();
  for (Coupled& c : components_) {
    in.get(c.started);
    for (BodyState& s : c.start_states) in.get(s);
    start_component(c, c.started, std::vector<BodyState>(c.start_states));
    integrate_again(c);
  }
  bool often = false;
  std::uint64_t bodies = 0, features = 0;
  in.get(often);
  in.get(bodies);
  std::vector<int> in_instant;
  for (std::uint64_t i = 0; i < bodies; ++i) {
    in_instant.emplace_back();
    in.get(in_instant.back());
  }
  bodies_in_instant_.restore(in_instant, often);
  in.get(features);
  ZenoWatch::Bounces bounces;
  for (std::uint64_t i = 0; i < features; ++i) {
    ZenoWatch::Feature key;
    ZenoWatch::Bounce bounce;
    in.get(key);
    in.get(bounce);
    bounces.emplace(key, bounce);
  }
  if (!in.done()) throw BadInput("snapshot: bytes left over");
  zeno_.restore(std::move(bounces));
  for (SiteMotion& s : sites_) {
    Extent extent = s.extend(time_, instalment());
    for (; extent.status == Extent::Status::unfinished; extent = s.extend(time_, instalment()))
      s.forget_before(time_);
    if (extent.end < time_) throw BadInput(extent.why);
  }
  work_ = counted;
  if (watched_) watched_->clear();
  ++revision_;
}

}  // namespace brink
