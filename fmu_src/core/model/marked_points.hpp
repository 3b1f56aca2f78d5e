/// Points that are copied more often than they change: each communication step keeps a copy of its start, most of which has not changed.
///
///      x.change() = ...     a mark that no other points ever had
///      kept = x             copies the numbers and the mark; where the mark is there already, the numbers are too, and nothing is read
#pragma once
#include <algorithm>
#include <atomic>
#include <utility>

#include "model/types.hpp"

namespace softffd {

class MarkedPoints {
 public:
  MarkedPoints() = default;
  MarkedPoints(const MarkedPoints&) = default;
  MarkedPoints(MarkedPoints&& other) noexcept { swap(other); }
  MarkedPoints& operator=(MarkedPoints&& other) noexcept {
    swap(other);
    return *this;
  }
  MarkedPoints& operator=(const MarkedPoints& other) {
    copy(other.points_, other.mark_);
    return *this;
  }

  const Points& operator*() const { return points_; }
  const Points* operator->() const { return &points_; }
  /// Returns the points to write to at once, with a new mark: a later change needs another call.
  Points& change() {
    mark_ = new_mark();
    return points_;
  }
  void swap(MarkedPoints& other) noexcept {
    points_.swap(other.points_);
    std::swap(mark_, other.mark_);
  }
  /// Copies points that another owner has marked.
  void copy(const Points& points, Count mark) {
    if (mark == mark_) return;
    points_.resizeLike(points);
    std::copy_n(points.data(), points.size(), points_.data());
    mark_ = mark;
  }
  Count mark() const { return mark_; }
  static Count new_mark() {
    static std::atomic<Count> last{0};
    return last.fetch_add(1, std::memory_order_relaxed) + 1;
  }

 private:
  Points points_;
  Count mark_ = 0;  ///< 0: no mark
};

}  // namespace softffd
