// Fields, each beside the brute-force alternative in the same run. Counters: `error`, the largest difference
// from brute force met during the benchmark [share of the outline's size], so that a fast wrong answer shows.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/core/fields/body_field.h"
#include "brink/core/fields/pass_window.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/shapes.h"

namespace brink {
namespace {

std::shared_ptr<const Outline> star(int sites) {
  std::vector<Vec2> v;
  for (int i = 0; i < sites; ++i) {
    const double r = i % 2 == 0 ? 1.0 : 0.6, angle = 2.0 * std::numbers::pi * i / sites;
    v.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return std::make_shared<const Outline>(make_polygon(v).outline);
}

/// Points within 2 % of the size of the boundary, where first contact spends its time.
std::vector<Vec2> near_boundary(const Outline& outline, int count) {
  Random random(7);
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) {
    const Site& site = outline.sites[random.below(outline.sites.size())];
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vec2 on = site.a + random.uniform() * (site.b - site.a);
    points.push_back(on + random.uniform(0.0, 0.04) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return points;
}

double largest_error(const SiteIndex& index, const std::vector<Vec2>& points) {
  SiteIndex::Scratch scratch;
  double largest = 0.0;
  for (const Vec2& q : points) {
    largest =
        std::max(largest, std::abs(index.query(q, scratch).gap - gap_by_brute_force(index.outline(), q)));
  }
  return largest / index.outline().bounds.extent().norm();
}

FieldOptions always_a_field() {
  FieldOptions options;
  options.brute_force_below = 0;
  return options;
}

void query_field(benchmark::State& state) {
  const auto outline = star(static_cast<int>(state.range(0)));
  const auto index = make_site_index(outline, always_a_field());
  const auto points = near_boundary(*outline, 4096);
  SiteIndex::Scratch scratch;
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(index->query(points[i++ & 4095], scratch));
  const auto& lists = dynamic_cast<const detail::BodyField&>(*index).lists();
  state.counters["error"] = largest_error(*index, points);
  state.counters["pixels"] = lists.grid.width;
  state.counters["tree"] = static_cast<double>(scratch.tree_searches) / static_cast<double>(i);
}
BENCHMARK(query_field)->Arg(16)->Arg(64)->Arg(256)->Arg(1024);

void query_brute_force(benchmark::State& state) {
  const auto outline = star(static_cast<int>(state.range(0)));
  const auto points = near_boundary(*outline, 4096);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(gap_by_brute_force(*outline, points[i++ & 4095]));
}
BENCHMARK(query_brute_force)->Arg(4)->Arg(8)->Arg(16)->Arg(64)->Arg(256)->Arg(1024);

void query_tree(benchmark::State& state) {
  const auto outline = star(static_cast<int>(state.range(0)));
  const SiteTree tree(*outline);
  const auto points = near_boundary(*outline, 4096);
  std::vector<std::uint32_t> sites;
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(tree.nearest(*outline, points[i++ & 4095], sites));
}
BENCHMARK(query_tree)->Arg(64)->Arg(1024);

/// The scheduler's hot call alone.
void candidates_field(benchmark::State& state) {
  const auto outline = star(64);
  const auto index = make_site_index(outline, always_a_field());
  const auto points = near_boundary(*outline, 4096);
  SiteIndex::Scratch scratch;
  std::size_t i = 0, listed = 0;
  for (auto _ : state) {
    const Candidates found = index->candidates(points[i++ & 4095], 1.0, scratch);
    listed += found.sites.size();
    benchmark::DoNotOptimize(found);
  }
  state.counters["mean_list"] = static_cast<double>(listed) / static_cast<double>(i);
}
BENCHMARK(candidates_field);

/// Arguments: sites, pixels, band as a share of the size (1 / n).
void index_build(benchmark::State& state) {
  const auto outline = star(static_cast<int>(state.range(0)));
  FieldOptions options = always_a_field();
  options.resolution = static_cast<int>(state.range(1));
  options.band = outline->bounds.extent().maxCoeff() / static_cast<double>(state.range(2));
  make_site_index(outline, options);  // opens the context and compiles the shaders
  for (auto _ : state) benchmark::DoNotOptimize(make_site_index(outline, options));
  const auto index = make_site_index(outline, options);
  const auto& lists = dynamic_cast<const detail::BodyField&>(*index).lists();
  state.counters["mean_list"] = static_cast<double>(lists.entries) / lists.pixels_listed;
  state.counters["error"] = largest_error(*index, near_boundary(*outline, 4096));
}
BENCHMARK(index_build)
    ->Args({32, 64, 7})
    ->Args({64, 64, 7})
    ->Args({200, 64, 7})
    ->Args({32, 256, 64})
    ->Args({200, 256, 64})
    ->Unit(benchmark::kMicrosecond);

void index_build_by_shape(benchmark::State& state) {
  const auto outline = star(static_cast<int>(state.range(0)));
  make_site_index(outline, always_a_field());
  for (auto _ : state) benchmark::DoNotOptimize(make_site_index(outline, always_a_field()));
}
BENCHMARK(index_build_by_shape)->Arg(32)->Arg(64)->Arg(1024)->Unit(benchmark::kMicrosecond);

/// The lists of a 32-site star at 64 x 64 by brute force on the processor: every site at every pixel, twice.
void index_build_brute_force(benchmark::State& state) {
  const auto outline = star(static_cast<int>(state.range(0)));
  const auto size = static_cast<int>(state.range(1));
  const double pixel = 2.6 / size, reach = 2.0 * detail::kHalfDiagonal * pixel;
  for (auto _ : state) {
    std::vector<detail::PixelEntry> entries;
    std::vector<double> distance(outline->sites.size());
    for (int k = 0; k < size * size; ++k) {
      const Vec2 p = Vec2(-1.3, -1.3) + pixel * Vec2(k % size + 0.5, k / size + 0.5);
      double least = 1e300;
      for (std::size_t s = 0; s < distance.size(); ++s) {
        distance[s] = nearest_on(outline->sites[s], p).distance;
        least = std::min(least, distance[s]);
      }
      for (std::size_t s = 0; s < distance.size(); ++s) {
        if (distance[s] <= least + reach)
          entries.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(s)});
      }
    }
    benchmark::DoNotOptimize(entries.data());
  }
}
BENCHMARK(index_build_brute_force)->Args({32, 64})->Args({32, 256})->Unit(benchmark::kMicrosecond);

/// A body of four sites beside the one whose window it is.
struct WindowScene {
  Shape box = make_box(1.0, 1.0);
  std::vector<PlacedOutline> placed = {{&box.outline, {Vec2(0.0, 0.0), 0.3}, 0},
                                       {&box.outline, {Vec2(1.2, 0.2), 0.7}, 1}};
  Box window;
  WindowScene() {
    window.add(Vec2(-0.8, -0.8));
    window.add(Vec2(0.8, 0.8));
  }
};

void pass_window(benchmark::State& state, const char* backend) {
  FieldOptions options;
  options.context = backend;
  PassRenderer renderer(options);
  const WindowScene scene;
  const auto size = static_cast<int>(state.range(0));
  const double band = std::numeric_limits<double>::infinity();
  for (auto _ : state)
    benchmark::DoNotOptimize(renderer.render(scene.window, size, size, scene.placed, 0, band));
}
BENCHMARK_CAPTURE(pass_window, osmesa, "osmesa")->Arg(32)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(pass_window, egl, "egl")->Arg(32)->Arg(128)->Unit(benchmark::kMicrosecond);

void pass_window_brute_force(benchmark::State& state) {
  const WindowScene scene;
  const auto size = static_cast<int>(state.range(0));
  const double pixel = 1.6 / size;
  std::vector<float> distance(static_cast<std::size_t>(size * size));
  for (auto _ : state) {
    const Frame frame(scene.placed[1].pose);
    for (int k = 0; k < size * size; ++k) {
      const Vec2 p = scene.window.low + pixel * Vec2(k % size + 0.5, k / size + 0.5);
      distance[static_cast<std::size_t>(k)] =
          static_cast<float>(gap_by_brute_force(scene.box.outline, frame.to_local(p)));
    }
    benchmark::DoNotOptimize(distance.data());
  }
}
BENCHMARK(pass_window_brute_force)->Arg(32)->Arg(128)->Arg(512)->Unit(benchmark::kMicrosecond);

void near_owners(benchmark::State& state) {
  PassRenderer renderer{FieldOptions()};
  const WindowScene scene;
  for (auto _ : state) benchmark::DoNotOptimize(renderer.near_owners(scene.window, 0.1, scene.placed, 0));
}
BENCHMARK(near_owners)->Unit(benchmark::kMicrosecond);

/// A whole scene as the drawing code asks for it.
void scene_picture(benchmark::State& state) {
  PassRenderer renderer{FieldOptions()};
  const auto outline = star(20);
  std::vector<PlacedOutline> placed;
  Random random(3);
  for (std::uint32_t i = 0; i < 20; ++i) {
    placed.push_back(
        {outline.get(), {Vec2(random.uniform(0, 16), random.uniform(0, 12)), random.uniform(0, 6)}, i});
  }
  Box window;
  window.add(Vec2(0, 0));
  window.add(Vec2(16, 12));
  for (auto _ : state) {
    benchmark::DoNotOptimize(renderer.render(window, 1600, 1200, placed, FieldImage::kNone,
                                             static_cast<double>(state.range(0)) / 10.0));
  }
}
BENCHMARK(scene_picture)->Arg(5)->Arg(20)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace brink
