#include "brink/core/fields/field_options.h"

#include <cmath>
#include <initializer_list>
#include <string_view>

namespace brink {

namespace {

/// False if `value` is not allowed; *error then names the key, what was given, and all that is allowed.
bool is_one_of(std::string_view name, std::string_view value, std::initializer_list<std::string_view> allowed,
               std::string* error) {
  std::string list;
  for (const std::string_view a : allowed) {
    if (a == value) return true;
    list += (list.empty() ? "\"" : ", \"") + std::string(a) + "\"";
  }
  *error = "field." + std::string(name) + " is \"" + std::string(value) + "\"; allowed: " + list;
  return false;
}

/// Puts the message into *error; false, for the caller to return.
bool fail(std::string* error, const std::string& message) {
  *error = message;
  return false;
}

}  // namespace

bool FieldOptions::is_valid(std::string* error) const {
  std::string ignored;
  // so that nothing below has to ask
  if (error == nullptr) error = &ignored;
  // 16 and 1024: the range in which a resolution is chosen by shape (body_field.cpp)
  if (resolution != 0 && (resolution < 16 || resolution > 1024)) {
    return fail(error, "field.resolution is " + std::to_string(resolution) +
                           "; allowed: 0 (by shape), or 16 to 1024 pixels");
  }
  // Comparisons with NaN are false: here and below they are written so that NaN is refused.
  if (!(band >= 0.0) || !std::isfinite(band)) {
    return fail(error, "field.band is " + std::to_string(band) +
                           " m; allowed: 0 (by shape), or a finite positive width");
  }
  if (brute_force_below < 0) {
    return fail(error, "field.brute_force_below is " + std::to_string(brute_force_below) +
                           "; allowed: 0 or more sites");
  }
  // A count is one byte of CandidateLists::Cell, and 255 means "ask the tree".
  if (list_cap < 1 || list_cap > 254) {
    return fail(error, "field.list_cap is " + std::to_string(list_cap) + "; allowed: 1 to 254 sites");
  }
  if (!(mesh_error >= 1e-4 && mesh_error <= 10.0)) {
    return fail(error, "field.mesh_error is " + std::to_string(mesh_error) + "; allowed: 1e-4 to 10 pixels");
  }
  return is_one_of("primitives", primitives, {"exact", "mesh"}, error) &&
         is_one_of("readback", readback, {"full", "window", "pixel"}, error) &&
         is_one_of("passes", passes, {"each", "two_layers"}, error) &&
         is_one_of("context", context, {"auto", "osmesa", "egl"}, error);
}

}  // namespace brink
