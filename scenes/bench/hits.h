#pragma once
/// Times of collisions: what errors and missed contacts are told by.

#include <vector>

#include "brink/scheduler/run/recorder.h"

namespace brink::bench {

class Hits final : public Recorder {
 public:
  void event(const Event& e) override {
    if (e.kind == EventKind::collision) times.push_back(e.contact.time);
  }
  std::vector<double> times;  ///< [s], in order
};

}  // namespace brink::bench
