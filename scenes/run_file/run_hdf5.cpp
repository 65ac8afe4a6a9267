/// The table of groups and arrays is in the header. Columns are gathered whole, but for frames, which
/// are written a row at a time as they are read. The library is C: identifiers are held by Handle,
/// statuses of writing go through require(), and what fails says the same word, which write_hdf5()
/// turns into a message with the file's name.
#include "brink/scenes/run_file/run_hdf5.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "brink/core/base/error.h"
#include "brink/scenes/run_file/run_file.h"

#ifdef BRINK_HDF5
#include <hdf5.h>
#include <hdf5_hl.h>
#endif

namespace brink {

#ifndef BRINK_HDF5

void require_hdf5() {
  throw BadInput("--hdf5: this Brink was built without HDF5 (Debian: libhdf5-dev); allowed: --csv");
}

void write_hdf5(const std::filesystem::path&, const std::filesystem::path&) { require_hdf5(); }

#else

void require_hdf5() {}

namespace {

/// An open thing of the library's, closed at the end.
class Handle {
 public:
  // `close` must be the one for this kind of identifier: a group's does not close a data set.
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) throw IoError("HDF5 refuses");
  }
  // Its status is not looked at, as a destructor has nobody to tell: write_hdf5() flushes before.
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: what the library takes

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// What failed is told by write_hdf5(), which knows the file.
void require(herr_t status) {
  if (status < 0) throw IoError("HDF5 refuses");
}

/// A folder of the file, and arrays of one column in it, each with its attribute `unit`.
class Group {
 public:
  Group(hid_t file, const char* name)
      : id_(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose) {}

