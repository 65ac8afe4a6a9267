// Bodies that are put on others: who is meant, in which order, and where they come to lie.
#include <algorithm>
#include <map>

#include "brink/scenes/scene/build.h"
#include "brink/scenes/scene/landing.h"

namespace brink {
namespace {

/// What one name stands for: a thing, or one copy of it.
/// Kept by pointer to the planned thing, whose copies are still to come where it waits itself.
struct Ground {
  PlannedThing* thing = nullptr;
  std::optional<std::size_t> copy;
};

/// All bodies with the key `touching`. Names are looked up as it is made; place() then takes one after
/// the other.
class Touching {
 public:
  Touching(std::vector<PlannedThing>& sites, std::vector<PlannedThing>& bodies, const PlaceRules& rules,
           FaultList& faults)
      : bodies_(bodies), rules_(rules), faults_(faults) {
    for (auto* things : {&sites, &bodies})
      for (PlannedThing& thing : *things) {
        // A site and a body may share a name, two bodies may not: who is meant is told in find().
        called_[thing.name].push_back(&thing);
        words_.push_back(thing.name);
      }
    for (PlannedThing& thing : bodies_)
      if (thing.table->touching.given) waiting_.emplace(&thing, grounds_of(thing));
  }

  /// Each after what it is put on; what is left over waits for itself.
  /// Kahn's algorithm (1962): `missing` counts the grounds that are not placed yet, `above` says who
  /// waits for whom. Maps by pointer are looked up, never walked, so the order is that of the file.
  void place() {
    std::map<const PlannedThing*, std::vector<PlannedThing*>> above;
    std::map<const PlannedThing*, std::size_t> missing;
    // Bodies whose grounds are all placed, in the order in which they became so.
    std::vector<PlannedThing*> ready;
    for (PlannedThing& thing : bodies_) {
      if (!waiting_.contains(&thing)) continue;
      for (const Ground& ground : waiting_.at(&thing)) {
        // What does not wait itself is placed already, or is a site.
        if (!waiting_.contains(ground.thing)) continue;
        ++missing[&thing];
        above[ground.thing].push_back(&thing);
      }
      if (missing[&thing] == 0) ready.push_back(&thing);
    }
    std::size_t placed = 0;
    for (; placed < ready.size(); ++placed) {
      put(*ready[placed]);
      for (PlannedThing* thing : above[ready[placed]])
        if (--missing[thing] == 0) ready.push_back(thing);
    }
    // Whoever is left has a ground that is left, too: somewhere they wait in a circle.
    if (placed < waiting_.size()) tell_circle(missing);
  }

 private:
  /// What the names of a body stand for; those that stand for nobody are faults and left out.
  std::vector<Ground> grounds_of(PlannedThing& thing) {
    const auto& touching = thing.table->touching;
    std::vector<Ground> out;
    if (touching.value.empty())
      faults_.add(touching.where, "touching: names nobody; given [], allowed: names of bodies and sites");
    for (const std::string& name : touching.value)
      if (const auto ground = find(name, thing)) out.push_back(*ground);
    if (!down_of(*thing.table, rules_.gravity))
      faults_.add(touching.where,
                  "touching: there is no way down; given no gravity and no touching_direction, allowed: "
                  "either of them, not [0, 0]");
    return out;
  }

  /// Empty after a fault. Refused is what cannot be stood on: the body itself, what has no place until
  /// everything else has one, and a name that means two.
  std::optional<Ground> find(const std::string& name, const PlannedThing& thing) {
    const Where& where = thing.table->touching.where;
    Ground ground;
    std::string called = name;
    // A thing that is itself called "a[0]" goes before the first copy of "a".
    if (!called_.contains(name)) std::tie(called, ground.copy) = copy_named(name);
    const auto found = called_.find(called);
    if (found == called_.end() || (ground.copy && !has_copy(*found->second.front(), *ground.copy))) {
      faults_.add(where, "touching: no body or site is called " + in_quotes(name) + "; the nearest name is " +
                             in_quotes(nearest_word(name, words_)));
      return std::nullopt;
    }
    ground.thing = found->second.front();
    const ThingTable& table = *ground.thing->table;
    std::string wrong;
    if (found->second.size() > 1) wrong = "stands for a site and a body";
    if (ground.thing == &thing) wrong = "is the body itself";
    if (table.scatter.given || table.pile.given) wrong = "has no place before the others";
    if (wrong.empty()) return ground;
    faults_.add(where, "touching: " + wrong + "; given " + in_quotes(name) +
                           ", allowed: another body, or a site, that stands where it is told");
    return std::nullopt;
  }

