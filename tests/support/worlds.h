#pragma once
/// Small worlds for tests, built in code.

#include <string>

#include "brink/core/shapes/shapes.h"
#include "brink/core/world/make_body.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink::testing {

inline std::shared_ptr<const Outline> outline(const Shape& shape) {
  return std::make_shared<const Outline>(centered(shape).outline);
}

inline Body body(const Shape& shape, const Vec2& position, const Vec2& velocity, double mass = 1.0,
                 double angle = 0.0, double omega = 0.0) {
  const bool point = shape.measure.size == 0.0;  // whose inertia nothing feels
  Body b = point ? Body() : make_body(shape, Mass{mass});
  if (point) {
    b.outline = outline(shape);
    b.mass = b.inertia = mass;
  }
  b.initial = {{position, angle}, {velocity, omega}};
  return b;
}

inline FixedSite site(const Shape& shape, const Vec2& position = Vec2::Zero(), double angle = 0.0) {
  FixedSite s;
  s.outline = std::make_shared<const Outline>(shape.outline);
  s.pose = {position, angle};
  return s;
}

/// Adds a body, named by its number if it has no name.
inline int add(World& world, Body b) {
  if (b.name.empty()) b.name = "body" + std::to_string(world.bodies.size());
  world.bodies.push_back(std::move(b));
  return static_cast<int>(world.bodies.size()) - 1;
}
inline int add(World& world, FixedSite s) {
  if (s.name.empty()) s.name = "site" + std::to_string(world.sites.size());
  if (s.kind.empty()) s.kind = "shape";
  world.sites.push_back(std::move(s));
  return static_cast<int>(world.sites.size()) - 1;
}

/// Keeps every event.
class Events : public Recorder {
 public:
  void frame(double t, std::span<const BodyState> states) override {
    frame_times.push_back(t);
    last_frame.assign(states.begin(), states.end());
  }
  void event(const Event& e) override { events.push_back(e); }
  void checkpoint(double, const std::vector<std::byte>& state) override { last_checkpoint = state; }

  std::vector<Event> collisions() const {
    std::vector<Event> c;
    for (const Event& e : events)
      if (e.kind == EventKind::collision) c.push_back(e);
    return c;
  }
  std::vector<Event> events;
  std::vector<double> frame_times;
  std::vector<BodyState> last_frame;
  std::vector<std::byte> last_checkpoint;
};

inline RunOptions until(double t) {
  RunOptions options;
  options.until = t;
  options.checkpoint_seconds = -1.0;
  return options;
}

}  // namespace brink::testing
