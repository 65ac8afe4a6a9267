#pragma once
/// From the tables of a scene file to a Scene: one builder for each part. Internal to the scene reader.

#include <map>
#include <memory>
#include <optional>

#include "brink/scenes/scene/landing.h"
#include "brink/scenes/scene/scatter.h"
#include "brink/scenes/scene/tables.h"

namespace brink {

/// Bodies and sites that one scene may have.
inline constexpr int kMostCopies = 1'000'000;

/// A built shape, shared by everything that asks for the same one.
struct BuiltShape {
  std::shared_ptr<const Outline> outline;
  Measure measure;            ///< in the outline's frame
  Vec2 shift = Vec2::Zero();  ///< of the outline's origin, in the frame of the file's coordinates [m]
};

/// Builds shapes, each distinct one once.
class ShapeBuilder {
 public:
  ShapeBuilder(double curve_tolerance, FaultList& faults)
      : curve_tolerance_(curve_tolerance), faults_(faults) {}

  /// The outline of `thing`; empty after a fault. A body's is about its centre of mass.
  std::optional<BuiltShape> build(const ThingTable& thing, const std::string& name, bool body);
  /// Achieved deviations of fitted curves, for people.
  std::vector<std::string> take_notes() { return std::move(notes_); }

 private:
  bool fits(const ThingTable& thing, const ShapeSpec& spec, bool body);
  std::optional<BuiltShape> make(const ThingTable& thing, const ShapeSpec& spec, const ShapeContext& context,
                                 bool about_centre);

  double curve_tolerance_;
  FaultList& faults_;
  std::map<std::string, BuiltShape> built_;
  std::vector<std::string> notes_;
};

using PrescribedPath = decltype(FixedSite::motion);

/// Everything of one file entry that is the same for its copies, and the copies' poses.
struct PlannedThing {
  const ThingTable* table = nullptr;
  std::string name;
  BuiltShape shape;
  int material = 0;
  Body body;                      ///< bodies: all but name and state
  PrescribedPath motion;          ///< sites
  Pose pose;                      ///< of the outline's frame, before copying
  std::vector<BodyState> copies;  ///< one, or one a copy; twists are zero for sites
  std::size_t ordinal = 0;        ///< place in the file, for its random stream
};

/// Faults where keys of one entry say the same thing twice, or have no meaning beside each other.
void check_keys(const ThingTable& table, FaultList& faults);

/// How many copies an entry asks for, and by which key.
struct CopyCount {
  std::int64_t count = 1;
  Where where;
  bool copied = false;  ///< they are called NAME[k]
};
CopyCount copies_of(const ThingTable& table);

/// NAME[k] as NAME and k; any other name as it is.
std::pair<std::string, std::optional<std::size_t>> copy_named(const std::string& name);

/// Which way is down for an entry: its touching_direction, else along gravity; nothing where there is neither.
std::optional<Vec2> down_of(const ThingTable& table, const Vec2& gravity);

/// What the places of things that touch depend on, beside the things themselves.
struct PlaceRules {
  Vec2 gravity = Vec2::Zero();  ///< [m/s^2]
  Periods periods;
  double thin = 0.0;  ///< gap of corners that stand on wires without thickness [m]
};

/// Where the copies of a thing stand that is put where it is told to be, as a function of the position of the
/// first (of rows: of the middle of the lowest). @pre no scatter, no pile; the thing outlives the function.
Copies standing_poses(const PlannedThing& thing, const PlaceRules& rules);

/// Puts bodies on what their key `touching` names, in the order in which they depend on each other, and fills
/// their copies. @pre everything else that stands where it is told is placed; after a fault nothing is, and names and
/// circles are told alone.
void put_on_others(std::vector<PlannedThing>& sites, std::vector<PlannedThing>& bodies,
                   const PlaceRules& rules, FaultList& faults);

/// The state in which every copy of a thing starts, but for its place.
BodyState start_of(const PlannedThing& thing);

/// A placed copy where it stands at t = 0, which the formulas of a site's motion may move it to.
Obstacle at_start(const PlannedThing& thing, const BodyState& copy);

/// Places the copies of things: those that stand where they are told, or on others, and scatters without
/// overlaps.
class Placer {
 public:
  Placer(std::uint64_t seed, const PlaceRules& rules, FaultList& faults)
      : seed_(seed), rules_(rules), faults_(faults) {}
  /// Fills PlannedThing::copies of everything: first what stands where it is told, then what is put on
  /// others, then scatters and piles in file order, sites before bodies.
  void place(std::vector<PlannedThing>& sites, std::vector<PlannedThing>& bodies);

 private:
  bool counted(const PlannedThing& thing);
  void stand(PlannedThing& thing);
  void scatter(PlannedThing& thing, const std::vector<Obstacle>& obstacles);
  void pile(PlannedThing& thing, const std::vector<Obstacle>& obstacles);

  std::uint64_t seed_;
  PlaceRules rules_;
  FaultList& faults_;
  std::int64_t total_ = 0;
};

/// Names of bodies as forces may use them.
class BodyNames {
 public:
  /// The next `count` bodies. `copied`: they are called NAME[k].
  void add(const std::string& name, int count, bool copied);
  int count() const { return count_; }
  /// Every body called `name`, or every copy of it; a fault and empty if there is none.
  std::vector<int> find(const std::string& name, const Where& where, FaultList& faults) const;
  /// Exactly one body; a fault and -1 otherwise.
  int find_one(const std::string& name, const Where& where, FaultList& faults) const;

 private:
  struct Entry {
    int first = 0, count = 1;
    bool copied = false;
  };
  std::map<std::string, Entry> entries_;
  std::vector<std::string> words_;
  int count_ = 0;
};

/// Turns force tables into World::forces. `origins`: where the file's frame of each body lies in its
/// outline's frame. `placed` false: bodies are not where they start, and what depends on that is not checked.
void build_forces(const std::vector<ForceTable>& tables, const BodyNames& names,
                  const std::vector<Vec2>& origins, bool placed, World& world, FaultList& faults);

/// The motion of a site.
PrescribedPath build_motion(const Given<MotionTable>& table, const std::string& site, double duration,
                            FaultList& faults);

/// Reads the classic text data files that shapes name, from `folder`: each becomes its thing's shape, and
/// gives mass, position, angle and velocities where the thing itself says nothing. Faults in a file name that
/// file. The files are added to `files`, each once.
void take_sample_files(FileTable& file, const std::filesystem::path& folder,
                       std::vector<std::filesystem::path>& files, FaultList& faults);

/// The whole scene, or faults.
Scene build_scene(const FileTable& file, FaultList& faults);

}  // namespace brink