  /// By number, as the copies themselves may not be there yet.
  static bool has_copy(const PlannedThing& thing, std::size_t copy) {
    const CopyCount copies = copies_of(*thing.table);
    return copies.copied && static_cast<std::int64_t>(copy) < copies.count;
  }

  /// Lets one body down onto its grounds, which are placed, and fills its copies.
  void put(PlannedThing& thing) {
    if (!faults_.empty()) return;
    LandingAsk ask;
    ask.outline = thing.shape.outline.get();
    ask.position = thing.pose.position;
    // Of a stack or a pyramid, all its copies: they move as one, and land when the first of them does.
    ask.copies = standing_poses(thing, rules_);
    ask.direction = *down_of(*thing.table, rules_.gravity);
    ask.periods = rules_.periods;
    ask.thin = rules_.thin;
    for (const Ground& ground : waiting_.at(&thing)) add_obstacles(ground, ask.grounds);
    const Landing landing = land(ask);
    if (landing.status != Landing::Status::lands) return tell(thing, landing.status);
    for (const Pose& pose : ask.copies(landing.position, kAllCopies)) {
      thing.copies.push_back(start_of(thing));
      thing.copies.back().pose = pose;
    }
  }

  /// The copies of a ground that are meant, all or one, each where it is at t = 0.
  static void add_obstacles(const Ground& ground, std::vector<Obstacle>& out) {
    for (std::size_t k = 0; k < ground.thing->copies.size(); ++k) {
      if (ground.copy && *ground.copy != k) continue;
      out.push_back(at_start(*ground.thing, ground.thing->copies[k]));
    }
  }

  /// The fault of a landing that is none, with the place it began at and the way it took.
  void tell(const PlannedThing& thing, Landing::Status status) {
    const auto& touching = thing.table->touching;
    const Vec2& p = thing.pose.position;
    const Vec2 down = *down_of(*thing.table, rules_.gravity);
    const std::string at = in_quotes(thing.name) + " at [" + number_text(p.x()) + ", " + number_text(p.y()) +
                           "], moved along [" + number_text(down.x()) + ", " + number_text(down.y()) + "]";
    const std::string names = in_quotes(listed(touching.value));
    if (status == Landing::Status::never)
      faults_.add(touching.where, "touching: never meets " + names + "; given " + at +
                                      ", allowed: a position from which it does");
    else
      faults_.add(touching.where, "touching: overlaps " + names + " where it is written; given " + at +
                                      ", allowed: a position clear of it");
  }

  /// One of those that wait for each other, and all between.
  void tell_circle(const std::map<const PlannedThing*, std::size_t>& missing) {
    const auto waits = [&](const PlannedThing* thing) {
      const auto found = missing.find(thing);
      return found != missing.end() && found->second > 0;
    };
    // The first of them in the file, so that the message is the same at every reading.
    const PlannedThing* at = nullptr;
    for (const PlannedThing& thing : bodies_)
      if (at == nullptr && waits(&thing)) at = &thing;
    // From anyone who waits to someone that it waits for, until one comes again: what was walked before
    // the first visit of that one is not part of the circle.
    std::vector<const PlannedThing*> way;
    while (std::find(way.begin(), way.end(), at) == way.end()) {
      way.push_back(at);
      for (const Ground& ground : waiting_.at(at))
        // Of several the last one: whichever it is, it waits, so the walk never ends at somebody who is
        // placed.
        if (waits(ground.thing)) at = ground.thing;
    }
    // "A on B on A": the circle from its first body to the same one again.
    std::string text;
    for (auto it = std::find(way.begin(), way.end(), at); it != way.end(); ++it) text += (*it)->name + " on ";
    faults_.add(at->table->touching.where, "touching: goes round in a circle; given " +
                                               in_quotes(text + at->name) +
                                               ", allowed: each on what is placed without it");
  }

  std::vector<PlannedThing>& bodies_;
  const PlaceRules& rules_;
  FaultList& faults_;
  std::map<std::string, std::vector<PlannedThing*>> called_;
  std::vector<std::string> words_;
  std::map<const PlannedThing*, std::vector<Ground>> waiting_;
};

}  // namespace

void put_on_others(std::vector<PlannedThing>& sites, std::vector<PlannedThing>& bodies,
                   const PlaceRules& rules, FaultList& faults) {
  Touching(sites, bodies, rules, faults).place();
}

}  // namespace brink
