#pragma once
#include <brink/scheduler/policies/order.h>
#include <brink/scheduler/policies/policy.h>

/// Takes all bodies from contact to contact, and looks no further than it must: nobody is ever backed up.
class EarliestFirst final : public brink::Policy {
 public:
  void run(brink::Kernel& kernel, double until) override {
    if (!kernel.pause_point() || !kernel.extend_motions(until)) return;
    brink::Agenda agenda;
    const auto look_at = [&](const std::vector<brink::PairKey>& pairs) {
      for (const brink::PairKey& pair : pairs)
        if (const auto contact = kernel.search(pair, kernel.time(), until)) agenda.insert(*contact);
    };
    look_at(kernel.near_pairs(kernel.time(), until));
    std::vector<int> changed;
    while (const auto next = brink::take_earliest(kernel, agenda)) {
      kernel.record_frames(next->time);
      kernel.advance_all(next->time);
      if (next->kind == brink::Certificate::Kind::undecided) return kernel.give_up(*next);
      changed.clear();
      if (!kernel.resolve(next->pair, next->contact, changed) || !kernel.extend_motions(until)) return;
      for (const int body : changed) look_at(kernel.near_pairs_of(body, kernel.time(), until));
    }
    kernel.record_frames(until);
    kernel.advance_all(until);
  }
};
