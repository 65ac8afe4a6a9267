/// How it goes:
///
///     number the vertices, welding those that are near; take every polygon's edges
///     until nothing is cut: cut each edge at the vertices that lie on it and at its crossings with others
///     of each set of equal pieces keep one if exactly one of its sides is covered
///     at each vertex decide which piece follows which, and walk the loops
///
/// After the first step everything is told by vertex numbers: two pieces are the same if their ends are.
#include "brink/core/shapes/polygon_union.h"

#include <algorithm>
#include <map>
#include <numbers>

#include "brink/core/base/elementary.h"
#include "brink/core/base/error.h"
#include "brink/core/shapes/box_sweep.h"
#include "brink/core/shapes/polygon.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

using Polygon = std::vector<Vec2>;

/// An edge of a polygon, or a piece of one, between two of the vertices; the polygon is on its left.
struct Edge {
  int from = 0, to = 0;
  int polygon = 0;
};

class Union {
 public:
  explicit Union(const std::vector<Polygon>& polygons) : polygons_(polygons) {}

  /// The loops of the boundary. @throws BadInput if cutting does not come to an end, or pieces do not close.
  std::vector<Polygon> loops() {
    take_edges();
    // cut at a computed vertex an edge bends by up to the weld, and may come
    // to lie on a vertex that it missed: again, until nothing is cut
    for (int round = 0; cut_edges(); ++round)
      if (round == 20) throw BadInput("polygons: edges nearly coincide in a way that cannot be cut apart");
    keep_boundary();
    return trace();
  }

 private:
  void take_edges();
  bool cut_edges();
  void find_cuts(std::vector<std::vector<int>>& cuts);
  void cut_pair(int e, int f, std::vector<std::vector<int>>& cuts);
  bool cut_at_vertex(int e, int v, std::vector<std::vector<int>>& cuts) const;
  void keep_boundary();
  bool covered_beside(int u, int v, const std::map<int, int>& winding, bool left) const;
  std::vector<Polygon> trace();
  void pair_at(int vertex, const std::vector<int>& out, const std::vector<int>& in,
               std::vector<int>& next) const;
  Polygon without_collinear(const std::vector<int>& loop, const std::vector<int>& degree) const;

  int vertex_at(const Vec2& p);
  Box box_of(const Edge& e) const;
  /// Direction from one vertex to another, from the x axis on [rad].
  double angle_of(int from, int to) const {
    const Vec2 d = points_[to] - points_[from];
    return brink::angle_of(d.y(), d.x());
  }

  const std::vector<Polygon>& polygons_;
  std::vector<Box> boxes_;  ///< of polygons
  std::vector<Vec2> points_;
  /// The polygons' edges; cut, their pieces; in the end the pieces of the union's boundary (polygon -1).
  std::vector<Edge> edges_;
  /// Vertices, and a vertex and an edge, that are nearer to each other are one [m].
  double weld_ = 0.0;
};

/// The vertex within the weld of p, or a new one. The first found keeps its bits.
/// Cost: all vertices so far.
int Union::vertex_at(const Vec2& p) {
  for (std::size_t k = 0; k < points_.size(); ++k)
    if ((points_[k] - p).squaredNorm() <= weld_ * weld_) return static_cast<int>(k);
  points_.push_back(p);
  return static_cast<int>(points_.size()) - 1;
}

/// Grown by the weld, so that an edge is paired with all that may lie on it.
Box Union::box_of(const Edge& e) const {
  Box box;
  box.add(points_[e.from]);
  box.add(points_[e.to]);
  return box.grown(weld_);
}

/// Fills boxes_, weld_, points_ and edges_ from the polygons.
void Union::take_edges() {
  Box all;
  for (const Polygon& polygon : polygons_) {
    boxes_.emplace_back();
    for (const Vec2& v : polygon) boxes_.back().add(v);
    all.add(boxes_.back());
  }
  weld_ = 1e-12 * all.extent().norm();
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    std::vector<int> ids;
    for (const Vec2& v : polygons_[k]) ids.push_back(vertex_at(v));
    for (std::size_t j = 0; j < ids.size(); ++j) {
      const int to = ids[(j + 1) % ids.size()];
      // an edge shorter than the weld has gone
      if (ids[j] != to) edges_.push_back({ids[j], to, static_cast<int>(k)});
    }
  }
}

