#pragma once
/// A run as an HDF5 file. The one door to HDF5.

#include <filesystem>

namespace brink {

/// @throws BadInput where Brink was built without HDF5.
void require_hdf5();

/// Writes `file`:
///
///     bodies/    name, mass [kg], inertia [kg m^2]                                       one a body
///     frames/    t [s]; x, y [m], angle [rad], vx, vy [m/s], omega [rad/s]               frames x bodies
///     events/    t, kind, body, other, site, x, y, normal_x, normal_y, closing_speed, impulse_normal, impulse_tangential, gap
///     contacts/  from, to, mode, body, other, site, x, y, normal_x, normal_y, force_normal, force_tangential
///     knots/     t, body, x, y, angle, vx_before, vy_before, omega_before, vx, vy, omega, events_before
///
/// Every array has an attribute `unit`: "1" of ids and of parts of a direction, empty of words. Ids that are not
/// there are -1.
/// @throws BadInput where Brink was built without HDF5; IoError where the run cannot be read or the file not written.
void write_hdf5(const std::filesystem::path& run_file, const std::filesystem::path& file);

}  // namespace brink
