#pragma once
/// A pair of outlines at one moment: which features are close, their gaps and rates. What first_contact's
/// search looks through.

#include <algorithm>
#include <span>
#include <vector>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/first_contact/arc_contact.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/first_contact.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink::detail {

/// One sample of S against one site of T at one moment.
struct Feature {
  int sample = -1;
  int site = -1;
  double gap = 0.0;            ///< [m]
  double rate = 0.0;           ///< of the gap [m/s]
  Vec2 normal = Vec2::Zero();  ///< T's frame, out of the site
  Vec2 point = Vec2::Zero();   ///< T's frame, on the site
};

/// Samples of S against sites of T: one half of the two-sided test.
struct Half {
  const Mover* s = nullptr;
  const Mover* t = nullptr;
  bool s_is_a = true;
  int count = 0;  ///< samples to be looked at: all, or none where the other half is the whole distance

  const Outline& samples_of() const { return s->outline(); }
  const Outline& sites_of() const { return t->outline(); }
  const Sample& sample(int i) const { return samples_of().samples[static_cast<std::size_t>(i)]; }
  const Site& site(int j) const { return sites_of().sites[static_cast<std::size_t>(j)]; }
};

class PairView {
 public:
  PairView(const Mover& a, const Mover& b, const SearchLimits& limits, SearchScratch& scratch);

  /// The half whose samples are a's (true) or b's.
  const Half& half(bool samples_on_a) const { return halves_[samples_on_a ? 0 : 1]; }

  /// Looks at the pair at time t from now on.
  void place(double t) { put(now_, t); }
  double time() const { return now_.time; }
  const Placed& placed(const Mover* m) const { return m == &a_ ? now_.a : now_.b; }
  SamplePath path(const Half& half, int i) const {
    return sample_path(placed(half.s), placed(half.t), half.sample(i).p);
  }

  /// Calls visit(half, feature) for every feature with a gap up to `tolerance`: of each vertex the nearest,
  /// of arcs all. Brute force over samples.
  template <class Visit>
  void each_feature(double tolerance, Visit&& visit) const {
    for (const Half& half : halves_) {
      const Reach reach(*this, half, tolerance);
      for (int i = 0; i < half.count; ++i)
        if (half.sample(i).hollow || reach.leaves_out(i))
          continue;
        else if (half.sample(i).arc_site >= 0)
          each_arc_feature(half, i, tolerance, visit);
        else if (const Feature f = nearest_feature(half, i, tolerance); f.site >= 0 && f.gap <= tolerance)
          visit(half, f);
    }
  }

  /// Vertex sample i against site j, whose nearest point is given.
  Feature vertex_feature(const Half& half, int i, int j, const Nearest& nearest,
                         const SamplePath& path) const {
    return vertex_feature(now_, half, i, j, nearest, path);
  }
  /// The same two features as `f`, looked at now; `time` is noted in the answer.
  FeatureContact look_again(const Half& half, const Feature& f, double time) const;
  FeatureContact contact_of(const Half& half, const Feature& f, double time) const;

  /// True if the gap falls faster than the rounding of the velocities it is computed from.
  bool approaching(const Feature& f, const SamplePath& path) const { return f.rate < -rate_noise(path); }
  /// Bound on the rounding of a rate of the gap now [m/s].
  double rate_noise(const SamplePath& path) const;

  /// Keeps those of `sites` that lie within `reach` of vertex sample i, and how it stands to them now.
  void find_neighbours(const Half& half, int i, std::span<const std::uint32_t> sites, const SamplePath& path,
                       double reach);
  /// True if the corner of a solid at sample i is just in front of a face of another solid, but an edge of
  /// its own leads through that face: it stands out of it, on the far side of something thin, and must not
  /// come out any further. Never so while the two are apart.
  bool pokes_through(const Half& half, int i, const Site& site, const Nearest& nearest,
                     const Feature& f) const;
  /// True if the sharp corner of a solid at sample i lies with its tip, to rounding, on the line that goes on from
  /// site j beyond its end, which is as sharp; and that line alone parts the two corners: the site is a face for it
  /// there, too (a box right upon another of its width). One of the two may be a wire's end.
  bool is_flush_on(const Half& half, int i, const Site& site, const Vec2& q, double rounding) const {
    return is_flush_on(now_, half, i, site, q, rounding);
  }
  /// True if sample i is abreast, to rounding, of an end at which site j, of a solid, goes on straight into another outline's: no tip
  /// is there, but a face.
  bool is_at_joint(const Half& half, int i, const Site& site, const Vec2& q, double rounding) const;
  /// True if q is by an end of a side that others lie against: what comes there meets the faces that join there, not what is
  /// between them.
  bool is_covered_at(const Site& site, const Vec2& q) const {
    const double near2 = limits_.tolerance * limits_.tolerance;
    return site.covered && ((q - site.a).squaredNorm() <= near2 || (q - site.b).squaredNorm() <= near2);
  }
  /// True if f's sample, a sharp corner of a solid or of a wire, or a wire's end, is by such a corner or end in which f's site ends,
  /// and a line parts the two, to the touching distance, as they go on, or one after another, whatever becomes of the gap to f's
  /// site.
  bool passes_tip(const Half& half, const Feature& f) const;
  /// How far a tip may be behind that line and still pass [m]: the touching distance, or, where islands or sites hold
  /// both, what their gaps are kept to.
  double passing_depth(const Half& half, int i, const Vec2& q) const {
    const double touch = std::max(limits_.touch, 8.0 * gap_rounding(half, i, q));
    return a_.held && b_.held ? limits_.tolerance : touch;
  }
  /// True if site j is near q, where sample i is, but what q would touch is another of the neighbours. At a
  /// joint: one that is as near with its interior. Behind a solid: j is the far side of a sliver, whose near side q has in front
  /// of it, or is deeper in.
  bool belongs_to_a_neighbour(const Half& half, int i, int j, const Nearest& nearest, const Vec2& q) const;
  /// The same of a feature near which no neighbours were looked for yet. Cost: a look at every site.
  bool hidden_behind_others(const Half& half, const Feature& f, const SamplePath& path);

