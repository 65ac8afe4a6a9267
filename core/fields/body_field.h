#pragma once
/// The body field: an outline's candidate lists, rendered once in the outline's own frame. It moves with the
/// body, so it is never drawn again; bodies of one shape share it.

#include <memory>

#include "brink/core/fields/candidate_lists.h"
#include "brink/core/fields/site_index.h"
#include "brink/core/fields/site_tree.h"

namespace brink::detail {

/// What a body field is made of, for reports and tests.
struct BodyFieldPlan {
  PixelGrid grid;
  double band = 0.0;  ///< [m]
};

/// Window, resolution and band for an outline: as `options` say, else by shape.
///
/// By shape, pixels are at most half as long as the median site; render_body_field() halves them until lists
/// near the outline hold about two sites. The band is a seventh of the size, narrowed until both draws cost
/// no more fragments than a few windows.
BodyFieldPlan plan_body_field(const Outline& outline, const FieldOptions& options);

class BodyField final : public SiteIndex {
 public:
  BodyField(std::shared_ptr<const Outline> outline, CandidateLists lists);

  Candidates candidates(const Vec2& q, double reach, Scratch& scratch) const override;

  const CandidateLists& lists() const { return lists_; }

 private:
  Candidates outside(const Vec2& q, double reach, Scratch& scratch) const;
  Candidates by_tree(const Vec2& q, Scratch& scratch) const;

  CandidateLists lists_;
  double per_pixel_;  ///< 1 / pixel
  double snap_;       ///< PixelGrid::snap()
  SiteTree tree_;
};

/// Renders the field of `outline` with `renderer`. @throws IoError if GL refuses.
std::unique_ptr<BodyField> render_body_field(std::shared_ptr<const Outline> outline,
                                             const FieldOptions& options, FieldRenderer& renderer);

}  // namespace brink::detail
