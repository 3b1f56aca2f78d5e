/// What work a call may still do: one budget for a whole communication step, including its trial runs and retries. Work is counted, never
/// timed, so that the same call gives the same result on every machine.
#pragma once
#include <limits>

namespace softffd {

/// Counts work in evaluations of the body's spring forces.
class Budget {
 public:
  void begin(double most) {
    left_ = most;
    kept_back_ = 0;
  }
  void spend(double work) { left_ -= work; }
  double left() const { return left_ - kept_back_; }
  bool spent() const { return left() < 0; }
  /// True if the budget suffices for this work; false if the work is NaN.
  bool covers(double work) const { return work <= left(); }

  /// Holds back a part of the budget until it is released or destroyed.
  class [[nodiscard]] Reserve {
   public:
    Reserve(Budget& budget, double work) : budget_(budget), work_(work) { budget_.kept_back_ += work_; }
    ~Reserve() { release(); }
    Reserve(const Reserve&) = delete;
    Reserve& operator=(const Reserve&) = delete;
    void release() {
      budget_.kept_back_ -= work_;
      work_ = 0;
    }

   private:
    Budget& budget_;
    double work_;
  };

 private:
  double left_ = std::numeric_limits<double>::infinity(), kept_back_ = 0;
};

}  // namespace softffd
