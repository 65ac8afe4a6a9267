#pragma once
/// The one door to Cairo: outlines, marks and text on a picture, anti-aliased, arcs as arcs.

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "brink/core/shapes/outline.h"
#include "brink/scenes/draw/color.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/draw/view.h"

namespace brink::draw {

/// How an outline is painted.
struct Ink {
  Color fill;               ///< of the solid, of wires with thickness, of points
  Color line;               ///< of the crisp edge
  double line_width = 1.4;  ///< [pixels]
  double opacity = 1.0;     ///< of the fill; 0: the edge alone
  bool dashed = false;
};

/// What a canvas becomes: pixels, or a file of lines and curves.
struct Paper {
  enum class Kind { pixels, svg, pdf };
  Kind kind = Kind::pixels;
  std::filesystem::path file;  ///< svg, pdf
};

/// A picture being drawn. World lengths in metres, line widths and text in pixels.
class Canvas {
 public:
  Canvas(const View& view, int width, int height, const Color& background, const Paper& paper = {});
  ~Canvas();

  /// Copies an image (rows from the top) over the picture's top left corner.
  void paste(const Picture& image);

  /// An outline with its thickness; of a container, all that lies outside.
  void outline(const Outline& outline, const Pose& pose, const Ink& ink);
  void line(const Vec2& from, const Vec2& to, const Color& color, double width);
  /// Through all points; `dash`: lengths of strokes and gaps [pixels], empty: none.
  void path(std::span<const Vec2> points, const Color& color, double width, std::span<const double> dash);
  /// A filled polygon.
  void area(std::span<const Vec2> points, const Color& color);
  void dot(const Vec2& at, double pixels, const Color& color);
  void arrow(const Vec2& from, const Vec2& to, const Color& color, double width);
  /// A zigzag between two points.
  void spring(const Vec2& from, const Vec2& to, const Color& color, double width);

  // below the picture, in pixels from the top left corner
  enum class Align { left, middle, right };
  void rectangle(double x, double y, double width, double height, const Color& color);
  /// One line of text with its baseline at y. Returns its width.
  double text(double x, double y, const std::string& words, double size, const Color& color, Align align,
              bool bold = false);
  double text_width(const std::string& words, double size, bool bold = false) const;

  /// @pre of pixels.
  Picture finish();
  /// Ends the file. @pre svg or pdf. @throws IoError naming it and the cause.
  void finish_file();

 private:
  void paste_as_image(const Picture& image);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brink::draw
