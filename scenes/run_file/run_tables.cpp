#include "brink/scenes/run_file/run_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "brink/scenes/files/csv_cell.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/run_file/run_file.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

std::string cell(const std::string& text) { return csv_text(text); }
// NaN and ids that are not there are empty cells.
std::string cell(double x) { return std::isnan(x) ? std::string() : fmt::format("{}", x); }
std::string cell(int id) { return id < 0 ? std::string() : std::to_string(id); }

/// One CSV file as it is written, row by row: only the row is in memory. Each cell() knows how its type
/// is written.
class Table {
 public:
  /// A file that is there is written over. That it could not be opened is told by finish().
  Table(fs::path file, const std::string& head) : file_(std::move(file)), out_(file_, std::ios::binary) {
    out_ << head << '\n';
  }
  template <class... Cells>
  void row(const Cells&... cells) {
    out_ << fmt::format("{}\n", fmt::join(std::vector<std::string>{cell(cells)...}, ","));
  }
  // Errors of the stream stay set until then, so rows need not ask.
  void finish() {
    out_.flush();
    if (!out_) throw_not_written(file_);
  }

 private:
  fs::path file_;
  std::ofstream out_;
};

/// bodies.csv and sites.csv: who the ids of the other tables are.
void write_things(const RunFile& run, const fs::path& folder) {
  Table bodies(folder / "bodies.csv", "body,name,mass_kg,inertia_kg_m2");
  for (const auto& b : run.bodies()) bodies.row(b.id, b.name, b.mass, b.inertia);
  bodies.finish();
  Table sites(folder / "sites.csv", "site,name,kind");
  int id = 0;
  for (const FixedSite& s : run.sites()) sites.row(id++, s.name, s.kind);
  sites.finish();
}

/// A row for each body at each frame. Cost: reads every frame once.
void write_frames(const RunFile& run, const fs::path& folder) {
  Table table(folder / "frames.csv", "t_s,body,x_m,y_m,angle_rad,vx_m_per_s,vy_m_per_s,omega_rad_per_s");
  run.each_frame(1, [&](const RunFile::Frame& f) {
    int id = 0;
    for (const auto& [pose, twist] : f.states)
      table.row(f.t, id++, pose.position.x(), pose.position.y(), pose.angle, twist.velocity.x(),
                twist.velocity.y(), twist.omega);
  });
  table.finish();
}

/// A row an event. Where the other is a body, `site` is empty, and the other way round.
void write_events(const RunFile& run, const fs::path& folder) {
  Table table(
      folder / "events.csv",
      "seq,t_s,kind,body,other,site,x_m,y_m,normal_x,normal_y,closing_speed_m_per_s,impulse_normal_Ns,"
      "impulse_tangential_Ns,gap_m");
  for (const Event& e : run.events()) {
    const Contact& c = e.contact;
    // The shortest digits that read back as the same doubles: the table loses nothing.
    table.row(static_cast<int>(e.seq), c.time, std::string(to_string(e.kind)), c.body, c.other_body,
              c.other_site, c.point.x(), c.point.y(), c.normal.x(), c.normal.y(), c.closing_speed,
              e.impulse_n, e.impulse_t, c.gap);
  }
  table.finish();
}

/// A row for each stretch of a contact that lasted, in the order of their ends.
void write_contacts(const RunFile& run, const fs::path& folder) {
  Table table(folder / "contacts.csv",
              "from_s,to_s,body,other,site,mode,x_m,y_m,normal_x,normal_y,force_normal_N,force_tangential_N");
  for (const LastedContact& c : run.contacts())
    table.row(c.from, c.to, c.body, c.other_body, c.other_site, std::string(to_string(c.mode)), c.point.x(),
              c.point.y(), c.normal.x(), c.normal.y(), c.normal_force, c.tangential_force);
  table.finish();
}

/// How bodies move in islands: a place with the twist before and after.
void write_knots(const RunFile& run, const fs::path& folder) {
  Table table(folder / "knots.csv",
              "t_s,body,x_m,y_m,angle_rad,vx_before_m_per_s,vy_before_m_per_s,omega_before_rad_per_s,"
              "vx_m_per_s,vy_m_per_s,omega_rad_per_s,events_before");
  for (const TimedKnot& k : run.knots())
    table.row(k.time, k.body, k.pose.position.x(), k.pose.position.y(), k.pose.angle, k.before.velocity.x(),
              k.before.velocity.y(), k.before.omega, k.after.velocity.x(), k.after.velocity.y(),
              k.after.omega, static_cast<int>(k.events));
  table.finish();
}

}  // namespace

void write_csv_tables(const fs::path& run_file, const fs::path& folder) {
  RunFile run(run_file);
  run.hold();  // a run that goes on writes more rows meanwhile
  made_folder(folder);
  write_things(run, folder);
  write_frames(run, folder);
  write_events(run, folder);
  write_contacts(run, folder);
  write_knots(run, folder);
}

}  // namespace brink
