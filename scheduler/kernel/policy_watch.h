#pragma once
/// Holds a policy to the contacts that it has been told of.

#include <memory>
#include <string>
#include <vector>

#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/speculation.h"

namespace brink {

/// Remembers every contact that a search finds until one of its bodies is resolved. Costs about as much as an
/// agenda; off for Brink's own policies, and nothing then.
class PolicyWatch {
 public:
  PolicyWatch(std::string policy, const ContactSearch& search, const Speculation& speculation)
      : policy_(std::move(policy)), search_(&search), speculation_(&speculation) {}

  void begin() {
    if (!known_) known_ = std::make_unique<Agenda>();
  }
  bool is_on() const { return known_ != nullptr; }
  void found(const Certificate& c) {
    if (known_ && c.kind == Certificate::Kind::contact) known_->insert(c);
  }
  void forget_all() {
    if (known_) known_->clear();
  }
  /// @throws BadInput, naming the pair and both times, if a contact that is known and still holds comes
  /// before t.
  void going_to(double t) {
    if (known_) look_before(t);
  }
  /// The same at the end of a run. @throws BadInput also if the policy came back at `now`, before it.
  void returned(double now, double until);

 private:
  void look_before(double t);
  bool alive(const Certificate& c) const;

  std::string policy_;
  const ContactSearch* search_;
  const Speculation* speculation_;
  std::unique_ptr<Agenda> known_;
};

/// True if neither body has been resolved since the certificate was issued (what is only resolved ahead of
/// time does not count).
bool is_fresh(const Speculation& speculation, const Certificate& c);

}  // namespace brink
