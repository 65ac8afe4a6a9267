// The heap in Chipmunk, which computes in double.
#include <chipmunk/chipmunk.h>

#include <algorithm>
#include <ctime>
#include <memory>

#include "brink/scenes/bench/settling.h"

namespace brink::bench {

namespace {

cpVect chipmunk_vector(const Vec2& v) { return cpv(v.x(), v.y()); }

/// Frees what it holds in the order in which Chipmunk wants it.
struct Space {
  cpSpace* space = cpSpaceNew();
  std::vector<cpShape*> shapes;
  std::vector<cpBody*> bodies;

  Space() = default;
  Space(const Space&) = delete;
  Space& operator=(const Space&) = delete;
  ~Space() {
    // Shapes hang on bodies and both on the space: taken out and freed in this order.
    for (cpShape* s : shapes) cpSpaceRemoveShape(space, s), cpShapeFree(s);
    for (cpBody* b : bodies) cpSpaceRemoveBody(space, b), cpBodyFree(b);
    cpSpaceFree(space);
  }

  /// Takes the body over, and gives it the shape of a disc or of a convex polygon. @pre it is one of these
  void add(cpBody* body, const Outline& outline, const Pose& pose) {
    cpBodySetPosition(body, chipmunk_vector(pose.position));
    cpBodySetAngle(body, pose.angle);
    cpSpaceAddBody(space, body);
    bodies.push_back(body);
    cpShape* shape = nullptr;
    // A disc is one point with a radius; the samples of a convex polygon are its vertices.
    if (outline.is_point()) {
      shape = cpCircleShapeNew(body, outline.bounding_radius, cpvzero);
    } else {
      std::vector<cpVect> corners;
      for (const Sample& s : outline.samples) corners.push_back(chipmunk_vector(s.p));
      shape =
          cpPolyShapeNew(body, static_cast<int>(corners.size()), corners.data(), cpTransformIdentity, 0.0);
    }
    cpShapeSetFriction(shape, std::sqrt(0.5));  // of two shapes Chipmunk takes the product
    cpShapeSetElasticity(shape, 0.0);
    cpSpaceAddShape(space, shape);
    shapes.push_back(shape);
  }
};

}  // namespace

Settled settle_with_chipmunk(const Heap& heap) {
  const World& given = heap.scene.world;
  Space world;
  cpSpaceSetGravity(world.space, chipmunk_vector(given.gravity));
  cpSpaceSetCollisionSlop(world.space, 0.005);
  // Bodies sleep after half a second at rest, as Box2D's do; without this they never do.
  cpSpaceSetSleepTimeThreshold(world.space, 0.5);
  for (const FixedSite& site : given.sites) world.add(cpBodyNewStatic(), *site.outline, site.pose);
  // Sites come first in the list of bodies, and have no state to look at.
  const std::size_t first = world.bodies.size();
  for (const Body& b : given.bodies) world.add(cpBodyNew(b.mass, b.inertia), *b.outline, b.initial.pose);
  Settled settled{"Chipmunk 7"};
  for (int frame = 1; frame * kFrame < heap.scene.duration; ++frame) {
    // Processor time of the step alone, without the look at overlaps.
    const std::clock_t begin = std::clock();
    cpSpaceStep(world.space, kFrame);
    settled.cpu_seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::vector<Pose> poses;
    bool asleep = true;
    for (std::size_t k = first; k < world.bodies.size(); ++k) {
      const cpVect at = cpBodyGetPosition(world.bodies[k]);
      poses.push_back({{at.x, at.y}, cpBodyGetAngle(world.bodies[k])});
      asleep = asleep && cpBodyIsSleeping(world.bodies[k]);
    }
    settled.overlap = std::max(settled.overlap, deepest_overlap(given, poses));
    // The first time; who wakes again has still been at rest once.
    if (asleep) settled.at_rest = std::min(settled.at_rest, frame * kFrame);
  }
  return settled;
}

}  // namespace brink::bench
