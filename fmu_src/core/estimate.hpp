/// How far a run is from the truth: a second run beside it, the shadow, with two thirds of its steps.
///
/// A method of order p with steps h errs by about C h^p, a shadow with steps r h by C (r h)^p, so that what the two differ by, divided by
/// 1 - r^p, is the error of the run. A finer shadow, for a coarser one is unstable where stability sets the step, and says nothing where
/// its vibrations are out of phase altogether. Equal steps become the next that divide the communication step. Where the run's steps
/// change with what happens, the shadow goes by the same rules to r times the steps: with equal ones it would pass over what the run has
/// taken small ones for. Sums of local error estimates say nothing: errors of
/// vibrations cancel, those of rotations add up.
///
/// Implicit steps that are long beside a vibration damp it away, in run and shadow alike, and no difference shows it. So what sets
/// vibrations off is looked at (vibration.hpp): the largest since is followed, once as the body's own damping leaves it, once as the steps
/// have damped it besides, and the estimate is at least the difference of the two.
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
  /// What has been learnt since the start.
  struct Tally {
    double time = 0, ratio_time = 0;  ///< time followed, and the integral of |r^p - 1| over it [s]
    double value = 0;                 ///< [m]
    Vibration vibration{};            ///< the largest that implicit steps have met, as the body alone damps it
    Points slopes;                    ///< of the outside forces at the end of the last communication step [N/s]
    double kept = 0;                  ///< share of it that these steps have left
    double damped_away = 0;           ///< amplitude of what they have not [m]
    Count steps = 0;                  ///< that the run had taken
    bool lost = false;                ///< the shadow could not follow: no digits

    template <class Self, class Fields>
    static auto visit(Self& s, Fields&& fields) {
      return fields(s.time, s.ratio_time, s.value, s.vibration, s.slopes, s.kept, s.damped_away, s.steps, s.lost);
    }
  };
  /// What following changes, apart from the settings; part of every snapshot.
  struct Memory {
    Run shadow;
    Tally tally;

    template <class Self, class Fields>
    static auto visit(Self& s, Fields&& fields) {
      return fields(s.shadow, s.tally);
    }
  };

  explicit ErrorEstimate(const Definition& definition);
  /// Starts at the initial state of the body at time t0.
  void initialize(const SoftBody& body, double t0);
  /// Follows the body, which has just done a communication step of length H.
  void follow(const SoftBody& body, double H);
  /// Estimated error of the control points' positions: the largest over all points [m].
  double value() const { return tally_.value; }

  Memory memory() const { return {shadow_.run(), tally_}; }
  /// Continues from a snapshot; `settings` are those of the body.
  void restore(const Memory& memory, const Settings& settings, double start_time);

 private:
  double choose_steps(const SoftBody& body, double H, Count taken);
  double follow_slopes(double H);
  void follow_vibration(const SoftBody& body, double H, Count taken);
  bool out_of_phase() const;
  double lost_vibration(const SoftBody& body) const;
  SoftBody shadow_;
  Tally tally_;
  Points change_, force_;  ///< scratch
};
static_assert(visits_every_field<ErrorEstimate::Tally> && visits_every_field<ErrorEstimate::Memory>);

}  // namespace softffd
