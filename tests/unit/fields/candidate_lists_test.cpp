// Candidate lists: the renderer's, on each backend, against the definition evaluated in double precision.
#include "brink/core/fields/candidate_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "brink/core/fields/body_field.h"
#include "brink/core/shapes/distance.h"
#include "tests/support/seeded_random.h"
#include "tests/unit/fields/field_shapes.h"

namespace brink::detail::candidate_lists_test {
namespace {

std::set<std::uint32_t> list_of(const CandidateLists& lists, std::size_t k) {
  const auto cell = lists.cells[k];
  const auto first = lists.sites.begin() + cell.first();
  return {first, first + cell.count()};
}

bool has_list(const CandidateLists::Cell& cell) {
  return cell.count() != 0 && cell.count() != CandidateLists::kTree;
}

/// Sites that must be in pixel k's list (nearest + 2 h), and those that may be for rounding (1 % of a pixel
/// more).
std::pair<std::set<std::uint32_t>, std::set<std::uint32_t>> must_and_may(const Outline& outline,
                                                                         const PixelGrid& grid,
                                                                         std::size_t k) {
  const auto width = static_cast<std::size_t>(grid.width);
  const Vec2 p = grid.low + grid.pixel * Vec2(static_cast<double>(k % width) + 0.5,
                                              static_cast<double>(k / width) + 0.5);
  std::vector<double> distance;
  for (const Site& site : outline.sites) distance.push_back(nearest_on(site, p).distance - site.radius);
  const double least = *std::min_element(distance.begin(), distance.end());
  std::pair<std::set<std::uint32_t>, std::set<std::uint32_t>> sets;
  for (std::uint32_t s = 0; s < distance.size(); ++s) {
    if (distance[s] <= least + std::sqrt(2.0) * grid.pixel) sets.first.insert(s);
    if (distance[s] <= least + (std::sqrt(2.0) + 0.01) * grid.pixel) sets.second.insert(s);
  }
  return sets;
}

struct Case {
  std::shared_ptr<const Outline> outline;
  PixelGrid grid;
  ListRules rules;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* wanted :
       {"star", "letters", "ring", "waves", "rounded star", "thick spiral", "flat lens"}) {
    for (const auto& shape : field_test::all_shapes()) {
      if (shape.name != wanted) continue;
      FieldOptions options;
      options.resolution = 48;
      const BodyFieldPlan plan = plan_body_field(*shape.outline, options);
      all.push_back({shape.outline, plan.grid, {plan.band, 254, 0, false}});
    }
  }
  return all;
}

void expect_complete_and_tight(const Case& c, const CandidateLists& lists) {
  int listed = 0;
  for (std::size_t k = 0; k < lists.cells.size(); ++k) {
    if (!has_list(lists.cells[k])) continue;
    ++listed;
    const auto list = list_of(lists, k);
    const auto [must, may] = must_and_may(*c.outline, c.grid, k);
    ASSERT_TRUE(std::includes(list.begin(), list.end(), must.begin(), must.end())) << "pixel " << k;
    ASSERT_TRUE(std::includes(may.begin(), may.end(), list.begin(), list.end())) << "pixel " << k;
  }
  EXPECT_GT(listed, 200);
}

class Lists : public ::testing::TestWithParam<std::string> {};

TEST_P(Lists, HoldEverySiteThatCanBeNearestAndNoOther) {
  FieldRenderer renderer(open_gl_context(GetParam()));
  ASSERT_TRUE(renderer.context().has_storage_buffers());
  for (const Case& c : cases())
    expect_complete_and_tight(c, render_lists(renderer, *c.outline, c.grid, c.rules));
}

// GL 3.3 has no storage buffers: the second pass is done by the processor from the first draw's distances.
TEST_P(Lists, AreTheSameWithoutStorageBuffers) {
  FieldRenderer renderer(open_gl_context(GetParam(), GlLevel::only_33));
  ASSERT_FALSE(renderer.context().has_storage_buffers());
  for (const Case& c : cases())
    expect_complete_and_tight(c, render_lists(renderer, *c.outline, c.grid, c.rules));
}

// Room for 10 entries cannot hold a list a pixel: the draw is repeated with enough room and gives the same
// lists.
TEST_P(Lists, TooLittleRoomIsRedrawnWithTheSameResult) {
  FieldRenderer small(open_gl_context(GetParam())), large(open_gl_context(GetParam()));
  Case c = cases().front();
  const CandidateLists expected = render_lists(large, *c.outline, c.grid, c.rules);
  EXPECT_EQ(large.redraws(), 0);
  c.rules.capacity = 10;
  const CandidateLists lists = render_lists(small, *c.outline, c.grid, c.rules);
  EXPECT_EQ(small.redraws(), 1);
  EXPECT_EQ(lists.sites, expected.sites);
  EXPECT_EQ(lists.entries, expected.entries);
}

// A cap of 2 sends every longer list to the tree; the answers do not change.
TEST_P(Lists, OverTheCapAreAnsweredByTheTree) {
  const auto shape = field_test::all_shapes().front();
  FieldOptions options;
  options.brute_force_below = 0;
  options.list_cap = 2;
  options.context = GetParam();
  const auto index = make_site_index(shape.outline, options);
  SiteIndex::Scratch scratch;
  SeededRandom random(5);
  for (int i = 0; i < 20000; ++i) {
    const Vec2 q =
        shape.outline->bounds.extent().x() * Vec2(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
    int site = -1;
    const double gap = gap_by_brute_force(*shape.outline, q, &site);
    const FieldAnswer answer = index->query(q, scratch);
    ASSERT_EQ(answer.gap, gap);
    ASSERT_EQ(answer.site, site);
  }
  EXPECT_GT(dynamic_cast<const BodyField&>(*index).lists().pixels_over_cap, 0);
  EXPECT_GT(scratch.tree_searches, 100U);
}

INSTANTIATE_TEST_SUITE_P(Backends, Lists, ::testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const auto name : gl_backends()) names.emplace_back(name);
                           return names;
                         }()),
                         [](const auto& info_) { return info_.param; });

