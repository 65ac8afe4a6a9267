// A fragment shader is put together from parts that call each other by name:
//   - core_distance(q, side): from the pixel's place to the core of the site. Straight sites, or arcs as well.
//   - drawn_value(side), write_depth(t): what an image shows; exact, or interpolated over cones and tents.
//   - wanted(): whether the layer shows this site here.
//   - main(): of an image, of bounds, or of one that fills a storage buffer.
// gl_FragCoord is the pixel's centre, (i + 1/2, j + 1/2) from the window's lower left corner: less half the
// window's size it is the place from its centre, in which all sites are given; uint() of it is i and j.
#include "brink/core/fields/field_shaders.h"

namespace brink::detail {

namespace {

// Four corners of a strip from gl_VertexID alone: the oriented rectangle of a site's band, in pixels
// from the window's centre. z is 0: the fragment shader writes the depth.
// Inputs are SiteInstance (site_batch.h) in the order of kAttributes (field_renderer.cpp). Bit 0 of the number says
// low or high along the axis, bit 1 across it.
constexpr const char* kVertex = R"(
layout(location = 0) in vec4 frame;
layout(location = 1) in vec4 extent;
layout(location = 2) in vec4 ends_in;
layout(location = 3) in vec4 arc_in;
layout(location = 4) in vec4 pseudo_in;
layout(location = 5) in vec2 shift_in;
layout(location = 6) in uvec2 tag_in;
flat out vec4 ends;
flat out vec4 arc;
flat out vec4 pseudo;
flat out vec2 shift;
flat out uvec2 tag;
uniform vec2 half_size;
void main() {
  float along = (gl_VertexID & 1) == 0 ? extent.x : extent.y;
  float across = (gl_VertexID & 2) == 0 ? extent.z : extent.w;
  vec2 p = frame.xy + along * frame.zw + across * vec2(-frame.w, frame.z);
  gl_Position = vec4(p / half_size, 0.0, 1.0);
  ends = ends_in;
  arc = arc_in;
  pseudo = pseudo_in;
  shift = shift_in;
  tag = tag_in;
}
)";

// Clip space has z in [-1, 1], the depth buffer [0, 1]: 2 z' - 1 is stored as z', the same depth that the exact
// shader writes for this value.
constexpr const char* kMeshVertex = R"(
layout(location = 0) in vec2 place;
layout(location = 1) in vec2 height_in;
layout(location = 2) in uvec2 tag_in;
out vec2 height;  // drawn value, side; linear, as w is 1 everywhere
flat out uvec2 tag;
uniform vec2 half_size;
uniform float depth_scale;
void main() {
  gl_Position = vec4(place / half_size, 2.0 * height_in.x * depth_scale - 1.0, 1.0);
  height = height_in;
  tag = tag_in;
}
)";

// The rasteriser has interpolated the value, and writes the depth.
constexpr const char* kMesh = R"(
in vec2 height;
flat in uvec2 tag;
float drawn_value(out float side) { side = height.y; return height.x; }
void write_depth(float t) {}
)";

// What the fragment needs of its site, flat: interpolation would round.
constexpr const char* kInputs = R"(
flat in vec4 ends;
flat in vec4 arc;
flat in vec4 pseudo;
flat in vec2 shift;
flat in uvec2 tag;
uniform vec2 half_size;
float cross2(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }
)";

// Distance from q to the core; side < 0 where q is on the solid side. Mirrors nearest_on() and side_of() of
// core/shapes/distance.h; the rounding is bounded in site_batch.h. Beyond an end the distance is computed
// from that end alone, so that two sites which share it tie there bit for bit. A point is a segment without
// length (d = 0, t = 0).
// Of `side` only the sign is used: cross products and pseudo-normals need no unit length. A segment's solid is on
// its left, where cross2(d, wa) > 0.
constexpr const char* kStraight = R"(
float straight_distance(vec2 q, out float side) {
  vec2 wa = q - ends.xy, d = ends.zw - ends.xy;
  float t = dot(wa, d) * arc.x;
  side = t <= 0.0 ? dot(wa, pseudo.xy) : t >= 1.0 ? dot(q - ends.zw, pseudo.zw) : -cross2(d, wa);
  return length(t >= 1.0 ? q - ends.zw : wa - max(t, 0.0) * d);
}
)";

// Without the branch for arcs, which costs even where it is not taken (field_shaders.h).
constexpr const char* kOnlyStraight = R"(
float core_distance(vec2 q, out float side) { return straight_distance(q, side); }
)";

// The test on dot(w, from + to) keeps rounding from taking the far side of a thin sector for the near one.
// The sector's edges are tested with wa and wb in place of w: as w = from + wa = to + wb, the cross products are
// the same, and near an end their terms are small, and so are their roundings. Of an arc that turns to the left
// the solid is inside the circle, of one that turns to the right outside. Elsewhere the nearer end tells.
constexpr const char* kWithArcs = R"(
float core_distance(vec2 q, out float side) {
  if ((tag.y & 3u) != 2u) return straight_distance(q, side);
  vec2 w = q - arc.xy, wa = q - ends.xy, wb = q - ends.zw, from = ends.xy - arc.xy, to = ends.zw - arc.xy;
  if (arc.w * cross2(from, wa) > 0.0 && arc.w * cross2(wb, to) > 0.0 && dot(w, from + to) > 0.0) {
    float off = length(w) - arc.z;
    side = arc.w * off;
    return abs(off);
  }
  float da = length(wa), db = length(wb);
  side = da <= db ? dot(wa, pseudo.xy) : dot(wb, pseudo.zw);
  return min(da, db);
}
)";

