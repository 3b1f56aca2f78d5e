/// Estimates the error of a run by a second run beside it, the shadow, with steps of two thirds the size.
///
/// A method of order p with steps h errs by about C h^p, a shadow with steps r h by C (r h)^p. Divided by 1 - r^p, the difference of the
/// two is therefore the error of the run. The shadow is finer, because a coarser one is unstable where stability sets the step, and says
/// nothing where its vibrations are out of phase altogether. Equal steps of the run become the next smaller ones that divide the
/// communication step. Where the run's steps change with events, the shadow follows the same rules, with r times the steps: with equal
/// steps it would pass over the events for which the run has taken small ones. Sums of local error estimates say nothing: errors of
/// vibrations cancel, errors of rotations add up.
///
/// Implicit steps that are long compared with a vibration damp it away, in run and shadow alike, so that no difference shows it.
/// Therefore the excitation of vibrations is examined (vibration.hpp). The largest vibration so far is followed twice, once with the
/// body's own damping alone and once with the damping by the steps as well. The estimate is at least the difference of the two.
///
/// Steps given by the user may be too long for the body's vibrations. The phase is then lost, and the two runs may agree by chance.
/// Without damping, therefore, an estimate as large as the vibrations does not fall again, and it is not below the vibrations that the
/// method has damped away.
///
/// In each communication step the shadow uses the method that the run has used. It changes nothing about the run.
#pragma once
#include "soft_body.hpp"

namespace softffd {

class ErrorEstimate {
 public:
  /// Results accumulated since the start.
  struct Tally {
    double time = 0, ratio_time = 0;  ///< time followed, and the integral of |r^p - 1| over it [s]
    double value = 0;                 ///< the estimate [m]
    Vibration vibration{};            ///< largest that implicit steps have met, with the body's own damping alone
    Points slopes;                    ///< rates of the outside forces at the end of the last communication step [N/s]
    double kept = 0;                  ///< fraction of that vibration that the implicit steps have left [1]
    double damped_away = 0;           ///< amplitude that the implicit steps have damped away [m]
    Count steps = 0;                  ///< number that the run had taken
    bool lost = false;                ///< the shadow could not follow: no digit is known to be right

    template <class Self, class Fields>
    static auto visit(Self& s, Fields&& fields) {
      return fields(s.time, s.ratio_time, s.value, s.vibration, s.slopes, s.kept, s.damped_away, s.steps, s.lost);
    }
  };
  /// What `follow` changes, apart from the settings; part of every snapshot.
  struct Memory {
    Run shadow;
    Tally tally;

    template <class Self, class Fields>
    static auto visit(Self& s, Fields&& fields) {
      return fields(s.shadow, s.tally);
    }
  };

  explicit ErrorEstimate(const Definition& definition);
  /// Starts the shadow at the initial state of the body at time t0 [s].
  void initialize(const SoftBody& body, double t0);
  /// Follows the body, which has just done a communication step of length H [s].
  void follow(const SoftBody& body, double H);
  /// Returns the estimated error of the control points' positions, the largest over all points [m].
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
