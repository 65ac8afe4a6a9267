#pragma once
/// The tables of a run file, as they are made. Internal to the run file.

namespace brink {

inline constexpr const char* kRunFileTables = R"(
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT);
CREATE TABLE body (id INTEGER PRIMARY KEY, name TEXT, mass REAL, inertia REAL, shape TEXT);
CREATE TABLE site (id INTEGER PRIMARY KEY, name TEXT, owner INTEGER, kind TEXT, shape TEXT);
CREATE TABLE frame (t REAL, body INTEGER, x REAL, y REAL, angle REAL, vx REAL, vy REAL, omega REAL);
CREATE TABLE event (seq INTEGER PRIMARY KEY, t REAL, kind TEXT, body INTEGER, other INTEGER, site INTEGER, px REAL, py REAL,
  nx REAL, ny REAL, closing_speed REAL, impulse_n REAL, impulse_t REAL, gap REAL, outline_site INTEGER, sample INTEGER,
  sample_on_body INTEGER, t_low REAL);
CREATE TABLE contact (t_begin REAL, t_end REAL, body INTEGER, other INTEGER, site INTEGER, outline_site INTEGER, sample INTEGER,
  mode TEXT, force_n REAL, force_t REAL, sample_on_body INTEGER, px REAL, py REAL, nx REAL, ny REAL);
CREATE TABLE work (counter TEXT PRIMARY KEY, value REAL, unit TEXT);
CREATE TABLE checkpoint (t REAL, state BLOB, frames INTEGER, events INTEGER, wall_seconds REAL, contacts INTEGER);
)";

}  // namespace brink
