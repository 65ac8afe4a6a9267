#pragma once
/// One picture in the making: what its parts need to know.

#include <span>
#include <vector>

#include "brink/scenes/draw/canvas.h"
#include "brink/scenes/draw/color.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/draw/view.h"

namespace brink::draw {

/// One picture in the making.
struct Sheet {
  const World& world;
  std::span<const BodyState> bodies;  ///< moved home (way_home())
  std::span<const Vec2> moves;        ///< by how much each of them was moved [m]
  std::span<const Pose> sites;
  const DrawOptions& options;
  Palette palette;
  int excluded = -1;  ///< body of a pass
  int strip = 0;      ///< height of the caption [pixels]
  View view;
  double full_scale = 0.0;  ///< depth: distance at the light end of the legend [m]
};

/// Height of the caption's strip [pixels]; 0: none asked for, or no room.
int strip_height(const DrawOptions& options);

/// The largest of options.forces [N]; 0: there are none.
double largest_force(const Sheet& sheet);

/// Lines from the centres of bodies to their contacts, over the bodies.
void draw_forces(Canvas& canvas, const Sheet& sheet);

/// Trails under the bodies.
void draw_trails(Canvas& canvas, const Sheet& sheet);
/// Velocities, contacts, names, axes, over everything.
void draw_marks(Canvas& canvas, const Sheet& sheet);
/// The box of a plane that repeats itself.
void draw_period(Canvas& canvas, const Sheet& sheet);
/// By how much what lies at `place` is moved into the period that begins at the origin [m]; 0 in a plane that does not repeat.
Vec2 way_home(const Periods& periods, const Vec2& place);
/// By how much what fills `box` is shifted to where it is seen, itself first: in a plane that repeats itself, its images that
/// reach into the view [m]. @pre it is at home, or near it: images in neighbouring periods are looked at, no others.
std::vector<Vec2> images_of(const Sheet& sheet, const Box& box);
/// The same of an outline at `pose`.
std::vector<Vec2> seen_at(const Sheet& sheet, const Outline& outline, const Pose& pose);

/// Title, time, and a ruler (layer depth: the legend) in the strip at the bottom.
void draw_caption(Canvas& canvas, const Sheet& sheet);

}  // namespace brink::draw