  /// The gap at which sample i and the site meet now [m] (tolerances.h), less what the pair may have sunk
  /// since its motions began.
  double level(const Half& half, int i, const Site& site, const Vec2& q) const {
    return level_of(nominal_level(now_, half, i, site, q), sink_);
  }
  /// Why a contact of these features that is met now cannot be told, if it cannot.
  enum class Doubt { none, place, speed };
  Doubt doubt(const Half& half, const Feature& f) const;
  /// True of a sample that moves a part of the pair's size within one instant: no time can be told for it.
  bool is_too_fast(const SamplePath& path) const {
    return path.rate.norm() * same_instant(now_.time) >
           kSlowOfSize * smallest_radius(a_.outline(), b_.outline());
  }
  /// True if no feature's contact near the present time can be in doubt, by far: a quick look.
  bool beyond_doubt() const;
  /// Sets what is taken off every level, <= 0: sink_at_start().
  void set_sink(double sink) { sink_ = sink; }
  /// Since its motions began, how far the pair may sink below nominal levels before it meets (start_sink() of
  /// tolerances.h) [m], <= 0. A function of the two motions alone. Cost: a look at every sample.
  double sink_at_start() const;
  /// When both motions had begun [s].
  double start() const { return std::max(a_.motion->begin(), b_.motion->begin()); }

  struct GapAndSite {
    double gap = std::numeric_limits<double>::infinity();  ///< [m], less level()
    int site = -1;
  };
  /// The gap of f's sample at time t, wherever the pair is placed now. A vertex: signed, to the neighbours
  /// together, so that it does not matter from which of them, or when, one began to look; those that it
  /// touches and leaves are left out. An arc: to f's site, on the side that f has.
  GapAndSite gap_at(const Half& half, const Feature& f, double t) const;
  /// The same at the time at which a copy of this is placed.
  GapAndSite gap_where(const PairView& copy, const Half& half, const Feature& f) const {
    return gap_when(copy.now_, half, f);
  }

  /// Bound on the rounding of the gap of sample i, at q, to any site now [m]: one for all sites, or the
  /// nearest by level might not be the nearest.
  double gap_rounding(const Half& half, int i, const Vec2& q) const { return now_.gap_rounding(half, i, q); }
  /// Gaps up to this are close [m]: the tolerance, or what the point moves in a few roundings of the time, or
  /// more than any level.
  double touching_band(const Half& half, int i, const SamplePath& path) const {
    const double moved2 = 64.0 * now_.tick * now_.tick * path.rate.squaredNorm();
    const double band = std::max(limits_.tolerance, 16.0 * gap_rounding(half, i, path.q));
    return moved2 > band * band ? std::sqrt(moved2) : band;
  }

