// The index's answer is the brute-force answer: the raster only chooses which sites are looked at.
#include "brink/core/fields/site_index.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdio>
#include <limits>

#include "brink/core/fields/body_field.h"
#include "brink/core/shapes/distance.h"
#include "tests/support/seeded_random.h"
#include "tests/unit/fields/field_shapes.h"

namespace brink::site_index_test {
namespace {

using field_test::NamedOutline;

FieldOptions always_a_field() {
  FieldOptions options;
  options.brute_force_below = 0;
  return options;
}

class SiteIndexOnShapes : public ::testing::TestWithParam<int> {
 protected:
  NamedOutline shape_ = field_test::all_shapes()[static_cast<std::size_t>(GetParam())];
};

// The distance function is the same in both, so even the bits of the gap must agree, and with them its sign.
TEST_P(SiteIndexOnShapes, RandomQueriesGiveTheBruteForceAnswer) {
  const std::uint64_t seed = 20260 + static_cast<std::uint64_t>(GetParam());
  std::printf("%s, %zu sites, seed %llu\n", shape_.name.c_str(), shape_.outline->sites.size(),
              static_cast<unsigned long long>(seed));
  const auto index = make_site_index(shape_.outline, always_a_field());
  Random random(seed);
  SiteIndex::Scratch scratch;
  double largest = 0.0;
  int wrong_sign = 0, wrong_site = 0;
  for (int i = 0; i < 80000; ++i) {
    const Vec2 q = field_test::query_point(*shape_.outline, random);
    int site = -1;
    const double expected = gap_by_brute_force(*shape_.outline, q, &site);
    const FieldAnswer answer = index->query(q, scratch);
    largest = std::max(largest, std::abs(answer.gap - expected));
    wrong_sign += (answer.gap < 0.0) != (expected < 0.0) ? 1 : 0;
    wrong_site += answer.site != site ? 1 : 0;
  }
  const auto* field = dynamic_cast<const detail::BodyField*>(index.get());
  ASSERT_NE(field, nullptr);
  const auto& lists = field->lists();
  std::printf("  %d x %d pixels, mean list %.2f, over cap %d, by tree %llu of 80000\n", lists.grid.width,
              lists.grid.height, static_cast<double>(lists.entries) / lists.pixels_listed,
              lists.pixels_over_cap, static_cast<unsigned long long>(scratch.tree_searches));
  EXPECT_EQ(largest, 0.0) << "the same bits as brute force are promised";
  EXPECT_EQ(wrong_sign, 0);
  EXPECT_EQ(wrong_site, 0);
}

/// query() as it is defined: one candidate after the other, by the functions of distance.h.
FieldAnswer one_by_one(const SiteIndex& index, const Vec2& q, SiteIndex::Scratch& scratch) {
  const double never = std::numeric_limits<double>::infinity();
  const Candidates found = index.candidates(q, never, scratch);
  FieldAnswer answer;
  Nearest nearest;
  double least = never, second = never;
  for (const std::uint32_t i : found.sites) {
    const Site& site = index.outline().sites[i];
    const Nearest n = nearest_on(site, q);
    const double distance = n.distance - site.radius;
    if (distance < least) {
      second = least;
      least = distance;
      nearest = n;
      answer.site = static_cast<int>(i);
    } else if (distance < second) {
      second = distance;
    }
  }
  if (answer.site < 0) return answer;
  const Site& site = index.outline().sites[static_cast<std::size_t>(answer.site)];
  answer.gap = side_of_outline(index.outline(), site, nearest, q) * nearest.distance - site.radius;
  answer.closest = nearest.point;
  answer.normal = normal_at(site, nearest, q);
  answer.runner_up = std::min(second, found.others_at_least);
  return answer;
}

std::array<std::uint64_t, 7> bits(const FieldAnswer& answer) {
  const auto of = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  return {of(answer.gap),         static_cast<std::uint64_t>(answer.site),
          of(answer.closest.x()), of(answer.closest.y()),
          of(answer.normal.x()),  of(answer.normal.y()),
          of(answer.runner_up)};
}

// Candidates are compared two at a time, by masks, and places abreast of a segment are answered in short.
TEST_P(SiteIndexOnShapes, AnswersHaveTheBitsOfLookingAtOneSiteAfterTheOther) {
  const auto field = make_site_index(shape_.outline, always_a_field());
  const auto brute_force = make_brute_force_index(shape_.outline);
  SeededRandom random(78);
  SiteIndex::Scratch scratch;
  const auto compare = [&](const Vec2& q) {
    for (const SiteIndex* index : {field.get(), brute_force.get()})
      ASSERT_EQ(bits(index->query(q, scratch)), bits(one_by_one(*index, q, scratch)))
          << shape_.name << " at " << q.transpose();
  };
  for (int i = 0; i < 8000; ++i) compare(field_test::query_point(*shape_.outline, random));
  // right on the outline, on its lines, and where squares overflow
  for (const Site& site : shape_.outline->sites) {
    for (const double share : {-0.5, 0.0, 0.25, 0.5, 1.0, 1.5}) compare(site.a + share * (site.b - site.a));
    for (const double far : {1e100, 1e160, 1e300}) compare(far * (site.a + Vec2(0.5, 0.25)));
  }
}

// Where all sites are equally near by rounding, the side of one of them says nothing.
TEST_P(SiteIndexOnShapes, PlacesFarAwayHaveTheBruteForceSign) {
  const auto index = make_site_index(shape_.outline, always_a_field());
  Random random(7);
  SiteIndex::Scratch scratch;
  for (int i = 0; i < 2000; ++i) {
    const double far = std::pow(10.0, random.uniform(1.0, 140.0)), angle = random.uniform(0.0, 6.3);
    const Vec2 q = far * Vec2(std::cos(angle), std::sin(angle));
    ASSERT_EQ(index->query(q, scratch).gap, gap_by_brute_force(*shape_.outline, q, nullptr)) << far;
  }
}

// What Candidates promises, checked against every site: whoever is not listed is at least others_at_least
// away, and an empty list means that the outline is beyond the reach.
TEST_P(SiteIndexOnShapes, UnlistedSitesAreAtLeastAsFarAsPromised) {
  const auto index = make_site_index(shape_.outline, always_a_field());
  SeededRandom random(77);
  SiteIndex::Scratch scratch;
  const double size = shape_.outline->bounds.extent().norm();
  // Distances themselves are rounded, relative to the coordinates they come from.
  const double far = size + shape_.outline->bounds.center().norm();
  for (int i = 0; i < 4000; ++i) {
    const Vec2 q = field_test::query_point(*shape_.outline, random);
    const double reach = size * std::pow(10.0, random.uniform(-4.0, 0.5));
    const Candidates found = index->candidates(q, reach, scratch);
    if (found.sites.empty()) {
      EXPECT_GE(found.others_at_least, reach);
    }
    std::vector<bool> listed(shape_.outline->sites.size());
    for (const std::uint32_t s : found.sites) listed[s] = true;
    for (std::size_t s = 0; s < listed.size(); ++s) {
      if (listed[s]) continue;
      const Site& site = shape_.outline->sites[s];
      ASSERT_GE(nearest_on(site, q).distance - site.radius, found.others_at_least - 1e-15 * far)
          << shape_.name << " site " << s << " at " << q.transpose();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SiteIndexOnShapes,
                         ::testing::Range(0, static_cast<int>(field_test::all_shapes().size())));

}  // namespace
}  // namespace brink::site_index_test
