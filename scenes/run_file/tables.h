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
  sample_on_body INTEGER, t_low REAL,
  x REAL, y REAL, angle REAL, vx_before REAL, vy_before REAL, omega_before REAL, vx REAL, vy REAL, omega REAL,
  other_x REAL, other_y REAL, other_angle REAL, other_vx_before REAL, other_vy_before REAL, other_omega_before REAL,
  other_vx REAL, other_vy REAL, other_omega REAL);
CREATE TABLE site_frame (t REAL, site INTEGER, x REAL, y REAL, angle REAL, vx REAL, vy REAL, omega REAL);
CREATE TABLE contact (t_begin REAL, t_end REAL, body INTEGER, other INTEGER, site INTEGER, outline_site INTEGER, sample INTEGER,
  mode TEXT, force_n REAL, force_t REAL, sample_on_body INTEGER, px REAL, py REAL, nx REAL, ny REAL);
CREATE TABLE knot (t REAL, body INTEGER, x REAL, y REAL, angle REAL, vx_before REAL, vy_before REAL, omega_before REAL,
  vx REAL, vy REAL, omega REAL, events INTEGER);
CREATE TABLE work (counter TEXT PRIMARY KEY, value REAL, unit TEXT);
CREATE TABLE checkpoint (t REAL, state BLOB, frames INTEGER, events INTEGER, wall_seconds REAL, contacts INTEGER,
  knots INTEGER);
)";

/// Questions that people ask, units in the names of the columns.
inline constexpr const char* kRunFileViews = R"(
CREATE VIEW IF NOT EXISTS energy_over_time AS
  SELECT f.t AS t_s,
    sum(0.5 * b.mass * (f.vx * f.vx + f.vy * f.vy) + 0.5 * b.inertia * f.omega * f.omega) AS kinetic_J,
    -sum(b.mass * (f.x * g.x + f.y * g.y)) AS of_gravity_J,
    sum(b.mass * f.vx) AS momentum_x_Ns, sum(b.mass * f.vy) AS momentum_y_Ns,
    sum(b.mass * (f.x * f.vy - f.y * f.vx) + b.inertia * f.omega) AS angular_momentum_Nms
  FROM frame f JOIN body b ON b.id = f.body,
    (SELECT json_extract(value, '$.world.gravity[0]') AS x, json_extract(value, '$.world.gravity[1]') AS y
     FROM meta WHERE key = 'options') g
  GROUP BY f.t;
CREATE VIEW IF NOT EXISTS body_path AS
  SELECT b.name AS body, f.t AS t_s, f.x AS x_m, f.y AS y_m, f.angle AS angle_rad, f.vx AS vx_m_per_s,
    f.vy AS vy_m_per_s, f.omega AS omega_rad_per_s
  FROM body b JOIN frame f ON f.body = b.id;
CREATE VIEW IF NOT EXISTS contacts_of AS
  SELECT b.name AS body, coalesce(o.name, s.name) AS with_what, e.t AS t_s, e.kind AS kind, e.px AS x_m, e.py AS y_m,
    e.closing_speed AS closing_speed_m_per_s, e.impulse_n AS impulse_normal_Ns, e.impulse_t AS impulse_tangential_Ns
  FROM event e JOIN body b ON b.id = e.body LEFT JOIN body o ON o.id = e.other LEFT JOIN site s ON s.id = e.site
  UNION ALL
  SELECT o.name, b.name, e.t, e.kind, e.px, e.py, e.closing_speed, e.impulse_n, e.impulse_t
  FROM event e JOIN body b ON b.id = e.body JOIN body o ON o.id = e.other;
CREATE VIEW IF NOT EXISTS timeline AS
  SELECT 0.1 * cast(10.0 * t AS INTEGER) AS from_s, kind, count(*) AS events_in_a_tenth_of_a_second
  FROM event GROUP BY cast(10.0 * t AS INTEGER), kind;
)";

/// Made when a run ends, dropped when it goes on.
inline constexpr const char* kRunFileIndices = R"(
CREATE INDEX IF NOT EXISTS event_in_time ON event (t);
CREATE INDEX IF NOT EXISTS knot_in_time ON knot (t);
CREATE INDEX IF NOT EXISTS event_of_body ON event (body);
CREATE INDEX IF NOT EXISTS event_of_other ON event (other) WHERE other IS NOT NULL;
)";
inline constexpr const char* kFrameIndex = "CREATE INDEX IF NOT EXISTS frame_of_body ON frame (body)";
inline constexpr const char* kDropIndices =
    "DROP INDEX IF EXISTS event_in_time; DROP INDEX IF EXISTS knot_in_time; DROP INDEX IF EXISTS "
    "event_of_body; DROP INDEX IF EXISTS "
    "event_of_other; DROP INDEX IF EXISTS "
    "frame_of_body";

}  // namespace brink