// "inside" is the id's top bit: the solid side of the nearest site, or within its thickness (values
// below the offset are distances below the radius). tag.y & 4 is "solid".
// wanted() is only declared: it comes from the part that follows.
constexpr const char* kImage = R"(
layout(location = 0) out uint site;
layout(location = 1) out float value;
uniform float limit;   // values beyond it are not drawn
uniform float offset;  // value of the site's surface
bool wanted();
void main() {
  float side;
  float t = drawn_value(side);
  if (t > limit || !wanted()) discard;
  bool inside = (side < 0.0 && (tag.y & 4u) != 0u) || t < offset;
  site = inside ? tag.x | 0x80000000u : tag.x;
  value = t;
  write_depth(t);
}
)";

constexpr const char* kExactValue = R"(
uniform float depth_scale;
float drawn_value(out float side) { return core_distance(gl_FragCoord.xy - half_size, side) + shift.x; }
void write_depth(float t) { gl_FragDepth = t * depth_scale; }
)";

// layer 0 shows every site; layer 1 those of another owner than layer 0 shows, and
// nothing where that is empty
constexpr const char* kFirst = R"(
bool wanted() { return true; }
)";

constexpr const char* kSecond = R"(
uniform usampler2D first;  // ids of the first layer
uniform usamplerBuffer owners;
bool wanted() {
  uint before = texelFetch(first, ivec2(gl_FragCoord.xy), 0).r;
  if (before == 0xffffffffu) return false;
  uint owner = texelFetch(owners, int(before & 0x7fffffffu)).r;
  return owner != texelFetch(owners, int(tag.x)).r;
}
)";

// shift.x makes an upper bound of the distance here: the depth test keeps the least of them.
// The least upper bound of all sites is an upper bound of the nearest distance, whichever site that is of.
constexpr const char* kBound = R"(
layout(location = 0) out float value;
uniform float depth_scale;
void main() {
  float side;
  float t = core_distance(gl_FragCoord.xy - half_size, side) + shift.x;
  value = t;
  gl_FragDepth = t * depth_scale;
}
)";

// shift.y makes a lower bound. The counter goes on past the capacity, so that after a
// draw which overflowed it says how much room the next one needs. `unused` puts entries
// on the 8 bytes that std430 aligns uvec2 to.
constexpr const char* kAppend = R"(
layout(std430, binding = 0) buffer List {
  uint count;
  uint unused;
  uvec2 entries[];
};
uniform sampler2D nearest;
uniform float slack;
uniform uint capacity;
uniform uint width;
void main() {
  float side;
  float t = core_distance(gl_FragCoord.xy - half_size, side) + shift.y;
  float bound = texelFetch(nearest, ivec2(gl_FragCoord.xy), 0).r;
  if (t <= bound + slack) {
    uint place = atomicAdd(count, 1u);
    if (place < capacity) {
      entries[place] = uvec2(uint(gl_FragCoord.y) * width + uint(gl_FragCoord.x), tag.x);
    }
  }
}
)";

// Fragments may write the same flag at once; they all write 1.
// The limit is compared with a lower bound (shift.y), so that no site within it goes unmarked.
constexpr const char* kMark = R"(
layout(std430, binding = 0) buffer Marks { uint marks[]; };
uniform float limit;
void main() {
  float side;
  float t = core_distance(gl_FragCoord.xy - half_size, side) + shift.y;
  if (t <= limit) marks[tag.x] = 1u;
}
)";

/// The line that a shader begins with.
std::string version(FieldProgram program) {
  // buffer blocks need 4.3; all else runs where only 3.3 is there
  const bool storage = program == FieldProgram::append || program == FieldProgram::mark;
  return storage ? "#version 430 core\n" : "#version 330 core\n";
}

}  // namespace

std::string vertex_shader(FieldProgram program, FieldPrimitives primitives) {
  return version(program) + (primitives == FieldPrimitives::mesh ? kMeshVertex : kVertex);
}

std::string fragment_shader(FieldProgram program, FieldPrimitives primitives) {
  const bool mesh = primitives == FieldPrimitives::mesh, arcs = primitives == FieldPrimitives::with_arcs;
  // tents and cones have no core_distance(): their value is interpolated
  const std::string distance =
      mesh ? kMesh : std::string(kInputs) + kStraight + (arcs ? kWithArcs : kOnlyStraight);
  const std::string image = version(program) + distance + (mesh ? "" : kExactValue) + kImage;
  switch (program) {
    case FieldProgram::first:
      return image + kFirst;
    case FieldProgram::second:
      return image + kSecond;
    case FieldProgram::bound:
      return version(program) + distance + kBound;
    case FieldProgram::append:
      return version(program) + distance + kAppend;
    case FieldProgram::mark:
      break;
  }
  return version(program) + distance + kMark;
}

}  // namespace brink::detail
