#pragma once
/// Which sites of an outline can be nearest to a point: the contract between rendered fields and first
/// contact.

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "brink/core/base/work.h"
#include "brink/core/fields/field_options.h"
#include "brink/core/shapes/outline.h"

namespace brink {

/// Sites to be looked at for a query point, and how far every other site is at least.
struct Candidates {
  std::span<const std::uint32_t>
      sites;  ///< into Outline::sites; valid until the next call with the same scratch
  /// Certified: every site NOT listed has (unsigned core distance - radius) >= this [m]; infinite if all are
  /// listed.
  double others_at_least = std::numeric_limits<double>::infinity();
};

/// An exact answer at one point.
struct FieldAnswer {
  double gap = 0.0;             ///< signed distance [m], < 0 inside
  int site = -1;                ///< nearest site (lowest index on ties)
  Vec2 closest = Vec2::Zero();  ///< nearest point of the core
  Vec2 normal = Vec2::Zero();   ///< unit, out of the outline
  /// No other site is nearer [m]: the unsigned distance, radius subtracted, of the second nearest, or less where that is
  /// beyond what the field has looked at. Infinite if there is none.
  double runner_up = 0.0;
};

/// Finds candidates in one outline. Immutable after construction, so any number of threads may ask; each
/// brings its own scratch.
class SiteIndex {
 public:
  struct Scratch {
    std::vector<std::uint32_t> sites;
    std::uint64_t tree_searches =
        0;  ///< answers given by tree because a list was over the cap or out of the band
  };

  virtual ~SiteIndex() = default;

  /// A set of sites that is sure to hold the nearest one to q (in the outline's frame), or, if q is farther
  /// from the outline than `reach`, possibly an empty set with others_at_least >= reach. Never NaN, never
  /// throws.
  virtual Candidates candidates(const Vec2& q, double reach, Scratch& scratch) const = 0;

  const Outline& outline() const { return *outline_; }

  /// Exact answer at q, whatever its distance: the same bits as gap_by_brute_force(). A point that is not
  /// finite has no answer: site -1, gap 0.
  FieldAnswer query(const Vec2& q, Scratch& scratch) const;

 protected:
  explicit SiteIndex(std::shared_ptr<const Outline> outline);
  std::shared_ptr<const Outline> outline_;

 private:
  using Two = double __attribute__((vector_size(16)));

  /// Of a segment, what every query would compute anew.
  struct Line {
    Vec2 right = Vec2::Zero();  ///< unit normal, of a solid's segment outward, as normal_at() gives it
    double length = 0.0;        ///< [m]
  };

  /// Distances of nearest_on() to two sites, bit for bit, less their radii.
  Two distances(std::uint32_t i, std::uint32_t j, const Vec2& q) const;

  /// query() where that site is nearest.
  FieldAnswer answer_by(int site, const Vec2& q, double runner_up) const;

  std::vector<Line> lines_;  ///< a site
};

/// Every site, always: for outlines of few sites, and the reference for the others.
std::unique_ptr<SiteIndex> make_brute_force_index(std::shared_ptr<const Outline> outline);

/// The rendered body field (see body_field.h), or brute force where `options` say the outline needs no field.
/// @throws IoError if a field is needed and no GL context opens.
std::unique_ptr<SiteIndex> make_site_index(std::shared_ptr<const Outline> outline,
                                           const FieldOptions& options, WorkCounters* work = nullptr);

}  // namespace brink
