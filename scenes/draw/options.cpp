#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>

#include "brink/core/fields/pass_window.h"
#include "brink/scenes/draw/draw.h"

namespace brink {
namespace {

// Above kLargest pass windows are refused; below kSmallest nothing can be told.
constexpr int kSmallest = 16, kLargest = kMostPassPixels;  // sides of a picture [pixels]

}  // namespace

DrawLayer parse_layer(std::string_view text) {
  if (text == "scene") return {DrawLayer::Kind::scene, {}};
  if (text == "color") return {DrawLayer::Kind::color, {}};
  if (text == "depth") return {DrawLayer::Kind::depth, {}};
  if (text == "forces") return {DrawLayer::Kind::forces, {}};
  // The rest is the body's name as it stands, colons included; whether there is such a body is seen on
  // drawing.
  if (text.starts_with("pass:") && text.size() > 5)
    return {DrawLayer::Kind::pass, std::string(text.substr(5))};
  throw BadInput(
      fmt::format("layer: \"{}\" is not known; allowed: scene, color, depth, forces, pass:BODY", text));
}

PictureSize parse_size(std::string_view text) {
  PictureSize size;
  // The height is read only after a width and an `x`; nothing may follow it.
  const char* end = text.data() + text.size();
  const auto [cross_at, first] = std::from_chars(text.data(), end, size.width);
  const bool crossed = first == std::errc() && cross_at != end && *cross_at == 'x';
  const auto [stop, second] = crossed ? std::from_chars(cross_at + 1, end, size.height)
                                      : std::from_chars_result{end, std::errc::invalid_argument};
  // The limits are those of the options, told in one place.
  DrawOptions options;
  options.size = size;
  std::string error;
  if (second != std::errc() || stop != end || !options.is_valid(&error))
    throw BadInput(
        fmt::format("size: \"{}\" is not a size; allowed: WIDTHxHEIGHT in pixels, each {} .. {}, as 1200x900",
                    text, kSmallest, kLargest));
  return size;
}

bool DrawOptions::is_valid(std::string* error) const {
  const auto fault = [&](std::string what) {
    if (error != nullptr) *error = std::move(what);
    return false;
  };
  for (const int side : {size.width, size.height})
    if (side < kSmallest || side > kLargest)
      return fault(fmt::format("size: {}x{} pixels; allowed: each {} .. {}", size.width, size.height,
                               kSmallest, kLargest));
  // Written so that NaN is refused: no comparison with it holds.
  if (!(margin >= 0.0 && margin <= 1.0)) return fault(fmt::format("margin: {}; allowed: 0 .. 1", margin));
  if (!(arrow_seconds >= 0.0) || std::isinf(arrow_seconds))
    return fault(fmt::format("arrow_seconds: {}; allowed: finite, >= 0", arrow_seconds));
  // A view without width is allowed: fitted() makes something visible of it.
  if (view && (view->empty() || !view->low.allFinite() || !view->high.allFinite()))
    return fault("view: must be finite and hold something");
  if (layer.kind == DrawLayer::Kind::pass && layer.body.empty())
    return fault("layer: pass needs a body's name");
  for (const DrawnForce& f : forces)
    if (!f.arm.allFinite() || !(f.newtons >= 0.0) || std::isinf(f.newtons))
      return fault("forces: must be finite and >= 0");
  return field.is_valid(error);
}

}  // namespace brink
