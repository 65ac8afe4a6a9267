#include "brink/scheduler/classic/depth_normal.h"

#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

/// Depth rises by one metre a metre; differences that say less than half of that are cut short.
constexpr double kLeastSlope = 0.5;

/// > 0 on one side of the line or circle that the site lies on, < 0 on the other.
double side_of_line(const Site& site, const Vec2& q) {
  if (site.kind == SiteKind::segment) return cross(site.b - site.a, q - site.a);
  return site.kind == SiteKind::arc ? beyond_circle(site, q, q - site.center) : 1.0;
}

}  // namespace

DepthNormal normal_of(const Site& site, const ParticlePlace& particle,
                      const std::function<Vec2()>& gradient) {
  const Nearest nearest = nearest_on(site, particle.now);
  DepthNormal answer{normal_at(site, nearest, particle.now), false};
  if (site.kind == SiteKind::arc) {
    const Vec2 slope = gradient();
    // the picture's own slope may still point through a wire that runs between the pixels it was taken from
    if (slope.norm() > kLeastSlope && slope.dot(answer.normal) > 0.0) answer.normal = slope.normalized();
  }
  // a solid's inside tells the side; what approaches is met from where it is
  if (site.solid || particle.velocity.dot(answer.normal) <= 0.0) return answer;
  // It recedes: on its own side it has bounced, on the other it is going through.
  if (side_of_line(site, particle.now) * side_of_line(site, particle.before) < 0.0) {
    answer.normal = -answer.normal;
    answer.crossed = true;
  }
  return answer;
}

}  // namespace brink
