// The long run of site_index_test.cpp: BRINK_STRESS_QUERIES queries a shape (default 10 million), seed from
// BRINK_SEED.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "brink/core/fields/site_index.h"
#include "tests/unit/fields/field_shapes.h"

namespace brink::site_index_stress {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

class SiteIndexStress : public ::testing::TestWithParam<int> {};

// The same sites are evaluated by the same function, so every answer has the bits of the brute-force one.
TEST_P(SiteIndexStress, MillionsOfQueriesGiveTheBruteForceAnswer) {
  const auto shape = field_test::all_shapes()[static_cast<std::size_t>(GetParam())];
  const std::uint64_t seed = from_environment("BRINK_SEED", 1) + static_cast<std::uint64_t>(GetParam());
  const std::uint64_t queries = from_environment("BRINK_STRESS_QUERIES", 10'000'000);
  std::printf("%s: %llu queries, seed %llu\n", shape.name.c_str(), static_cast<unsigned long long>(queries),
              static_cast<unsigned long long>(seed));
  FieldOptions options;
  options.brute_force_below = 0;
  const auto index = make_site_index(shape.outline, options);
  Random random(seed);
  SiteIndex::Scratch scratch;
  for (std::uint64_t i = 0; i < queries; ++i) {
    const Vec2 q = field_test::query_point(*shape.outline, random);
    int site = -1;
    const double gap = gap_by_brute_force(*shape.outline, q, &site);
    const FieldAnswer answer = index->query(q, scratch);
    ASSERT_EQ(answer.gap, gap) << "query " << i << " at " << q.transpose();
    ASSERT_EQ(answer.site, site) << "query " << i << " at " << q.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SiteIndexStress,
                         ::testing::Range(0, static_cast<int>(field_test::all_shapes().size())));

}  // namespace
}  // namespace brink::site_index_stress
