#include "brink/scheduler/kernel/snapshot.h"

#include <array>
#include <cstring>
#include <type_traits>

#include "brink/core/base/error.h"
#include "brink/core/base/hash.h"
#include "brink/core/world/world_hash.h"

namespace brink {

namespace {

/// With a newline and a zero in front of the letters: no text file begins so. The digit grows with every change of what is written.
constexpr std::array<char, 8> kMagic{'\n', '\0', 'B', 'R', 'I', 'N', 'K', 'D'};

/// Objects as they lie in memory: a snapshot is read by the program that wrote it.
class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    if (bytes_.size() - end_ < sizeof(T)) bytes_.resize(2 * (end_ + sizeof(T)));
    std::memcpy(bytes_.data() + end_, &value, sizeof(T));
    end_ += sizeof(T);
  }
  void expect(std::size_t bytes) { bytes_.resize(bytes); }
  std::span<const std::byte> written() const { return {bytes_.data(), end_}; }
  std::vector<std::byte> take() {
    bytes_.resize(end_);
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t end_ = 0;  ///< of what has been written; behind it there is room
};

/// Every read is held against what is left: a damaged snapshot is BadInput, never a look beyond its end.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  void operator()(T& value) {
    if (bytes_.size() < sizeof(T)) throw BadInput("snapshot: it ends early");
    std::memcpy(static_cast<void*>(&value), bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
  }
  /// A byte that is neither 0 nor 1 is no bool.
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    value = byte != 0;
  }
  /// A count of things of which each takes at least so many bytes.
  std::uint64_t count(std::size_t least) {
    std::uint64_t n = 0;
    (*this)(n);
    // before anything of that size is made: a damaged count would ask for all memory
    if (n > bytes_.size() / least) throw BadInput("snapshot: it ends early");
    return n;
  }
  bool done() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// Without the checksum at the end. @throws BadInput if it does not hold.
std::span<const std::byte> checked(std::span<const std::byte> bytes) {
  if (bytes.size() < sizeof(std::uint64_t)) throw BadInput("snapshot: it ends early");
  const auto content = bytes.first(bytes.size() - sizeof(std::uint64_t));
  std::uint64_t told = 0;
  std::memcpy(&told, bytes.data() + content.size(), sizeof told);
  if (told != checksum(content)) throw BadInput("snapshot: the checksum is wrong: it was damaged or cut");
  return content;
}

/// Reads or writes numbers of fixed size, in one order.
template <class Each, class Run>
void scalars(Each&& each, Run& run) {
  each(run.time);
  each(run.horizon);
  each(run.watch.max_overlap);
  each(run.watch.start_overlap);
  each(run.watch.flown_until);
  each(run.records.seq);
  each(run.records.frame);
  each(run.records.last_frame);
  each(run.records.last_event);
  each(run.endings.instant);
  each(run.endings.in_instant);
  each(run.endings.crawling);
  each(run.taken);
  each(run.random);
  WorkCounters::for_each(run.work, [&](auto, auto& value, auto) { each(value); });
}

/// What a body keeps whatever moves it. Its motion follows by kind.
template <class Each, class Track>
void track(Each&& each, Track& b) {
  each(b.version);
  each(b.velocity_rounding);
  each(b.resolved_at);
  each(b.last_partner);
  each(b.streak);
}

/// Islands whole: forces, modes, stretches and the limits that they wait for go on as they were.
void write_islands(Writer& out, const Islands::Saved& islands) {
  out(islands.tally);
  out(static_cast<std::uint64_t>(islands.islands.size()));
  for (const Island& i : islands.islands) {
    out(i.rests);
    out(i.pace);
    out(i.due);
    out(i.then);
    out(i.series);
    out(i.series_contact);
    out(static_cast<std::uint64_t>(i.members.size()));
    for (const int k : i.members) out(k);
    for (const auto* contacts : {&i.contacts, &i.leaning}) {
      out(static_cast<std::uint64_t>(contacts->size()));
      for (const HeldContact& c : *contacts) out(c);
    }
  }
}

