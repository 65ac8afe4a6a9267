// From OKLCH to sRGB: polar to Cartesian (OKLab), a linear map, cubes (cone responses), a linear map
// (linear sRGB), the transfer function. Where the result is outside 0..1 chroma is taken back until it
// fits.
#include "brink/scenes/draw/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace brink::draw {
namespace {

/// The transfer function of sRGB (IEC 61966-2-1).
double encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

/// The two matrices of OKLab's definition (Ottosson 2020), inverted.
/// Linear sRGB of an OKLab colour; components outside 0..1 have no sRGB.
std::array<double, 3> linear_rgb(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

/// The same by lightness and hue of `c` and another chroma. OKLCH is OKLab in polar coordinates.
std::array<double, 3> linear_rgb(const Oklch& c, double chroma) {
  const double hue = c.hue * std::numbers::pi / 180.0;
  return linear_rgb(c.lightness, chroma * std::cos(hue), chroma * std::sin(hue));
}

/// Roundings of the matrices take white and black a little beyond.
/// True if sRGB has the colour.
bool displayable(const std::array<double, 3>& rgb) {
  return std::all_of(rgb.begin(), rgb.end(), [](double x) { return x >= -1e-6 && x <= 1.0 + 1e-6; });
}

/// "disc[3]" and "disc_3" belong to the group "disc".
/// First the brackets, then the digits: "disc_3[2]" is one of "disc", too. A name of digits alone stays.
std::string group_of(std::string name) {
  const auto copy = name.rfind('[');  // any name may end so
  if (copy != std::string::npos && name.back() == ']') name.erase(copy);
  const std::size_t end = name.find_last_not_of("0123456789_");
  if (end != std::string::npos) name.erase(end + 1);
  return name;
}

/// Of groups of bodies, in the order in which they are given out. Any two that follow each other, the first
/// after the last too, differ in hue by 30 degrees at least, and in lightness, for those who do not tell
/// some hues apart.
constexpr std::array<Oklch, 8> kHues{{{0.60, 0.125, 252.0},
                                      {0.69, 0.155, 38.0},
                                      {0.81, 0.145, 82.0},
                                      {0.67, 0.105, 182.0},
                                      {0.58, 0.135, 305.0},
                                      {0.66, 0.155, 8.0},
                                      {0.70, 0.125, 140.0},
                                      {0.74, 0.095, 222.0}}};

/// The distance map: lightness in equal steps, hue from violet to yellow, chroma within what sRGB can show.
constexpr std::array<Oklch, 6> kMap{{{0.215, 0.075, 305.0},
                                     {0.36, 0.095, 275.0},
                                     {0.505, 0.088, 236.0},
                                     {0.65, 0.105, 182.0},
                                     {0.795, 0.150, 140.0},
                                     {0.94, 0.155, 108.0}}};

/// Evenly spread in -1..1 for k = 0, 1, 2 ... (multiples of the golden ratio).
/// Half a turn is added so that the first member of a group has the group's own colour: spread(0) is 0.
double spread(std::size_t k) {
  const double turns = 0.6180339887498949 * static_cast<double>(k) + 0.5;
  // Fractional parts of multiples of the golden ratio fill the circle without clusters,
  // however many are asked.
  return 2.0 * (turns - std::floor(turns)) - 1.0;
}

}  // namespace

std::uint32_t Color::argb() const {
  // Rounded to the nearest level, not cut: pure white stays 255.
  const auto byte = [](double x) {
    return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(x, 0.0, 1.0)));
  };
  return 0xff000000U | byte(red) << 16 | byte(green) << 8 | byte(blue);
}

// Lightness and hue are kept and chroma gives way: cutting the channels would change all three.
Color Oklch::rgb() const {
  std::array<double, 3> rgb = linear_rgb(*this, chroma);
  // Bisection of the chroma: at 0 every lightness is a grey, which sRGB has.
  for (double low = 0.0, high = chroma; !displayable(rgb) && high - low > 1e-4;) {
    const double middle = 0.5 * (low + high);
    (displayable(linear_rgb(*this, middle)) ? low : high) = middle;
    // The last chroma known to be displayable.
    if (high - low <= 1e-4) rgb = linear_rgb(*this, low);
  }
  for (double& x : rgb) x = encoded(std::clamp(x, 0.0, 1.0));
  return {rgb[0], rgb[1], rgb[2]};
}

Color distance_color(double fraction) {
  const double x = std::clamp(fraction, 0.0, 1.0) * (kMap.size() - 1);
  // The last colour belongs to the last piece.
  const std::size_t k = std::min(static_cast<std::size_t>(x), kMap.size() - 2);
  const double t = x - static_cast<double>(k);
  const Oklch low = kMap[k], high = kMap[k + 1];
  return Oklch{low.lightness + t * (high.lightness - low.lightness),
               low.chroma + t * (high.chroma - low.chroma), low.hue + t * (high.hue - low.hue)}
      .rgb();
}

// Groups are numbered as they come, so a palette depends on names and their order alone: the same world has
// the same colours in every picture of a run.
Palette::Palette(const World& world) {
  std::map<std::string, std::size_t> groups;
  std::vector<std::size_t> group, place;
  std::vector<std::size_t> members;
  for (const Body& body : world.bodies) {
    const std::size_t g = groups.emplace(group_of(body.name), groups.size()).first->second;
    if (g == members.size()) members.push_back(0);
    group.push_back(g);
    // Members of a group are counted in the order of the world: copies keep their shade as long as
    // those before stay.
    place.push_back(members[g]++);
  }
  for (std::size_t k = 0; k < world.bodies.size(); ++k) {
    // Where all bodies have one name a hue for the group would make them all alike.
    const std::size_t hue = members.size() > 1 ? group[k] : k;
    Oklch color = kHues[hue % kHues.size()];
    // -1..1 within a group, or within one hue; 9 degrees and 0.045 keep the group together.
    const double shift = members.size() > 1 ? spread(place[k]) : spread(k / kHues.size());
    color.lightness += 0.045 * shift;
    color.hue += 9.0 * shift;
    bodies_.push_back(color);
  }
}

Oklch Palette::strong(std::size_t k) const {
  Oklch color = bodies_[k];
  color.lightness += 0.07 * spread(k);
  color.hue += 14.0 * spread(k);
  return color;
}

Oklch Palette::site(std::size_t k) const {
  // Multiples of the golden angle, 137.5 degrees.
  return {0.66 + 0.06 * spread(k), 0.085, 165.0 + 137.5 * static_cast<double>(k)};
}

}  // namespace brink::draw
