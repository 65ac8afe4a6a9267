#pragma once
/// What a search for first contact is asked about: a shape on its own motion.

#include <memory>
#include <utility>

#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/first_contact.h"

namespace brink::testing {

struct Flier {
  std::unique_ptr<SiteIndex> index;
  Motion motion;

  Flier(const Shape& shape, Motion flight)
      : index(make_brute_force_index(std::make_shared<const Outline>(shape.outline))),
        motion(std::move(flight)) {}
  Mover mover() const { return {index.get(), &motion, 0.0}; }
};

}  // namespace brink::testing
