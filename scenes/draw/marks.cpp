// What is drawn over and under the bodies: trails, velocities, contacts, names, axes, the box of a plane that repeats itself.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "brink/scenes/draw/sheet.h"

namespace brink::draw {
namespace {

constexpr double kFastest = 60.0;  // [pixels], of velocity arrows
constexpr double kNormal = 14.0,
                 kImpulse = 36.0;  // [pixels], of a contact's arrow, and more for the largest impulse
constexpr double kTextSize = 11.0, kTick = 5.0;  // [pixels]

/// The box that a mark from one place to another fills: it decides which of its images are seen.
Box box_of(const Vec2& from, const Vec2& to) {
  Box box;
  box.add(from);
  box.add(to);
  return box;
}

/// How long the way is that arrows show [s]; 0: none are asked for, or nothing moves.
double seconds_of_arrows(const Sheet& sheet) {
  if (!sheet.options.velocities) return sheet.options.arrow_seconds;
  double most = 0.0;
  // The scale turns pixels into metres: the fastest body's arrow is kFastest pixels long at any
  // size of picture.
  for (const BodyState& s : sheet.bodies) most = std::max(most, s.twist.velocity.norm());
  return most > 0.0 ? kFastest / sheet.view.scale / most : 0.0;
}

/// An arrow a body, from its centre of mass. Bodies too slow for an arrow have none (Canvas::arrow()).
void draw_velocities(Canvas& canvas, const Sheet& sheet) {
  const double seconds = seconds_of_arrows(sheet);
  if (!(seconds > 0.0)) return;
  for (const BodyState& s : sheet.bodies) {
    const Vec2 from = s.pose.position, to = from + seconds * s.twist.velocity;
    for (const Vec2& by : images_of(sheet, box_of(from, to)))
      canvas.arrow(from + by, to + by, Oklch{0.45, 0.12, 155.0}.rgb(), 1.6);
  }
}

/// A dot where two touched, and an arrow along the normal: kNormal pixels long, so that its direction can
/// be seen of the smallest impulse, and longer by what share of the largest impulse it has.
void draw_contacts(Canvas& canvas, const Sheet& sheet) {
  double most = 0.0;
  for (const DrawnContact& c : sheet.options.contacts) most = std::max(most, c.impulse);
  const Color color = Oklch{0.52, 0.2, 25.0}.rgb();
  for (const DrawnContact& c : sheet.options.contacts) {
    const double pixels = kNormal + (most > 0.0 ? kImpulse * c.impulse / most : 0.0);
    // Events are told where they happened, which may be any number of periods away.
    const Vec2 from = c.point + way_home(sheet.world.periods, c.point);
    const Vec2 to = from + pixels / sheet.view.scale * c.normal;
    for (const Vec2& by : images_of(sheet, box_of(from, to))) {
      canvas.dot(from + by, 3.2, color);
      canvas.arrow(from + by, to + by, color, 1.6);
    }
  }
}

void draw_name(Canvas& canvas, const std::string& name, const Vec2& at) {
  // Once in paper colour to every side, then in ink: names can be read over bodies of any colour.
  for (const Vec2& beside : {Vec2(-1, 0), Vec2(1, 0), Vec2(0, -1), Vec2(0, 1)})
    canvas.text(at.x() + beside.x(), at.y() + beside.y() + 0.35 * kTextSize, name, kTextSize,
                Tones::paper.rgb(), Canvas::Align::middle);
  canvas.text(at.x(), at.y() + 0.35 * kTextSize, name, kTextSize, Tones::ink.rgb(), Canvas::Align::middle);
}

/// At the centre of mass of every image, in pixels: text does not grow with the scale. One that would cover another is
/// left out, as on the replay page.
void draw_names(Canvas& canvas, const Sheet& sheet) {
  if (!sheet.options.names) return;
  std::vector<Box> taken;
  for (std::size_t k = 0; k < sheet.bodies.size(); ++k) {
    const Vec2& at = sheet.bodies[k].pose.position;
    const std::string& name = sheet.world.bodies[k].name;
    const Vec2 half(0.5 * canvas.text_width(name, kTextSize) + 2.0, 0.6 * kTextSize);
    for (const Vec2& by : images_of(sheet, box_of(at, at))) {
      const Vec2 place = sheet.view.to_picture(at + by);
      const Box box = box_of(place - half, place + half);
      if (std::ranges::any_of(taken, [&](const Box& other) { return other.overlaps(box); })) continue;
      taken.push_back(box);
      draw_name(canvas, name, place);
    }
  }
}

/// The trail at home: a piece ends where it leaves the period, and the next goes on from there on the other side.
std::vector<std::vector<Vec2>> pieces_of(const Periods& periods, const std::vector<Vec2>& trail) {
  std::vector<std::vector<Vec2>> pieces;
  Vec2 home = Vec2::Zero();
  for (std::size_t k = 0; k < trail.size(); ++k) {
    // `way` is where this point's period lies, `home` where the last one's did. Between two points in
    // different periods the line is drawn twice: once out of the one and once into the other.
    const Vec2 way = way_home(periods, trail[k]);
    if (k > 0) pieces.back().push_back(trail[k] + home);
    if (k == 0 || way != home) {
      pieces.emplace_back();
      if (k > 0) pieces.back().push_back(trail[k - 1] + way);
      pieces.back().push_back(trail[k] + way);
    }
    home = way;
  }
  return pieces;
}

/// The piece, and its images that are seen.
void draw_piece(Canvas& canvas, const Sheet& sheet, const std::vector<Vec2>& piece, const Color& color) {
  Box box;
  for (const Vec2& p : piece) box.add(p);
  for (const Vec2& by : images_of(sheet, box)) {
    std::vector<Vec2> there = piece;
    for (Vec2& p : there) p += by;
    canvas.path(there, color, 1.0, {});
  }
}

/// Ticks and numbers along the lower and the left rim, at whole multiples of the step.
void draw_axes(Canvas& canvas, const Sheet& sheet) {
  if (!sheet.options.axes) return;
  const View& view = sheet.view;
  const Color ink = Tones::ink.rgb();
  // A tick every 48 to 120 pixels: steps of 1, 2 and 5 are at most a factor of 2.5 apart.
  const double step = round_length(120.0 / view.scale);
  const auto each = [&](double low, double high, auto&& f) {
    // Whole steps by a product, so that far ticks are as round as the first.
    for (double k = std::ceil(low / step); k * step <= high; ++k) f(k * step);
  };
  // What should be 0 is a rounding of the step.
  const auto label = [&](double x) { return fmt::format("{:.6g}", std::abs(x) < 1e-9 * step ? 0.0 : x); };
  each(view.window.low.x(), view.window.high.x(), [&](double x) {
    const double at = view.to_picture({x, 0.0}).x();
    canvas.rectangle(at, view.height - kTick, 1.0, kTick, ink);
    // A number that is cut says another: it must fit.
    if (const double half = 0.5 * canvas.text_width(label(x), kTextSize);
        at >= half && at + half <= view.width)
      canvas.text(at, view.height - kTick - 3.0, label(x), kTextSize, ink, Canvas::Align::middle);
  });
  each(view.window.low.y(), view.window.high.y(), [&](double y) {
    const double at = view.to_picture({0.0, y}).y();
    canvas.rectangle(0.0, at, kTick, 1.0, ink);
    // Below the axis' name, above the numbers of the other one.
    if (at > 2.0 * kTextSize + 4.0 && at < view.height - kTick - 1.5 * kTextSize)
      canvas.text(kTick + 3.0, at + 0.35 * kTextSize, label(y), kTextSize, ink, Canvas::Align::left);
  });
  canvas.text(view.width - 4.0, view.height - kTick - kTextSize - 6.0, "x [m]", kTextSize, ink,
              Canvas::Align::right);
  canvas.text(kTick + 3.0, kTextSize + 2.0, "y [m]", kTextSize, ink, Canvas::Align::left);
}

}  // namespace

void draw_trails(Canvas& canvas, const Sheet& sheet) {
  const auto& trails = sheet.options.trails;
  for (std::size_t k = 0; k < std::min(trails.size(), sheet.bodies.size()); ++k)
    for (const std::vector<Vec2>& piece : pieces_of(sheet.world.periods, trails[k]))
      draw_piece(canvas, sheet, piece, Palette::line(sheet.palette.body(k)).rgb());
}

void draw_marks(Canvas& canvas, const Sheet& sheet) {
  draw_velocities(canvas, sheet);
  draw_contacts(canvas, sheet);
  draw_names(canvas, sheet);
  draw_axes(canvas, sheet);
}

void draw_period(Canvas& canvas, const Sheet& sheet) {
  const Vec2& size = sheet.world.periods.size;
  const Box& window = sheet.view.window;
  const Color color = Oklch{0.5, 0.02, 260.0}.rgb();
  for (int axis = 0; axis < 2; ++axis) {
    if (!(size[axis] > 0.0)) continue;
    const int across = 1 - axis;
    for (const double at : {0.0, size[axis]}) {
      Vec2 from, to;
      // Across the other axis: from edge to edge of the box where that repeats, too, else
      // through the whole view.
      from[axis] = to[axis] = at;
      from[across] = size[across] > 0.0 ? 0.0 : window.low[across];
      to[across] = size[across] > 0.0 ? size[across] : window.high[across];
      canvas.line(from, to, color, 1.2);
    }
  }
}

Vec2 way_home(const Periods& periods, const Vec2& place) {
  Vec2 way = Vec2::Zero();
  for (int axis = 0; axis < 2; ++axis)
    if (const double size = periods.size[axis]; size > 0.0)
      way[axis] = -size * std::floor(place[axis] / size);
  return way;
}

std::vector<Vec2> images_of(const Sheet& sheet, const Box& box) {
  std::vector<Vec2> shifts{Vec2::Zero()};
  const Vec2& size = sheet.world.periods.size;
  if (!(size.maxCoeff() > 0.0)) return shifts;
  // Neighbouring periods alone: a view that reaches beyond them shows nothing there.
  for (int right = -1; right <= 1; ++right)
    for (int up = -1; up <= 1; ++up) {
      const Vec2 by(right * size.x(), up * size.y());
      if (by.isZero(0.0) || (right != 0 && size.x() == 0.0) || (up != 0 && size.y() == 0.0)) continue;
      if (Box{box.low + by, box.high + by}.overlaps(sheet.view.window)) shifts.push_back(by);
    }
  return shifts;
}

std::vector<Vec2> seen_at(const Sheet& sheet, const Outline& outline, const Pose& pose) {
  // A container fills all that is outside of it, whichever image is meant.
  if (outline.container) return {Vec2::Zero()};
  // An image is seen if its disc reaches the window.
  return images_of(sheet, box_of(pose.position, pose.position).grown(outline.bounding_radius));
}

}  // namespace brink::draw
