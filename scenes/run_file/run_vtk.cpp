#include "brink/scenes/run_file/run_vtk.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/error.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scheduler/kernel/site_motion.h"

#ifdef BRINK_VTK
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>
#endif

namespace brink {

#ifndef BRINK_VTK

void require_vtk() {
  throw BadInput("--vtk: this Brink was built without VTK (Debian: libvtk9-dev); allowed: --csv, --hdf5");
}

void write_vtk(const std::filesystem::path&, const std::filesystem::path&) { require_vtk(); }

#else

void require_vtk() {}

namespace {

namespace fs = std::filesystem;

constexpr double kTurn = 2.0 * std::numbers::pi;
/// An arc is off from its chords by a thousandth of its radius.
/// A chord over the angle a is off by r (1 - cos(a / 2)): 1e-3 r for this one.
const double kMostTurn = 2.0 * std::acos(1.0 - 1e-3);

/// As XML (.vtp). @throws IoError where VTK could not write the file.
void write(vtkPolyData* data, const fs::path& file) {
  const vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(file.c_str());
  writer->SetInputData(data);
  if (writer->Write() == 0) throw_not_written(file);
}

/// Numbers that VTK keeps by name: of cells, or of points.
/// Values are added in the order of the cells or points that they belong to.
template <class Array>
class Column {
 public:
  Column(vtkDataSetAttributes* of, const char* name, int components = 1) {
    array_->SetName(name);
    array_->SetNumberOfComponents(components);
    // VTK counts references: the data keeps the array alive, whoever goes first.
    of->AddArray(array_.GetPointer());
  }
  template <class... Values>
  void add(Values... values) {
    for (const auto v : {values...}) array_->InsertNextValue(v);
  }

 private:
  vtkNew<Array> array_;
};

/// The outlines of one frame.
/// Every site of an outline is a cell of its own, a polyline in the world; columns have one entry a
/// cell.
class Picture {
 public:
  Picture() {
    // Else VTK keeps coordinates in single precision, and what all but touches would seem to overlap.
    points_->SetDataTypeToDouble();
    data_->SetPoints(points_.GetPointer());
    data_->SetLines(lines_.GetPointer());
  }

  /// All sites of the outline at the pose of `state`. One of `body` and `site` is an id, the other -1.
  void add(const Outline& outline, const BodyState& state, int body, int site) {
    const Frame frame(state.pose);
    for (const Site& s : outline.sites) {
      // points_of() leaves the ids of this cell in ids_.
      lines_->InsertNextCell(points_of(s, frame));
      for (const vtkIdType id : ids_) lines_->InsertCellPoint(id);
      body_.add(body);
      site_.add(site);
      // A disc is drawn as its own circle, so nothing is left to add around it.
      thickness_.add(s.kind == SiteKind::point ? 0.0 : s.radius);
      vx_.add(state.twist.velocity.x());
      vy_.add(state.twist.velocity.y());
      omega_.add(state.twist.omega);
    }
  }
  void write_to(const fs::path& file) { write(data_.GetPointer(), file); }

 private:
  /// Ids of the points along a piece of an outline; a disc is its circle.
  int points_of(const Site& s, const Frame& frame) {
    ids_.clear();
    if (s.kind == SiteKind::segment) {
      add_point(frame.to_world(s.a));
      add_point(frame.to_world(s.b));
    } else {
      const bool disc = s.kind == SiteKind::point;
      // A disc turns by a whole circle from its right end; an arc from `a` by its sweep.
      const Vec2 center = disc ? s.a : s.center, from = disc ? Vec2(s.radius, 0.0) : Vec2(s.a - s.center);
      const double sweep = disc ? kTurn : s.sweep;
      // So many chords, each over kMostTurn at most; both ends are points, and a circle closes on its
      // first.
      const int count = 1 + static_cast<int>(std::ceil(std::abs(sweep) / kMostTurn));
      for (int k = 0; k <= count; ++k) {
        const double angle = sweep * k / count, c = std::cos(angle), n = std::sin(angle);
        add_point(frame.to_world(center + Vec2(c * from.x() - n * from.y(), n * from.x() + c * from.y())));
      }
    }
    return static_cast<int>(ids_.size());
  }
  void add_point(const Vec2& p) { ids_.push_back(points_->InsertNextPoint(p.x(), p.y(), 0.0)); }