 private:
  template <class Visit>
  void each_arc_feature(const Half& half, int i, double tolerance, Visit&& visit) const {
    const Vec2 centre = path(half, i).q;
    for (std::size_t j = 0; j < half.sites_of().sites.size(); ++j) {
      // the whole circle is further away
      const Site& site = half.site(static_cast<int>(j));
      const double reach = tolerance + limits_.tolerance + site.radius + half.sample(i).radius;
      if (nearest_on(site, centre).distance > reach) continue;
      const ArcStep step = arc_now(half, i, static_cast<int>(j));
      if (step.active && step.gap <= tolerance)
        visit(half, Feature{i, static_cast<int>(j), step.gap, step.rate, step.normal, step.point});
    }
  }
  /// Of a vertex f's sample against all sites that are as near to it, up to `tolerance`, in another place than f's.
  template <class Visit>
  void each_other_place(const Half& half, const Feature& f, double tolerance, Visit&& visit) const {
    const Sample& sample = half.sample(f.sample);
    if (sample.arc_site >= 0) return;
    const SamplePath now = path(half, f.sample);
    const Vec2 here = nearest_on(half.site(f.site), now.q).point;
    for (int j = 0; j < static_cast<int>(half.sites_of().sites.size()); ++j) {
      const Nearest nearest = nearest_on(half.site(j), now.q);
      const double gap = nearest.distance - half.site(j).radius - sample.radius;
      if (j == f.site || gap > tolerance || (nearest.point - here).norm() <= limits_.tolerance) continue;
      visit(vertex_feature(half, f.sample, j, nearest, now));
    }
  }
  /// The two outlines at one moment, seen from `base`: the world's origin, or the pair's own where the
  /// world's is too far away for doubles.
  struct Placing {
    Placed a, b;
    double time = std::numeric_limits<double>::quiet_NaN();  ///< [s]; no number: not placed yet
    Vec2 base = Vec2::Zero();                                ///< world [m]
    double tick = 0.0;                                       ///< from `time` to the next double [s]
    double place_noise = 0.0;                                ///< rounding of one place against the other [m]
    double angle_noise_a = 0.0, angle_noise_b = 0.0;         ///< [rad]
    double turn_noise_a = 0.0, turn_noise_b = 0.0;           ///< likewise, with those of sines and of turning
    /// Seen in extended precision, what is seen in double may be rounded by [m]: wires are met at a level above that, or
    /// what is met here would have no side there.
    double in_double = 0.0;

    const Placed& of(bool is_a) const { return is_a ? a : b; }
    void note_turning();
    double gap_rounding(const Half& half, int i, const Vec2& q) const {
      const double arm = half.sample(i).p.lpNorm<1>(), distance = q.lpNorm<1>();
      const double of_s = half.s_is_a ? turn_noise_a : turn_noise_b;
      const double of_t = half.s_is_a ? turn_noise_b : turn_noise_a;
      // the distance to a site as far off comes last
      return place_noise + of_s * arm + (of_t + 2.0 * kRoundoff) * distance +
             2.0 * kRoundoff * half.sites_of().magnitude;
    }
  };

  bool discs_were_apart() const;
  /// d2q/dt2 of sample i now, in T's turning frame (path_bounds() of pair_kinematics.h) [m/s^2]. Of motions that an
  /// integrator has made without what changes their turning.
  Vec2 acceleration_now(const Half& half, int i, const SamplePath& path) const;
  Feature vertex_feature(const Placing& placing, const Half& half, int i, int j, const Nearest& nearest,
                         const SamplePath& path) const;
  Feature nearest_feature(const Half& half, int i, double tolerance) const;
  ArcStep arc_now(const Half& half, int i, int j) const;
  void put(Placing& placing, double t) const;
  void put_relative(Placing& placing, double t) const;
  bool is_flush_on(const Placing& placing, const Half& half, int i, const Site& site, const Vec2& q,
                   double rounding) const;
  /// The site's own normal at its end: of a solid's outwards, of a wire's to the side on which the sample's owner is.
  Vec2 face_for(const Placing& placing, const Half& half, int i, const Site& site, bool at_a,
                const Vec2& q) const;
  double nominal_level(const Placing& placing, const Half& half, int i, const Site& site,
                       const Vec2& q) const;
  /// Of a wire without thickness: 1 where the sample, now at q, has not crossed it since its neighbours were
  /// found, else -1; `at_once`: they were found just now.
  double side_kept(const Site& site, const SearchScratch::Neighbour& as_found, const Nearest& now,
                   const Vec2& q, double rounding, bool at_once) const;
  /// True if the straight way to q from where the neighbours were found crosses the segment, to `rounding` [m]
  /// of its ends.
  bool way_leads_through(const Site& site, const Vec2& q, double rounding) const;
  /// True of a neighbour that the sample, at `nearest` from it in this placing, does not approach.
  bool is_left(const Placing& placing, const Half& half, int i, const SearchScratch::Neighbour& neighbour,
               const Nearest& nearest) const;
  GapAndSite gap_to_neighbours(const Placing& placing, const Half& half, const Feature& f,
                               const Vec2& q) const;
  GapAndSite gap_when(const Placing& then, const Half& half, const Feature& f) const;
  double arc_gap(const Half& half, const Feature& f, const Vec2& center) const;
  /// Which samples of a half may be within reach [m] of a site, told by their places alone.
  class Reach {
   public:
    Reach(const PairView& view, const Half& half, double reach);
    bool leaves_out(int i) const;

   private:
    const Half& half_;
    const Frame &s_, &t_;
    double reach_;
    double far_;   ///< of S's core from T's origin [m]
    Vec2 origin_;  ///< T's, seen from S [m]
  };

  const Mover &a_, &b_;
  MotionRounding of_a_, of_b_;
  const SearchLimits& limits_;
  SearchScratch& scratch_;
  Half halves_[2];
  Placing now_;
  double sink_ = 0.0;
};

}  // namespace brink::detail