// Distances are computed by the same shader on the same processor; ids agree but where two sites are equally
// near.
TEST(Backends, GiveTheSameIdsTiesApart) {
  if (gl_backends().size() < 2) GTEST_SKIP() << "one backend in this build";
  FieldOptions options;
  options.context = "osmesa";
  PassRenderer osmesa(options);
  options.context = "egl";
  PassRenderer egl(options);
  for (const auto& shape : field_test::all_shapes()) {
    const PlacedOutline placed{shape.outline.get(), {Vec2(0.1, -0.2), 0.4}, 0};
    Box window;
    window.add(Vec2(-1.5, -1.5));
    window.add(Vec2(1.5, 1.5));
    const double infinite = std::numeric_limits<double>::infinity();
    const FieldImage a = osmesa.render(window, 90, 90, std::span(&placed, 1), FieldImage::kNone, infinite);
    const FieldImage b = egl.render(window, 90, 90, std::span(&placed, 1), FieldImage::kNone, infinite);
    for (std::size_t k = 0; k < a.site.size(); ++k) {
      ASSERT_NEAR(a.distance[k], b.distance[k], a.rounding + b.rounding) << shape.name;
      if (a.site[k] == b.site[k]) continue;
      const Vec2 p =
          a.window.low + a.pixel * Vec2(static_cast<double>(k % 90) + 0.5, static_cast<double>(k / 90) + 0.5);
      const Vec2 q = Frame(placed.pose).to_local(p);
      const Site &sa = shape.outline->sites[a.site[k]], &sb = shape.outline->sites[b.site[k]];
      ASSERT_NEAR(nearest_on(sa, q).distance - sa.radius, nearest_on(sb, q).distance - sb.radius,
                  2.0 * a.rounding);
    }
  }
}

// Without candidates in the picture: nearest three and a bound on all others, against sorting every distance.
TEST(SiteTree, ListsTheNearestAndBoundsTheOthers) {
  for (const auto& shape : field_test::all_shapes()) {
    const SiteTree tree(*shape.outline);
    SeededRandom random(9);
    std::vector<std::uint32_t> sites;
    for (int i = 0; i < 3000; ++i) {
      const Vec2 q = field_test::query_point(*shape.outline, random);
      const double others = tree.nearest(*shape.outline, q, sites);
      std::vector<std::pair<double, std::uint32_t>> all;
      for (std::uint32_t s = 0; s < shape.outline->sites.size(); ++s) {
        const Site& site = shape.outline->sites[s];
        all.emplace_back(nearest_on(site, q).distance - site.radius, s);
      }
      const std::size_t listed = std::min<std::size_t>(SiteTree::kListed, all.size());
      std::partial_sort(all.begin(),
                        all.begin() + static_cast<std::ptrdiff_t>(std::min(listed + 1, all.size())),
                        all.end());
      ASSERT_EQ(sites.size(), listed);
      for (std::size_t k = 0; k < listed; ++k) ASSERT_EQ(sites[k], all[k].second) << shape.name;
      if (all.size() > listed) {
        ASSERT_LE(others, all[listed].first);
        ASSERT_GE(others, all[listed].first - 1e-12 * (1.0 + q.norm()));
      } else {
        ASSERT_EQ(others, std::numeric_limits<double>::infinity());
      }
    }
  }
}

TEST(SiteIndex, PointThatIsNotFiniteHasNoAnswerAndDoesNoHarm) {
  const auto shape = field_test::all_shapes().front();
  FieldOptions options;
  options.brute_force_below = 0;
  const auto index = make_site_index(shape.outline, options);
  SiteIndex::Scratch scratch;
  const double nan = std::nan("");
  EXPECT_EQ(index->query(Vec2(nan, 0.0), scratch).site, -1);
  EXPECT_EQ(index->query(Vec2(0.0, std::numeric_limits<double>::infinity()), scratch).gap, 0.0);
}

// A single point without thickness has no size to draw.
TEST(SiteIndex, OutlineWithoutSizeIsAnsweredByBruteForce) {
  FieldOptions options;
  options.brute_force_below = 0;
  const auto point = std::make_shared<const Outline>(make_point(Vec2(1.0, 1.0)).outline);
  const auto index = make_site_index(point, options);
  SiteIndex::Scratch scratch;
  EXPECT_EQ(index->query(Vec2(4.0, 5.0), scratch).gap, 5.0);  // 3, 4, 5
}

TEST(SiteIndex, FewSitesNeedNoField) {
  WorkCounters work;
  const auto shape = std::make_shared<const Outline>(make_box(1.0, 1.0).outline);
  const auto index = make_site_index(shape, FieldOptions(), &work);
  EXPECT_EQ(work.pixels_drawn, 0U);
  SiteIndex::Scratch scratch;
  EXPECT_EQ(index->candidates(Vec2(3.0, 0.0), 1.0, scratch).sites.size(), 4U);
  const FieldAnswer answer = index->query(Vec2(3.0, 0.1), scratch);  // 2.5 to the right of the side x = 0.5
  EXPECT_DOUBLE_EQ(answer.gap, 2.5);
  EXPECT_EQ(answer.normal, Vec2(1.0, 0.0));
  EXPECT_NEAR((answer.closest - Vec2(0.5, 0.1)).norm(), 0.0, 1e-15);
}

}  // namespace
}  // namespace brink::detail::candidate_lists_test