/// @throws BadInput on a pair that this world has not.
void check(const PairKey& pair, const World& world) {
  const int bodies = static_cast<int>(world.bodies.size()), sites = static_cast<int>(world.sites.size());
  const bool with_body = pair.other_body >= 0 && pair.other_body < bodies && pair.other_site == -1;
  const bool with_site = pair.other_site >= 0 && pair.other_site < sites && pair.other_body == -1;
  if (pair.body < 0 || pair.body >= bodies || with_body == with_site)
    throw BadInput("snapshot: a contact is of no such pair");
}

/// @throws BadInput on features that the pair's outlines do not have.
void check(const PairKey& pair, bool sample_on_a, int sample, int site, const World& world) {
  check(pair, world);
  const Outline& a = *world.bodies[pair.body].outline;
  const Outline& b =
      pair.with_site() ? *world.sites[pair.other_site].outline : *world.bodies[pair.other_body].outline;
  const auto& samples = (sample_on_a ? a : b).samples;
  const auto& sites = (sample_on_a ? b : a).sites;
  if (sample < 0 || sample >= static_cast<int>(samples.size()) || site < 0 ||
      site >= static_cast<int>(sites.size()))
    throw BadInput("snapshot: a contact is of no such features");
}

/// @throws BadInput on a member that is none, or that is not held, and on contacts that there cannot be.
void read_islands(Reader& in, const Trajectories::Saved& bodies, const World& world,
                  Islands::Saved& islands) {
  in(islands.tally);
  // an island takes more bytes than that: it bounds the count, no more
  for (std::uint64_t n = in.count(sizeof(double)); n > 0; --n) {
    Island i;
    in(i.rests);
    in(i.pace);
    in(i.due);
    in(i.then);
    in(i.series);
    in(i.series_contact);
    i.members.resize(in.count(sizeof(int)));
    for (int& k : i.members) {
      in(k);
      // Islands::restore and Trajectories look members up by number: one that is not held has nothing
      // there.
      const bool held = k >= 0 && k < static_cast<int>(bodies.bodies.size()) &&
                        bodies.bodies[k].component == BodyTrack::kHeld;
      if (!held) throw BadInput("snapshot: an island has no such body");
    }
    if (i.members.empty()) throw BadInput("snapshot: an island has no body");
    for (auto* contacts : {&i.contacts, &i.leaning}) {
      contacts->resize(in.count(sizeof(HeldContact)));
      for (HeldContact& c : *contacts) {
        in(c);
        check(c.pair, c.feature.sample_on_a, c.feature.sample, c.feature.site, world);
      }
    }
    if (i.series.body >= 0) check(i.series, world);
    islands.islands.push_back(std::move(i));
  }
}

/// How a body moves, as it is written.
enum class Kind : std::uint8_t {
  driven,  ///< by an integrator
  free,
  held,    ///< by an island, and free otherwise
  asleep,  ///< held, and driven otherwise
};

/// Of body k, whose track is b.
Kind kind_of(const Trajectories::Saved& saved, const BodyTrack& b, int k) {
  if (b.component == BodyTrack::kHeld) return saved.is_asleep(k) ? Kind::asleep : Kind::held;
  return b.component < 0 ? Kind::free : Kind::driven;
}

/// Sets of bodies that were grouped while running (Trajectories::regroup).
void write_sets(Writer& out, const Trajectories::Sets& sets) {
  out(static_cast<std::uint64_t>(sets.size()));
  for (const std::vector<int>& set : sets) {
    out(static_cast<std::uint64_t>(set.size()));
    for (const int k : set) out(k);
  }
}

/// @throws BadInput on a body that this world has not.
Trajectories::Sets read_sets(Reader& in, std::size_t bodies) {
  Trajectories::Sets sets(in.count(sizeof(std::uint64_t)));
  for (std::vector<int>& set : sets) {
    set.resize(in.count(sizeof(int)));
    for (int& k : set) {
      in(k);
      if (k < 0 || static_cast<std::size_t>(k) >= bodies) throw BadInput("snapshot: it groups no such body");
    }
  }
  return sets;
}

