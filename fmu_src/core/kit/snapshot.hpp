/// A snapshot of a Run, or of its PhysicalState alone, taken before a trial. Its destructor restores it unless it was committed. The
/// caller owns the buffer, so that nothing is allocated; the buffer holds the snapshot until the next one.
#pragma once
#include "model/visit.hpp"

namespace softffd {

template <class Part>
class [[nodiscard]] Snapshot {
 public:
  Snapshot(Part& part, Part& buffer) : part_(part), before_(buffer) { assign(before_, part_); }
  ~Snapshot() {
    if (open_) rollback();
  }
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  /// Keeps the changes: the destructor does not restore the snapshot.
  void commit() { open_ = false; }
  /// Restores the snapshot, for another trial.
  void rollback() { assign(part_, before_); }
  const Part& before() const { return before_; }

 private:
  Part &part_, &before_;
  bool open_ = true;
};

}  // namespace softffd
