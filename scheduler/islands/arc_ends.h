#pragma once
/// An arc of a carrier that looks past a site: its end there stands for it. Internal to near_features().

#include <optional>

#include "brink/scheduler/islands/outline_half.h"

namespace brink::islands {

/// Where an end of an arc lies beside a site of the other.
struct ArcEnd {
  Vec2 q;  ///< in the other's frame
  Nearest nearest;
  double gap = 0.0;  ///< [m]
};

/// The end of a carrier's arc beyond which the direction `towards` points, in the carrier's frame. `out`: to which side of the
/// site, as seen from `at` there, counts as before it.
ArcEnd end_beside(const Half& half, const Site& arc, const Vec2& towards, const Site& site, const Vec2& out,
                  const Vec2& at);

/// To where an arc whose centre is at q would have to face for it to lie on the site, in the carrier's frame: `towards` its
/// nearest place, which is across it; beyond an end of a straight one, across its line.
Vec2 facing(const Half& half, const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& towards);

/// The feature of an arc's sample i that looks past site j, if by no more than may be turned in a step: the end of it there, which
/// has a feature of its own, and stands here for the arc that may come to lie on the site. Not of what is behind the site; nor of
/// a wire's arc whose hollow holds the end of one.
std::optional<NearFeature> beside_arc(const Half& half, int i, int j, const Vec2& q, const Vec2& way,
                                      double side, const Nearest& nearest, double reach);

}  // namespace brink::islands
