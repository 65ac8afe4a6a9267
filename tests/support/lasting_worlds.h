#pragma once
/// Random small worlds with gravity in which contacts last: bodies of every shape that settle, slide and roll
/// on grounds of every kind.

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/worlds.h"

namespace brink::testing {

struct LastingWorld {
  World world;
  std::string ground;
  double duration = 2.0;          ///< [s]
  double island_tolerance = 0.0;  ///< the option [m]
  std::string order = "index";    ///< the option
  bool moves = false;             ///< a site gives or takes energy
  bool pulls = false;             ///< springs or drag
};

class LastingWorldMaker {
 public:
  /// Seeds from this one on are of heaps: 16 to 25 bodies at once, not one to twelve.
  static constexpr std::uint64_t kHeaps = 1000000;

  explicit LastingWorldMaker(std::uint64_t seed)
      : seed_(seed), random_(seed), columns_(seed < kHeaps ? 3 : 5) {}

  LastingWorld make() {
    made_.duration = random_.uniform(2.0, 5.0);
    made_.world.gravity = {0.0, -9.81};
    materials();
    ground();
    const int count =
        seed_ < kHeaps ? 1 + static_cast<int>(random_.below(12)) : 16 + static_cast<int>(random_.below(10));
    for (int k = 0; k < count; ++k) add_body(k);
    if (seed_ % 5 == 0 && count > 1) join();
    if (seed_ % 7 == 0) slow_down();
    if (seed_ % 4 == 3)  // hard to roll, up to a tenth of the smallest bodies
      for (Material& m : made_.world.materials) m.rolling_resistance = random_.uniform(0.0, 0.01);
    if (seed_ % 6 == 4) made_.island_tolerance = seed_ % 12 == 4 ? 1e-5 : 1e-6;
    return made_;
  }

 private:
  void materials() {
    made_.world.materials.assign(3, Material{});
    for (Material& m : made_.world.materials) {
      m.name = std::string("m") + std::to_string(&m - made_.world.materials.data());
      m.restitution = random_.below(3) == 0 ? 0.0 : random_.uniform(0.0, 0.9);
      m.friction = random_.below(4) == 0 ? 0.0 : random_.uniform(0.0, 1.0);
    }
    made_.world.restitution_rule = Combine::min;
    const std::uint64_t kind = random_.below(3);
    for (Material& m : made_.world.materials)
      (kind == 0 ? m.friction : m.restitution) *= kind == 2 ? 1.0 : 0.0;
  }

  void wall(const Vec2& a, const Vec2& b, double radius = 0.0) { stand(site(make_segment(a, b, radius))); }
  int stand(FixedSite s) {
    s.material = static_cast<int>(random_.below(3));
    return add(made_.world, std::move(s));
  }
  void room(const Outline& outline, const Vec2& at) {
    FixedSite s;
    s.outline = std::make_shared<const Outline>(as_container(outline));
    s.pose.position = at;
    stand(s);
  }

