#include "brink/scheduler/kernel/step_places.h"

namespace brink {

namespace {

/// Looks along a step are at nine moments; what is between them is asked for by one contact alone.
constexpr std::size_t kMoments = 9;

/// What was found for the very moment, or is found now, and kept while there is room.
template <class Find>
OutlineAt at(std::vector<std::pair<double, OutlineAt>>& known, double later, Find&& find) {
  for (const auto& [moment, place] : known)
    if (moment == later) return place;
  if (known.empty()) known.reserve(kMoments);
  const OutlineAt place = find();
  if (known.size() < kMoments) known.emplace_back(later, place);
  return place;
}

}  // namespace

OutlineAt StepPlaces::of_member(int member, double later) {
  return at(of_members_[member], later, [&] { return members_->placed(member, later, *velocity_); });
}

OutlineAt StepPlaces::of_other(const PairKey& pair, double later) {
  OutlineAt place = pair.with_site() ? at(of_sites_[pair.other_site], later,
                                          [&] { return members_->placed_site(pair.other_site, later); })
                                     : of_member(members_->place_of(pair.other_body), later);
  if (pair.image != Image{}) place.position += members_->shift_of(pair).cast<Real>();
  return place;
}

double StepPlaces::gap(const HeldContact& c, double later) {
  return gap_of(c.feature, of_member(members_->place_of(c.pair.body), later), of_other(c.pair, later));
}

}  // namespace brink
