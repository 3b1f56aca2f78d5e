/// What a call may still do: one budget for all of a communication step, its trials and retries among them. Counted, never timed, so that
/// the same call ends alike on every machine.
#pragma once
#include <limits>

namespace softffd {

/// Work in evaluations of the body's spring forces.
class Budget {
 public:
  void begin(double most) {
    left_ = most;
    kept_back_ = 0;
  }
  void spend(double work) { left_ -= work; }
  double left() const { return left_ - kept_back_; }
  bool spent() const { return left() < 0; }
  /// False for what is not a number too.
  bool covers(double work) const { return work <= left(); }

  /// A part that is not there while this lives, or until it is released.
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