  /// Doubles in the machine's own order of bytes; an empty column is an array of length 0.
  void put(const char* name, const char* unit, const std::vector<double>& values) const {
    const hsize_t size = values.size();
    require(H5LTmake_dataset_double(id_, name, 1, &size, values.data()));
    require(H5LTset_attribute_string(id_, name, "unit", unit));
  }
  /// Ids, -1 where there is none: they have no unit, which is written as "1".
  void put(const char* name, const std::vector<int>& values) const {
    const hsize_t size = values.size();
    require(H5LTmake_dataset_int(id_, name, 1, &size, values.data()));
    require(H5LTset_attribute_string(id_, name, "unit", "1"));
  }
  // Variable-length UTF-8; the pointers need to live until H5Dwrite() has returned.
  void put(const char* name, const std::vector<std::string>& words) const {
    std::vector<const char*> pointers;
    for (const std::string& w : words) pointers.push_back(w.c_str());
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    require(H5Tset_size(type, H5T_VARIABLE));
    require(H5Tset_cset(type, H5T_CSET_UTF8));
    const hsize_t size = words.size();
    // By hand, as the library's short way writes one text and not an array of texts.
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle set(H5Dcreate2(id_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    if (!words.empty()) require(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()));
    require(H5LTset_attribute_string(id_, name, "unit", ""));
  }
  operator hid_t() const { return id_; }  // NOLINT: what the library takes

 private:
  Handle id_;
};

/// A table of frames x bodies, written row by row.
/// A run's frames may be more than memory holds: one row of each table is in memory at a time.
class Rows {
 public:
  /// Makes the whole array, frames x bodies, at once; put() fills it. In the file doubles are
  /// little-endian, whatever the machine.
  Rows(const Group& group, const char* name, const char* unit, hsize_t frames, hsize_t bodies)
      : size_{frames, bodies},
        space_(H5Screate_simple(2, size_.data(), nullptr), H5Sclose),
        row_(H5Screate_simple(1, &size_[1], nullptr), H5Sclose),
        set_(H5Dcreate2(group, name, H5T_IEEE_F64LE, space_, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
             H5Dclose) {
    require(H5LTset_attribute_string(group, name, "unit", unit));
  }
  /// One row; `values` has one number a body. @pre frame < frames.
  void put(hsize_t frame, const std::vector<double>& values) const {
    // Selects the row in the file's space; in memory it is the whole of row_.
    const std::array<hsize_t, 2> from{frame, 0}, count{1, size_[1]};
    require(H5Sselect_hyperslab(space_, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr));
    require(H5Dwrite(set_, H5T_NATIVE_DOUBLE, row_, space_, H5P_DEFAULT, values.data()));
  }

 private:
  std::array<hsize_t, 2> size_;
  Handle space_, row_, set_;
};

/// Group `bodies`, by id.
void put_bodies(hid_t file, const RunFile& run) {
  const Group group(file, "bodies");
  std::vector<std::string> names;
  std::vector<double> mass, inertia;
  for (const RunFile::BodyRow& b : run.bodies()) {
    names.push_back(b.name);
    mass.push_back(b.mass);
    inertia.push_back(b.inertia);
  }
  group.put("name", names);
  group.put("mass", "kg", mass);
  group.put("inertia", "kg m^2", inertia);
}

/// Group `frames`: six arrays frames x bodies, and the times. Cost: reads every frame once.
void put_frames(hid_t file, const RunFile& run) {
  const Group group(file, "frames");
  const auto frames = static_cast<hsize_t>(run.frame_count()),
             bodies = static_cast<hsize_t>(run.bodies().size());
  const std::array<Rows, 6> rows{
      Rows(group, "x", "m", frames, bodies),       Rows(group, "y", "m", frames, bodies),
      Rows(group, "angle", "rad", frames, bodies), Rows(group, "vx", "m/s", frames, bodies),
      Rows(group, "vy", "m/s", frames, bodies),    Rows(group, "omega", "rad/s", frames, bodies)};
  std::vector<double> times;
  // One frame of each array: cleared and filled again, so that nothing grows but the times.
  std::array<std::vector<double>, 6> columns;
  run.each_frame(1, [&](const RunFile::Frame& f) {
    for (auto& c : columns) c.clear();
    for (const auto& [pose, twist] : f.states) {
      const double values[] = {pose.position.x(),  pose.position.y(),  pose.angle,
                               twist.velocity.x(), twist.velocity.y(), twist.omega};
      for (int i = 0; i < 6; ++i) columns[i].push_back(values[i]);
    }
    for (int i = 0; i < 6; ++i) rows[i].put(times.size(), columns[i]);
    times.push_back(f.t);
  });
  group.put("t", "s", times);
}

/// Group `events`, in the order of the file. All kinds are in one table; column `kind` has their words.
void put_events(hid_t file, const RunFile& run) {
  const Group group(file, "events");
  std::vector<double> t, x, y, nx, ny, closing, along, across, gap;
  std::vector<int> body, other, site;
  std::vector<std::string> kind;
  for (const Event& e : run.events()) {
    const Contact& c = e.contact;
    t.push_back(c.time);
    kind.emplace_back(to_string(e.kind));
    body.push_back(c.body), other.push_back(c.other_body), site.push_back(c.other_site);
    x.push_back(c.point.x()), y.push_back(c.point.y());
    nx.push_back(c.normal.x()), ny.push_back(c.normal.y());
    closing.push_back(c.closing_speed), gap.push_back(c.gap);
    along.push_back(e.impulse_n), across.push_back(e.impulse_t);
  }
  group.put("t", "s", t);
  group.put("kind", kind);
  group.put("body", body), group.put("other", other), group.put("site", site);
  group.put("x", "m", x), group.put("y", "m", y);
  group.put("normal_x", "1", nx), group.put("normal_y", "1", ny);
  group.put("closing_speed", "m/s", closing), group.put("gap", "m", gap);
  group.put("impulse_normal", "N s", along), group.put("impulse_tangential", "N s", across);
}

/// Group `contacts`, in the order of their ends.
void put_contacts(hid_t file, const RunFile& run) {
  const Group group(file, "contacts");
  std::vector<double> from, to, x, y, nx, ny, along, across;
  std::vector<int> body, other, site;
  std::vector<std::string> mode;
  for (const LastedContact& c : run.contacts()) {
    from.push_back(c.from), to.push_back(c.to);
    mode.emplace_back(to_string(c.mode));
    body.push_back(c.body), other.push_back(c.other_body), site.push_back(c.other_site);
    x.push_back(c.point.x()), y.push_back(c.point.y());
    nx.push_back(c.normal.x()), ny.push_back(c.normal.y());
    along.push_back(c.normal_force), across.push_back(c.tangential_force);
  }
  group.put("from", "s", from), group.put("to", "s", to);
  group.put("mode", mode);
  group.put("body", body), group.put("other", other), group.put("site", site);
  group.put("x", "m", x), group.put("y", "m", y);
  group.put("normal_x", "1", nx), group.put("normal_y", "1", ny);
  group.put("force_normal", "N", along), group.put("force_tangential", "N", across);
}

/// Group `knots`, in the order of the file.
void put_knots(hid_t file, const RunFile& run) {
  const Group group(file, "knots");
  std::vector<double> t;
  std::vector<int> body, events;
  std::array<std::vector<double>, 9> columns;
  for (const TimedKnot& k : run.knots()) {
    t.push_back(k.time);
    body.push_back(k.body), events.push_back(static_cast<int>(k.events));
    const double values[] = {k.pose.position.x(),   k.pose.position.y(),   k.pose.angle,
                             k.before.velocity.x(), k.before.velocity.y(), k.before.omega,
                             k.after.velocity.x(),  k.after.velocity.y(),  k.after.omega};
    for (int c = 0; c < 9; ++c) columns[c].push_back(values[c]);
  }
  group.put("t", "s", t);
  group.put("body", body), group.put("events_before", events);
  const char* const names[] = {"x",  "y",  "angle", "vx_before", "vy_before", "omega_before",
                               "vx", "vy", "omega"};
  const char* const units[] = {"m", "m", "rad", "m/s", "m/s", "rad/s", "m/s", "m/s", "rad/s"};
  for (int c = 0; c < 9; ++c) group.put(names[c], units[c], columns[c]);
}

}  // namespace

void write_hdf5(const std::filesystem::path& run_file, const std::filesystem::path& file) {
  RunFile run(run_file);
  run.hold();  // a run that goes on writes more rows meanwhile
  // What could not be written it would try again at the program's end, and crash.
  H5dont_atexit();
  // Else the library prints its own stack of errors.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what goes wrong is told below
  try {
    const Handle out(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    put_bodies(out, run);
    put_frames(out, run);
    put_events(out, run);
    put_contacts(out, run);
    put_knots(out, run);
    // Errors of writing come now, while they can be told; closing tells nobody.
    require(H5Fflush(out, H5F_SCOPE_GLOBAL));
  } catch (const IoError& e) {
    // Errors of reading the run already name their file and table.
    if (std::string(e.what()) != "HDF5 refuses") throw;
    throw IoError(fmt::format("{}: cannot be written as HDF5 (is the folder there, and room on the disk?)",
                              file.string()));
  }
}

#endif

}  // namespace brink
