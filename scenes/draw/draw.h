#pragma once
/// Pictures of a moment: bodies and sites over their Voronoi diagram, as PNG files.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "brink/core/base/error.h"
#include "brink/core/fields/field_options.h"
#include "brink/core/world/world.h"

namespace brink {

/// What a picture shows.
struct DrawLayer {
  enum class Kind {
    scene,   ///< bodies and sites over their cells in quiet colours, with faint lines of equal distance
    color,   ///< the raw colour layer: one hue an owner, one shade a site, darker inside solids
    depth,   ///< distance to the nearest site; lightness grows linearly with it
    forces,  ///< what contacts that last carry: lines from centres to contacts, as wide as the force is large
    pass     ///< the pass window of one body: everything else, the body itself left out and only sketched
  };
  Kind kind = Kind::scene;
  std::string body;  ///< pass: its name
};

/// "scene", "color", "depth", "forces" or "pass:BODY". @throws BadInput naming the layer and those allowed.
DrawLayer parse_layer(std::string_view text);

struct PictureSize {
  int width = 1200, height = 900;  ///< pixels
};

/// "WxH", each 16..8192. @throws BadInput.
PictureSize parse_size(std::string_view text);

/// What a contact that lasts presses with on one body.
struct DrawnForce {
  int body = 0;
  Vec2 arm = Vec2::Zero();     ///< from the centre of mass to the contact, world axes [m]
  double newtons = 0.0;        ///< >= 0
  Vec2 normal = Vec2::Zero();  ///< unit, along which it presses; 0: not told
};

/// Where two touched, and the impulse there.
struct DrawnContact {
  Vec2 point = Vec2::Zero(), normal = Vec2::Zero();  ///< world [m]; unit
  double impulse = 0.0;                              ///< [N s], >= 0
};

struct DrawOptions {
  DrawLayer layer;
  PictureSize size;
  std::optional<Box> view;  ///< what must be seen [m]; none: automatic_view (pass: the body's surroundings)
  double margin = 0.05;     ///< left free around the view, of its longer side, 0..1
  bool caption = true;  ///< a strip below with title, time and a ruler or legend; none on pictures too small
  std::string title;    ///< empty: the world's
  std::optional<double> time;             ///< shown in the caption [s]
  std::vector<DrawnForce> forces;         ///< layer forces
  double arrow_seconds = 0.0;             ///< > 0: velocity arrows, as long as the way made in this time [s]
  bool velocities = false;                ///< the same, that of the fastest body 60 pixels long
  bool names = false;                     ///< of bodies
  bool axes = false;                      ///< coordinates in metres along the picture's rims
  std::vector<std::vector<Vec2>> trails;  ///< places of each body, in order [m]
  std::vector<DrawnContact> contacts;
  bool diagram = true;  ///< scene and pass: draw the cells beneath
  FieldOptions field;   ///< context, primitives; a band > 0 truncates the diagram to it

  /// True if usable; else writes which option, its value and what is allowed into *error.
  bool is_valid(std::string* error) const;
};

/// A finished picture: rows from the top, 0xAARRGGBB, opaque.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
  std::uint32_t at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * width + column];
  }
};

/// The part of the plane worth seeing: all bodies, sites of a size with them, and of larger sites (a floor
/// 1000 m long) the part next to the bodies; sites more than 20 times as far away as the bodies' box is large
/// are left out.
/// @pre bodies and sites have one entry each for every body and site of the world.
Box automatic_view(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites);

/// Draws the world with its bodies and sites at the given states and poses. Bodies whose sampling is asked
/// for (any kind but `vertices`) show their particles as dots. The diagram is rendered by PassRenderer at
/// twice the resolution. Layer `scene` does without it (and says so in the log) where no GL context opens;
/// the others need it.
/// Layer `forces` has no diagram; its lines are as wide, of the widest, as the force is of the largest.
/// @throws BadInput on invalid options, an unknown body, or counts or poses that do not fit; IoError without
/// a context.
Picture draw_scene(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites,
                   const DrawOptions& options);

/// Writes a picture as PNG. @throws IoError naming the file and the cause.
void write_png(const std::filesystem::path& file, const Picture& picture);

/// Draws into a file, by its extension: .png, or .svg and .pdf with outlines as curves (the diagram beneath is of pixels
/// there, too). @throws BadInput for another extension, and as draw_scene(); IoError naming the file.
void draw_file(const std::filesystem::path& file, const World& world, std::span<const BodyState> bodies,
               std::span<const Pose> sites, const DrawOptions& options);
/// @throws BadInput if draw_file() would not know the extension.
void require_picture_name(const std::filesystem::path& file);

/// draw_scene, then write_png.
void draw_png(const std::filesystem::path& file, const World& world, std::span<const BodyState> bodies,
              std::span<const Pose> sites, const DrawOptions& options);

}  // namespace brink
