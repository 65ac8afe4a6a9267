#pragma once
/// What a run came to over time: energy, momentum, collisions a second.

#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/view/page_numbers.h"

namespace brink {

class RunCurves {
 public:
  RunCurves(const World& world, const RunFile& run);

  const Vec2& gravity() const { return gravity_; }
  double end() const { return t_.empty() ? 0.0 : t_.back(); }  ///< of the last frame [s]
  void add(const RunFile::Frame& frame);
  /// @pre every frame has been added.
  void add(const Event& event);
  /// The columns, and what the page must know of them, as about["curves"].
  void put(PageNumbers& to, nlohmann::ordered_json& about) const;

 private:
  double of_springs(const RunFile::Frame& frame) const;
  double of_attraction(const RunFile::Frame& frame) const;

  const World* world_;
  Vec2 gravity_ = Vec2::Zero();
  std::vector<RunFile::Spring> springs_;
  std::vector<AttractForce> attractions_;
  std::vector<double> t_, kinetic_, of_gravity_, of_springs_, of_attraction_, total_, px_, py_, turning_,
      collisions_;
};

}  // namespace brink
