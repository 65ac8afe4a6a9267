/// The classic method with backing up (detector `depth`); declares itself approximate:
///
///   until the end
///     advance all bodies by one step and look
///     while something touches and approaches
///       halve the time since it did not, drawing again at each try, and back all bodies up to the first
///       touch
///       resolve what touches there; advance to the step's end and look again
///
/// What touches and parts again inside a step is missed.
#include <cmath>

#include "brink/scheduler/classic/classic_policy.h"
#include "brink/scheduler/classic/classic_rebound.h"

namespace brink {

namespace {

/// A step is halved this often: to its 65536th part.
constexpr int kHalvings = 16;
/// Backups in one step, and as many more for each body, beyond which what is left of the step is taken
/// without backing up and overlaps are pushed apart: bodies that come to rest touch again and again.
constexpr int kMostBackups = 8;

class ClassicBackup final : public ClassicPolicy {
 private:
  bool step(Kernel& kernel, double end) override {
    double clear = kernel.time();  // nothing touches and approaches here
    for (int backups = kMostBackups * (1 + kernel.body_count()); clear < end; --backups) {
      end = kernel.follow_motions_all_the_way(end);
      if (kernel.halt()) return false;
      kernel.advance_all(end);
      if (!any_approaches(sight().look(clear, end))) break;
      // With no backup left the touch is answered at the step's end, where overlaps are pushed apart too.
      const double touch = backups > 0 ? first_touch(kernel, clear, end) : end;
      if (kernel.halt()) {
        // as if this try had not been: who goes on from here goes on to the same end, with all backups
        kernel.back_up_all(clear);
        return false;
      }
      // a frame at the touch itself shows what comes of it
      if (!kernel.record_frames(std::nextafter(touch, 0.0))) return false;
      kernel.back_up_all(touch);
      const DepthSight seen = sight().look(clear, touch);
      if (!resolve_all(kernel, seen.contacts)) return false;
      if (backups <= 0) push_all_apart(kernel, seen.overlaps);
      clear = touch;
      if (!kernel.poll()) return false;
    }
    return kernel.record_frames(end) && kernel.poll();
  }

  /// The first time in (clear, touching] at which something touches and approaches, within kHalvings. On a halt no answer:
  /// pictures of many bodies take half a second each.
  double first_touch(Kernel& kernel, double clear, double touching) {
    // Every try is seen against this one moment before, in which nothing approached: on which side of a
    // wire a particle was must not depend on the halving.
    const double from = clear;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (clear + touching);
      if (!(middle > clear && middle < touching) || !kernel.poll()) break;
      (any_approaches(sight().look(from, middle)) ? touching : clear) = middle;
    }
    return touching;
  }
};

}  // namespace

std::unique_ptr<Policy> make_classic_backup() { return std::make_unique<ClassicBackup>(); }

}  // namespace brink
