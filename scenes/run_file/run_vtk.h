#pragma once
/// A run as VTK files, which ParaView and others show. The one door to VTK.

#include <filesystem>

namespace brink {

/// @throws BadInput where Brink was built without VTK.
void require_vtk();

/// Writes into `folder`, which is there:
///
///     run.pvd              the frames with their times [s]: what one opens
///     frame_000000.vtp ... bodies and sites of a frame, a cell a piece of an outline; cell data: body, site (id, or -1),
///                          thickness [m] (pieces of rounded outlines are their cores), vx, vy [m/s], omega [rad/s]
///     events.vtp           a point an event; point data: t [s], kind (0: a collision), body, other, site, normal,
///                          impulse_normal, impulse_tangential [N s], closing_speed [m/s]
///
/// Arcs are polylines off by a thousandth of their radius at most. Lengths are in metres, z = 0.
/// @throws BadInput where Brink was built without VTK; IoError where the run cannot be read or a file not written.
void write_vtk(const std::filesystem::path& run_file, const std::filesystem::path& folder);

}  // namespace brink
