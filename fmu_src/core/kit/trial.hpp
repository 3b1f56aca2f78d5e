/// A snapshot of a Run, or of its Path alone, to try what follows: goes back to it by itself unless it is kept. The buffer is the caller's,
/// so that nothing is allocated, and holds the snapshot until the next trial.
#pragma once
#include "model/visit.hpp"

namespace softffd {

template <class Part>
class [[nodiscard]] Trial {
 public:
  Trial(Part& part, Part& buffer) : part_(part), before_(buffer) { assign(before_, part_); }
  ~Trial() {
    if (open_) back();
  }
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  /// What follows stays.
  void keep() { open_ = false; }
  /// To try once more.
  void back() { assign(part_, before_); }
  const Part& before() const { return before_; }

 private:
  Part &part_, &before_;
  bool open_ = true;
};

}  // namespace softffd