/// Notes a cut of edge e at vertex v if v lies on it. True if v is on the edge, ends included.
bool Union::cut_at_vertex(int e, int v, std::vector<std::vector<int>>& cuts) const {
  const Edge& edge = edges_[e];
  if (v == edge.from || v == edge.to) return true;
  const Vec2 d = points_[edge.to] - points_[edge.from], w = points_[v] - points_[edge.from];
  const double along = w.dot(d);
  // a cross product over the length is the distance from the edge's line [m]
  if (along <= 0.0 || along >= d.squaredNorm() || std::abs(cross(d, w)) > weld_ * d.norm()) return false;
  cuts[e].push_back(v);
  return true;
}

/// Notes where two edges cut each other: at ends that lie on the other, or where they cross.
void Union::cut_pair(int e, int f, std::vector<std::vector<int>>& cuts) {
  // two edges share one place at most, unless they lie on each other, and then
  // ends lie on edges: a crossing is computed only where no end touches
  bool touch = cut_at_vertex(e, edges_[f].from, cuts);
  touch |= cut_at_vertex(e, edges_[f].to, cuts);
  touch |= cut_at_vertex(f, edges_[e].from, cuts);
  touch |= cut_at_vertex(f, edges_[e].to, cuts);
  if (touch) return;
  const Vec2 &a = points_[edges_[e].from], &c = points_[edges_[f].from];
  const Vec2 d = points_[edges_[e].to] - a, g = points_[edges_[f].to] - c;
  const double turn = cross(d, g);
  // parallel, and no end of one on the other
  if (turn == 0.0) return;
  const double s = cross(c - a, g) / turn, t = cross(c - a, d) / turn;
  if (!(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) return;
  // may move points_, to which a and c refer: they are not used again
  const int v = vertex_at(a + s * d);
  // a crossing within the weld of an end is that end, and cuts the other edge alone
  if (v != edges_[e].from && v != edges_[e].to) cuts[e].push_back(v);
  if (v != edges_[f].from && v != edges_[f].to) cuts[f].push_back(v);
}

/// Every pair of edges whose boxes overlap.
void Union::find_cuts(std::vector<std::vector<int>>& cuts) {
  std::vector<Box> boxes;
  for (const Edge& edge : edges_) boxes.push_back(box_of(edge));
  for_overlapping(boxes, [&](int e, int f) { cut_pair(e, f, cuts); });
}

/// One round: cuts every edge at the vertices found on it. True if any was cut.
bool Union::cut_edges() {
  std::vector<std::vector<int>> cuts(edges_.size());
  find_cuts(cuts);
  std::vector<Edge> pieces;
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const Edge edge = edges_[k];
    const Vec2 a = points_[edge.from], d = points_[edge.to] - a;
    std::sort(cuts[k].begin(), cuts[k].end(), [&](int u, int v) {
      // along the edge; where two are equally far, by number, so that the order is total
      const double su = (points_[u] - a).dot(d), sv = (points_[v] - a).dot(d);
      return su != sv ? su < sv : u < v;
    });
    int from = edge.from;
    cuts[k].push_back(edge.to);
    for (int v : cuts[k]) {
      // several pairs may have found the same cut
      if (v != from) pieces.push_back({from, v, edge.polygon});
      from = v;
    }
  }
  const bool changed = pieces.size() != edges_.size();
  edges_ = std::move(pieces);
  return changed;
}

/// Whether any polygon covers the left (right) side of the piece u -> v; `winding` counts, for each polygon
/// that has the piece, how often it runs along u -> v less how often against it.
bool Union::covered_beside(int u, int v, const std::map<int, int>& winding, bool left) const {
  // cut at all others, the piece crosses no boundary: its middle speaks for it
  const Vec2 middle = 0.5 * (points_[u] + points_[v]);
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    // of a polygon that has the piece on its boundary the side is known; its middle would be a matter of rounding
    const auto own = winding.find(static_cast<int>(k));
    if (own != winding.end()) {
      if (left ? own->second > 0 : own->second < 0) return true;
    } else if (boxes_[k].contains(middle) && polygon_contains(polygons_[k], middle)) {
      return true;
    }
  }
  return false;
}

/// Keeps the pieces with exactly one side covered, once each, with that side on their left.
void Union::keep_boundary() {
  // in order of vertices, which are numbered as they are given: the loops come in an order of the input
  std::map<std::pair<int, int>, std::map<int, int>> pieces;
  // by its lower vertex first: pieces of all polygons that run along the same way come together
  for (const Edge& e : edges_) pieces[std::minmax(e.from, e.to)][e.polygon] += e.from < e.to ? 1 : -1;
  edges_.clear();
  for (const auto& [ends, winding] : pieces) {
    const auto [u, v] = ends;
    const bool left = covered_beside(u, v, winding, true), right = covered_beside(u, v, winding, false);
    // both: inside of the union; neither: a fold of no width
    if (left && !right) edges_.push_back({u, v, -1});
    if (right && !left) edges_.push_back({v, u, -1});
  }
}

