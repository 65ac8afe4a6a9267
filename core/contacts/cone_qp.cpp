#include "brink/core/contacts/cone_qp.h"

namespace brink {

/// Rows of the relative velocity at one point, body minus other: hence the opposite signs on the other, each
/// with its own arm to that point.
LastingContact contact_at(int body, int other, const Vec2& normal, const Vec2& arm, const Vec2& other_arm) {
  const Vec2 tangent = perp(normal);
  LastingContact c;
  c.body = body;
  c.other = other;
  // d . (v + omega x r) = d . v + omega (r x d), so that the angle's coefficient of a direction d is r x d
  c.normal_on_body = {normal.x(), normal.y(), cross(arm, normal)};
  c.tangent_on_body = {tangent.x(), tangent.y(), cross(arm, tangent)};
  if (other < 0) return c;
  c.normal_on_other = {-normal.x(), -normal.y(), -cross(other_arm, normal)};
  c.tangent_on_other = {-tangent.x(), -tangent.y(), -cross(other_arm, tangent)};
  return c;
}

}  // namespace brink
