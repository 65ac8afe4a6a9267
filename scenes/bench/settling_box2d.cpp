// The heap in Box2D. It computes in float, with lengths in metres, as its tolerances are made for.
#include <box2d/box2d.h>

#include <algorithm>
#include <ctime>

#include "brink/scenes/bench/settling.h"

namespace brink::bench {

namespace {

/// Rounded to float.
b2Vec2 box2d_vector(const Vec2& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y())}; }

/// Gives `body` the outline of a disc or of a convex polygon. @pre it is one of these
void add_fixture(b2Body* body, const Outline& outline, double density) {
  b2FixtureDef fixture;
  b2CircleShape circle;
  b2PolygonShape polygon;
  if (outline.is_point()) {
    circle.m_radius = static_cast<float>(outline.bounding_radius);
    fixture.shape = &circle;
  } else {
    // The samples of a convex polygon are its vertices.
    std::vector<b2Vec2> corners;
    for (const Sample& s : outline.samples) corners.push_back(box2d_vector(s.p));
    polygon.Set(corners.data(), static_cast<int32>(corners.size()));
    fixture.shape = &polygon;
  }
  // Box2D combines frictions by their geometric mean, so 0.5 and 0.5 make 0.5.
  fixture.density = static_cast<float>(density);
  fixture.friction = 0.5f;
  fixture.restitution = 0.0f;
  body->CreateFixture(&fixture);
}

/// A body or site of the heap with its outline about its centre of mass.
b2Body* add(b2World& world, b2BodyType type, const Outline& outline, const Pose& pose) {
  b2BodyDef def;
  def.type = type;
  def.position = box2d_vector(pose.position);
  def.angle = static_cast<float>(pose.angle);
  b2Body* body = world.CreateBody(&def);
  // The density of the scene is 1 kg/m^2.
  add_fixture(body, outline, 1.0);
  return body;
}

}  // namespace

Settled settle_with_box2d(const Heap& heap) {
  const World& given = heap.scene.world;
  b2World world(box2d_vector(given.gravity));
  for (const FixedSite& site : given.sites) add(world, b2_staticBody, *site.outline, site.pose);
  std::vector<b2Body*> bodies;
  for (const Body& b : given.bodies) bodies.push_back(add(world, b2_dynamicBody, *b.outline, b.initial.pose));
  Settled settled{"Box2D 2.4.1"};
  for (int frame = 1; frame * kFrame < heap.scene.duration; ++frame) {
    const std::clock_t begin = std::clock();
    // Iterations for velocities and for positions, as its manual recommends.
    world.Step(static_cast<float>(kFrame), 8, 3);
    settled.cpu_seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    // Overlaps are measured in double, by Brink's own outlines; places are floats.
    std::vector<Pose> poses;
    for (const b2Body* b : bodies) poses.push_back({{b->GetPosition().x, b->GetPosition().y}, b->GetAngle()});
    settled.overlap = std::max(settled.overlap, deepest_overlap(given, poses));
    // The first frame in which nobody is awake counts.
    if (std::none_of(bodies.begin(), bodies.end(), [](const b2Body* b) { return b->IsAwake(); }))
      settled.at_rest = std::min(settled.at_rest, frame * kFrame);
  }
  return settled;
}

}  // namespace brink::bench