/// Decides which piece follows which where several pass through a vertex. Around it, counter-clockwise, a
/// leaving piece opens a wedge of solid and an arriving one closes it.
/// For a vertex that one loop passes through there is one answer. @throws BadInput if leaving and arriving
/// pieces do not take turns.
void Union::pair_at(int vertex, const std::vector<int>& out, const std::vector<int>& in,
                    std::vector<int>& next) const {
  struct Ray {
    double angle;
    int edge;
    bool leaves;
  };
  std::vector<Ray> rays;
  for (int e : out) rays.push_back({angle_of(vertex, edges_[e].to), e, true});
  for (int e : in) rays.push_back({angle_of(vertex, edges_[e].from), e, false});
  std::sort(rays.begin(), rays.end(), [](const Ray& p, const Ray& q) { return p.angle < q.angle; });
  const int n = static_cast<int>(rays.size());
  bool reflex = false;
  for (int k = 0; k < n; ++k) {
    const Ray &ray = rays[k], &following = rays[(k + 1) % n];
    // of two leaving ones in a row the second would have solid on both sides, of two arriving ones none
    if (ray.leaves == following.leaves)
      throw BadInput("polygons: the union does not close at " + text(points_[vertex]) +
                     "; parts there overlap by about 1e-12 of the extent");
    // up to the next ray, over the turn of the angle where it is the first one again [rad]
    const double opening = following.angle - ray.angle + (k + 1 == n ? 2 * std::numbers::pi : 0.0);
    reflex |= ray.leaves && opening > std::numbers::pi;
  }
  for (int k = 0; k < n; ++k)
    // an arriving piece goes on along the other side of its own wedge of solid, or, where one wedge is
    // reflex, across the free wedge; of one wedge alone both are the same
    if (!rays[k].leaves) next[rays[k].edge] = rays[(k + (reflex ? 1 : n - 1)) % n].edge;
}

/// Each piece is in one loop: `next` is a permutation of the pieces, so that a walk comes back to where it began.
std::vector<Polygon> Union::trace() {
  std::vector<std::vector<int>> out(points_.size()), in(points_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    out[edges_[e].from].push_back(static_cast<int>(e));
    in[edges_[e].to].push_back(static_cast<int>(e));
  }
  std::vector<int> next(edges_.size(), -1), degree(points_.size());
  for (std::size_t v = 0; v < points_.size(); ++v) {
    // how often loops pass through it
    degree[v] = static_cast<int>(out[v].size());
    if (!out[v].empty() || !in[v].empty()) pair_at(static_cast<int>(v), out[v], in[v], next);
  }
  std::vector<Polygon> loops;
  std::vector<bool> done(edges_.size(), false);
  for (std::size_t first = 0; first < edges_.size(); ++first) {
    std::vector<int> loop;
    for (int e = static_cast<int>(first); !done[e]; e = next[e]) {
      done[e] = true;
      loop.push_back(edges_[e].from);
    }
    if (!loop.empty()) loops.push_back(without_collinear(loop, degree));
  }
  return loops;
}

/// Drops vertices that lie on the line between their neighbours up to rounding and that no other loop uses.
/// Three vertices are kept in any case.
Polygon Union::without_collinear(const std::vector<int>& loop, const std::vector<int>& degree) const {
  std::vector<int> kept = loop;
  for (std::size_t k = 0; k < kept.size() && kept.size() > 3;) {
    const Vec2& before = points_[kept[(k + kept.size() - 1) % kept.size()]];
    const Vec2 &p = points_[kept[k]], &after = points_[kept[(k + 1) % kept.size()]];
    const double off = std::abs(cross(after - before, p - before)) / (after - before).norm();
    const bool between = (p - before).dot(after - p) > 0.0;
    // a few roundings of the extent: a bend as small as the weld, which was given, stays
    if (degree[kept[k]] == 1 && between && off <= 1e-3 * weld_)
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(k));
    else
      ++k;
  }
  Polygon polygon;
  for (int v : kept) polygon.push_back(points_[v]);
  return polygon;
}

}  // namespace

std::vector<Polygon> union_of_polygons(const std::vector<Polygon>& polygons) {
  return Union(polygons).loops();
}

}  // namespace brink