  void ground() {
    static constexpr std::array kGrounds{"bin", "slope", "groove", "bowl", "room", "cell", "shaker", "belt"};
    const std::size_t kind = seed_ % kGrounds.size();
    made_.ground = kGrounds[kind];
    switch (kind) {
      case 0:
        return bin();
      case 1:
        return slope();
      case 2:
        return groove();
      case 3:
        return bowl();
      case 4:
        return room(make_box(3.0, 6.0).outline, {0.0, 3.0});
      case 5:
        return cell();
      case 6:
        return shaker();
      default:
        return belt();
    }
  }
  void bin() {
    wall({-1.2, 0.0}, {1.2, 0.0});
    wall({-1.2, 0.0}, {-1.2, 6.0});
    wall({1.2, 0.0}, {1.2, 6.0});
  }
  void slope() {
    const double steep = random_.uniform(0.1, 0.7);
    wall({-4.0, 0.0}, {4.0, 8.0 * std::tan(steep)}, random_.below(2) ? 0.0 : 0.1);
    wall({-4.0, -1.0}, {-4.0, 8.0});
  }
  void groove() {
    const double depth = random_.uniform(0.3, 1.0);
    stand(site(make_polygon(
        {{-3, -2}, {3, -2}, {3, 1.5}, {1.5, 0}, {0.4, 0}, {0, -depth}, {-0.4, 0}, {-1.5, 0}, {-3, 1.5}})));
  }
  void bowl() { stand(site(make_disc_container(2.0), {0.0, 1.5})); }
  /// Two of its sites are one floor, image after image.
  void cell() {
    made_.world.periods.size = {4.0, 0.0};
    wall({-2.0, 0.0}, {0.5, 0.0});
    wall({0.5, 0.0}, {2.0, 0.0});
  }
  void shaker() {
    FixedSite table = site(make_box(6.0, 0.5), {0.0, -0.25});
    FormulaMotion motion;
    const std::string amplitude = std::to_string(random_.uniform(0.01, 0.1));
    (random_.below(2) ? motion.x : motion.y).emplace(amplitude + "*sin(4*t)", std::vector<std::string>{"t"});
    table.motion = motion;
    stand(table);
    made_.moves = true;
  }
  /// A wheel below, a floor that rises.
  void belt() {
    FixedSite wheel = site(make_disc(1.5), {-1.6, -1.5}), lift = site(make_box(3.0, 0.4), {1.6, -0.2});
    wheel.motion = ConstantMotion{{Vec2::Zero(), random_.uniform(-1.0, 1.0)}};
    lift.motion = ConstantMotion{{{0.0, random_.uniform(0.0, 0.3)}, 0.0}};
    stand(wheel);
    stand(lift);
    made_.moves = true;
  }

  Shape shape() {
    const double size = random_.uniform(0.1, 0.22) * (columns_ == 3 ? 1.0 : 0.8);
    switch (random_.below(7)) {
      case 0:
      case 1:
        return make_disc(size);
      case 2:
        return make_box(2 * size, size * random_.uniform(0.5, 1.4));
      case 3:
        return make_polygon(regular(3 + static_cast<int>(random_.below(4)), size));
      case 4:
        return make_box(1.6 * size, size, 0.2 * size);
      case 5:
        return make_capsule(size, 0.5 * size);
      default:
        return make_chain(regular(5, size), true, 0.1 * size);
    }
  }
  static std::vector<Vec2> regular(int corners, double radius) {
    std::vector<Vec2> v;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      v.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return v;
  }

  void add_body(int k) {
    const double base = made_.ground == "slope" ? 4.5 : made_.ground == "groove" ? 0.5 : 0.3;
    const double pitch = columns_ == 3 ? 0.6 : 0.46;
    const Vec2 at(pitch * (k % columns_ - columns_ / 2) + random_.uniform(-0.01, 0.01),
                  base + 0.55 * (k / columns_));
    const bool flat = random_.below(3) == 0;
    Body b =
        body(shape(), at, {random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 0.5)}, random_.uniform(0.5, 2.0),
             flat ? 0.0 : random_.uniform(0.0, 6.0), flat ? 0.0 : random_.uniform(-3.0, 3.0));
    b.material = static_cast<int>(random_.below(3));
    if (random_.below(12) == 0) b.lock_angle = true, b.initial.twist.omega = 0.0;
    if (random_.below(20) == 0) b.lock_x = true, b.initial.twist.velocity.x() = 0.0;
    add(made_.world, std::move(b));
  }

  void join() {
    SpringForce spring;
    spring.body_a = 0;
    spring.body_b = 1;
    spring.stiffness = random_.uniform(5.0, 50.0);
    spring.damping = random_.uniform(0.0, 1.0);
    spring.rest_length = 0.6;
    made_.world.forces.emplace_back(spring);
    made_.pulls = true;
  }
  void slow_down() {
    DragForce drag;
    drag.bodies = {0};
    drag.linear = random_.uniform(0.1, 1.0);
    drag.angular = 0.01;
    made_.world.forces.emplace_back(drag);
    made_.pulls = true;
  }

  std::uint64_t seed_;
  Random random_;
  int columns_;  ///< that bodies start in
  LastingWorld made_;
};

}  // namespace brink::testing