  // The columns stand behind data_, as they are added to it when they are made.
  std::vector<vtkIdType> ids_;
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> lines_;
  Column<vtkIntArray> body_{data_->GetCellData(), "body"}, site_{data_->GetCellData(), "site"};
  Column<vtkDoubleArray> thickness_{data_->GetCellData(), "thickness"}, vx_{data_->GetCellData(), "vx"},
      vy_{data_->GetCellData(), "vy"}, omega_{data_->GetCellData(), "omega"};
};

/// frame_000000.vtp ... and their list run.pvd. Cost: one frame in memory at a time; a file a frame.
void write_frames(const RunFile& run, const fs::path& folder) {
  const std::vector<RunFile::BodyRow> bodies = run.bodies();
  const std::vector<FixedSite> sites = run.sites();
  const fs::path index = folder / "run.pvd";
  std::ofstream out(index, std::ios::binary);
  // The list of ParaView: a time and a file a line.
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  int frame = 0;
  run.each_frame(1, [&](const RunFile::Frame& f) {
    Picture picture;
    for (const RunFile::BodyRow& b : bodies)
      picture.add(b.outline, f.states[static_cast<std::size_t>(b.id)], b.id, -1);
    for (std::size_t s = 0; s < sites.size(); ++s)
      // Of a site that moves the pose alone: its twist is shown as 0.
      picture.add(*sites[s].outline, BodyState{told_pose(sites[s], f.t), {}}, -1, static_cast<int>(s));
    const std::string name = fmt::format("frame_{:06}.vtp", frame++);
    picture.write_to(folder / name);
    out << fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", f.t, name);
  });
  out << "</Collection>\n</VTKFile>\n";
  out.flush();
  if (!out) throw_not_written(index);
}

/// events.vtp: a vertex an event, at the contact's place in the world.
void write_events(const RunFile& run, const fs::path& folder) {
  const vtkNew<vtkPolyData> data;
  const vtkNew<vtkPoints> points;
  const vtkNew<vtkCellArray> vertices;
  points->SetDataTypeToDouble();
  data->SetPoints(points.GetPointer());
  data->SetVerts(vertices.GetPointer());
  vtkPointData* of = data->GetPointData();
  Column<vtkDoubleArray> t(of, "t"), normal(of, "normal", 3), push(of, "impulse_normal"),
      rub(of, "impulse_tangential"), closing(of, "closing_speed");
  Column<vtkIntArray> kind(of, "kind"), body(of, "body"), other(of, "other"), site(of, "site");
  for (const Event& e : run.events()) {
    const Contact& c = e.contact;
    const vtkIdType id = points->InsertNextPoint(c.point.x(), c.point.y(), 0.0);
    vertices->InsertNextCell(1, &id);
    t.add(c.time);
    kind.add(static_cast<int>(e.kind));
    body.add(c.body);
    other.add(c.other_body);
    site.add(c.other_site);
    normal.add(c.normal.x(), c.normal.y(), 0.0);
    push.add(e.impulse_n);
    rub.add(e.impulse_t);
    closing.add(c.closing_speed);
  }
  write(data.GetPointer(), folder / "events.vtp");
}

}  // namespace

void write_vtk(const fs::path& run_file, const fs::path& folder) {
  RunFile run(run_file);
  run.hold();  // a run that goes on writes more rows meanwhile
  write_frames(run, folder);
  write_events(run, folder);
}

#endif

}  // namespace brink