/// What an island has a body do; pieces, where it is on a motion of its own.
/// A motion by modes is kept whole: no integrator makes it again.
void write_held(Writer& out, const HeldStep& step, const Motion& motion) {
  out(step);
  const Track* track = motion.track();
  out(static_cast<std::uint64_t>(track ? track->pieces.size() : 0));
  if (!track) return;
  for (const PolynomialPiece& p : track->pieces) {
    out(p.begin);
    out(p.end);
    out(p.origin);
    out(p.degree);
    for (int i = 0; i <= p.degree; ++i) out(p.c[i]);
  }
}

/// Without pieces `motion` stays what it is: constant twists from the state that was read with the body.
void read_held(Reader& in, HeldStep& step, Motion& motion) {
  in(step);
  const auto track = std::make_shared<Track>();
  for (std::uint64_t n = in.count(3 * sizeof(double)); n > 0; --n) {
    PolynomialPiece p;
    in(p.begin);
    in(p.end);
    in(p.origin);
    in(p.degree);
    if (p.degree < 0 || p.degree > PolynomialPiece::kMaxDegree)
      throw BadInput("snapshot: a motion has a piece of no such degree");
    for (int i = 0; i <= p.degree; ++i) in(p.c[i]);
    track->pieces.push_back(p);
  }
  if (!track->pieces.empty()) motion = Motion::dense(track);
}

/// First the bodies, each with a motion of its own if no integrator makes it; then where integrators began.
void write(Writer& out, const Trajectories::Saved& saved) {
  write_sets(out, saved.together);
  for (const BodyTrack& b : saved.bodies) {
    track(out, b);
    // the kind says what follows: nothing, a start, or a start and an island's step
    out(kind_of(saved, b, static_cast<int>(&b - saved.bodies.data())));
    // made again from the start of its component, below
    if (b.component >= 0) continue;
    out(b.motion.origin());
    out(b.motion.start());
    out(b.motion.start_low());
    if (b.component == BodyTrack::kHeld)
      write_held(out, saved.steps.at(static_cast<int>(&b - saved.bodies.data())), b.motion);
  }
  // the numbers of bodies are not written: they follow from the world and the sets above
  for (const ComponentStart& s : saved.starts) {
    out(s.time);
    for (const BodyState& state : s.states) out(state);
    out(static_cast<std::uint8_t>(!s.lows.empty()));
    for (const Pose& low : s.lows) out(low);
  }
}

/// The body, and its motion but for pieces. `asleep`: an integrator would drive it if no island held it.
BodyTrack read_body(Reader& in, bool& asleep) {
  BodyTrack b;
  track(in, b);
  Kind kind = Kind::driven;
  in(kind);
  // which component is found when it is made again; here it says only that there is one
  b.component = kind == Kind::driven ? 0 : kind == Kind::free ? BodyTrack::kFree : BodyTrack::kHeld;
  asleep = kind == Kind::asleep;
  if (b.component >= 0) return b;
  double origin = 0.0;
  BodyState start, low;
  in(origin);
  in(start);
  in(low);
  // without acceleration: of a free body it is found from the world again, a held one has none
  b.motion = Motion::ballistic(origin, start, {}, std::numeric_limits<double>::infinity(), low);
  return b;
}

/// @throws BadInput on what the world cannot have: a body flies freely though forces on it are no constants.
Trajectories::Saved read_trajectories(Reader& in, const World& world) {
  Trajectories::Saved saved;
  saved.together = read_sets(in, world.bodies.size());
  for (std::size_t k = 0; k < world.bodies.size(); ++k) {
    bool asleep = false;
    saved.bodies.push_back(read_body(in, asleep));
    BodyTrack& b = saved.bodies.back();
    if (b.component == BodyTrack::kHeld) read_held(in, saved.steps[static_cast<int>(k)], b.motion);
    if (asleep) saved.asleep.push_back(static_cast<int>(k));
  }
  // Components come in the order in which they were written, and each is of as many bodies: starts have no numbers.
  // One whose body flies freely has none.
  for (const Component& c : make_components(world, saved.together)) {
    if (saved.bodies[c.bodies.front()].component < 0 && !saved.is_asleep(c.bodies.front())) {
      if (c.bodies.size() > 1 || !c.dynamics->constant())
        throw BadInput("snapshot: a body flies freely that cannot");
      continue;
    }
    // a state for each of its bodies; what rounding left over of their places only if a byte says so
    ComponentStart s{static_cast<int>(saved.starts.size()), 0.0, std::vector<BodyState>(c.bodies.size()), {}};
    in(s.time);
    for (BodyState& state : s.states) in(state);
    std::uint8_t with_lows = 0;
    in(with_lows);
    if (with_lows) s.lows.resize(c.bodies.size());
    for (Pose& low : s.lows) in(low);
    saved.starts.push_back(std::move(s));
  }
  return saved;
}

}  // namespace

