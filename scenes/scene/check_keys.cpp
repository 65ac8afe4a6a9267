// Keys of one entry that contradict each other.
// A schema sees one key at a time, so what two keys say together is checked here, for bodies and sites
// alike. Which keys go with a shape is ShapeBuilder::fits().
#include "brink/scenes/scene/build.h"

namespace brink {
namespace {

/// One way of making copies at most: two of them would not say how many there are.
void check_copies(const ThingTable& table, FaultList& faults) {
  // The fault stands at the last of them in this list.
  std::vector<std::string> asked;
  Where last;
  const auto ask = [&](const char* key, const auto& given) {
    if (!given.given) return;
    asked.emplace_back(key);
    last = given.where;
  };
  ask("grid", table.grid);
  ask("scatter", table.scatter);
  ask("stack", table.stack);
  ask("pyramid", table.pyramid);
  ask("wall", table.wall);
  ask("pile", table.pile);
  if (asked.size() > 1)
    faults.add(last, "copies are asked for twice; given " + listed(asked) + ", allowed: one of them");
}

// Keys that say which way is down, or need to know it.
void check_touching(const ThingTable& table, FaultList& faults) {
  const bool at_random = table.scatter.given || table.pile.given;
  if (table.touching.given && at_random)
    faults.add(table.touching.where,
               std::string("touching: has no meaning beside what is placed at random; given ") +
                   (table.pile.given ? "pile" : "scatter") +
                   ", allowed beside: grid, stack, pyramid, wall, or no copies");
  if (!table.touching_direction.given) return;
  if (table.touching_direction.value.isZero(0.0))
    faults.add(table.touching_direction.where,
               "touching_direction: is no direction; given [0, 0], allowed: a vector of any other length");
  if (!table.touching.given && !table.stack.given && !table.pyramid.given && !table.wall.given &&
      !table.pile.given)
    faults.add(table.touching_direction.where,
               "touching_direction: has no meaning alone; given nothing that it directs, allowed beside: "
               "touching, stack, pyramid, wall, pile");
}

}  // namespace

void check_keys(const ThingTable& table, FaultList& faults) {
  if (table.angle.given && table.angle_deg.given)
    faults.add(table.angle_deg.where,
               "angle is given twice; given angle and angle_deg, allowed: one of them");
  if (table.mass.given && table.density.given)
    faults.add(table.density.where, "mass is given twice; given mass and density, allowed: one of them");
  check_copies(table, faults);
  check_touching(table, faults);
}

}  // namespace brink
