/// How far a run is from the truth: a second run beside it, the shadow, with other steps.
///
/// A method of order p with steps h errs by about C h^p. A shadow with steps r h, r = 2/3 or what divides the communication step, errs by
/// C (r h)^p, so that what the two differ by, divided by 1 - r^p, is the error of the run. A finer shadow, for a coarser one is unstable
/// where stability sets the step, and says nothing where its vibrations are out of phase altogether. Methods with error control run the
/// shadow with ten times the tolerance, which multiplies their error by about 6, unless stability or the communication points set their
/// steps. Sums of local error estimates say nothing: errors of vibrations cancel, those of rotations add up.
///
/// Given steps may be too long for the body's vibrations: the phase is lost, and where the two runs meet by chance they agree. An estimate
/// as large as the vibrations does not fall again, therefore, without damping; and it is not below those that the method has damped away.
///
/// The shadow takes the method that the run took, communication step by communication step, and changes nothing about the run.
#pragma once
#include "soft_body.hpp"

namespace softffd {

class ErrorEstimate {
 public:
  /// What following changes, apart from the settings; part of every snapshot.
  struct Memory {
    Progress shadow;
    double time = 0, ratio_time = 0;  ///< time followed, and the integral of |r^p - 1| over it [s]
    double value = 0;                 ///< [m]
    bool lost = false;                ///< the shadow could not follow: no digits
  };

  explicit ErrorEstimate(const Definition& definition);
  /// Starts at the initial state of the body at time t0.
  void initialize(const SoftBody& body, double t0);
  /// Follows the body, which has just done a communication step of length H.
  void follow(const SoftBody& body, double H);
  /// Estimated error of the control points' positions: the largest over all points [m].
  double value() const { return value_; }

  Memory memory() const { return {shadow_.progress(), time_, ratio_time_, value_, lost_}; }
  /// Continues from a snapshot; `settings` are those of the body.
  void restore(const Memory& memory, const Settings& settings, double start_time);

 private:
  double choose_steps(const SoftBody& body, double H);
  bool out_of_phase() const;
  double lost_vibration(const SoftBody& body) const;
  void take_settings(const Settings& settings);
  SoftBody shadow_;
  double time_ = 0, ratio_time_ = 0, value_ = 0;
  bool lost_ = false;
};

}  // namespace softffd