/// What only decides how much work is done (broad phase, closed forms, shared fields) is left out: events are the same
/// with it on or off.
std::uint64_t snapshot_fingerprint(const World& world, const SolverOptions& options) {
  StateHash hash;
  hash.add(world_hash(world));
  for (const std::string* word :
       {&options.policy, &options.integrator, &options.order, &options.response, &options.detector}) {
    // with its length: two words that are one text together do not look alike to it
    hash.add(static_cast<std::uint64_t>(word->size()));
    for (const char c : *word) hash.add(static_cast<std::uint64_t>(c));
  }
  hash.add(options.tolerance);
  hash.add(options.absolute_tolerance);
  hash.add(options.step);
  hash.add(options.contact_tolerance);
  hash.add(options.modes_contacts);
  hash.add(options.rest_speed);
  hash.add(options.island_tolerance);
  hash.add(static_cast<std::uint64_t>(options.persistent));
  hash.add(options.seed);
  return hash.value();
}

/// In this order, each as it lies in memory:
///   magic, fingerprint
///   numbers of fixed size      time, records, counters ...
///   why it failed              the text; empty where it can go on
///   sets of bodies             that were grouped
///   bodies                     track, kind; motion, where no integrator makes it again
///   starts                     of components, in their order
///   islands
///   the present instant        whose bodies have collided in it
///   bounces                    of every series that is watched
///   checksum                   of all that
/// Where a number of things can vary it stands before them, but for bodies and starts, which the world tells.
std::vector<std::byte> encode(const SavedRun& saved, std::uint64_t fingerprint) {
  Writer out;
  // more than a free body takes, and what else there is in a small world: larger ones grow now and then
  out.expect(2048 + 256 * saved.trajectories.bodies.size());
  out(kMagic);
  out(fingerprint);
  scalars(out, saved);
  out(static_cast<std::uint64_t>(saved.failure.size()));
  for (const char c : saved.failure) out(c);
  write(out, saved.trajectories);
  write_islands(out, saved.islands);
  out(saved.endings.often);
  out(static_cast<std::uint64_t>(saved.endings.bodies.size()));
  for (const int k : saved.endings.bodies) out(k);
  out(static_cast<std::uint64_t>(saved.endings.bounces.size()));
  for (const auto& [feature, bounce] : saved.endings.bounces) {
    out(feature);
    out(bounce);
  }
  out(checksum(out.written()));
  return out.take();
}

/// The world is only looked at: whoever asks puts the answer back when all of it has been read.
SavedRun decode(std::span<const std::byte> bytes, const World& world, std::uint64_t fingerprint) {
  Reader in(bytes);
  std::array<char, 8> magic{};
  std::uint64_t print = 0;
  in(magic);
  in(print);
  // first: of bytes that are no snapshot nothing else means anything
  if (magic != kMagic) throw BadInput("snapshot: these bytes are not a snapshot of this version");
  if (print != fingerprint) throw BadInput("snapshot: it was taken of another world or with other options");
  in = Reader(checked(bytes).subspan(magic.size() + sizeof print));
  SavedRun saved;
  scalars(in, saved);
  saved.failure.resize(in.count(sizeof(char)));
  for (char& c : saved.failure) in(c);
  saved.trajectories = read_trajectories(in, world);
  read_islands(in, saved.trajectories, world, saved.islands);
  in(saved.endings.often);
  saved.endings.bodies.resize(in.count(sizeof(int)));
  for (int& k : saved.endings.bodies) {
    in(k);
    if (k < 0 || k >= static_cast<int>(world.bodies.size()))
      throw BadInput("snapshot: a group of contacts is of no such body");
  }
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
