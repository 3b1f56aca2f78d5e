/// Control points that meet planes in implicit steps: contact_set.hpp tells which points touch, linear_contact.hpp finds their forces.
#pragma once
#include "contact/implicit/implicit_touches.hpp"
#include "contact/implicit/linear_contact.hpp"

namespace softffd {

class PointTouches final : public ImplicitTouches {
 public:
  PointTouches(const Lattice& lattice, int planes);

  void open(const Step& step) override;
  const HalfSpace& plane(int q) const override { return contacts_.plane(q); }
  Vec3 material_velocity(int q, const Vec3& x) const override { return contacts_.material_velocity(q, x); }
  bool possible(const Vec3& x, double slack) override { return contacts_.possible(x, slack); }
  bool pins_pass() const override { return false; }
  /// Guesses as touches the points on a plane that the other forces press against it, with the loads of equilibrium, and the points that
  /// would end behind a plane.
  void guess(const Step& step, const Points& force, const Points& x) override;
  bool find_friction(const Step& step, const Points& u, bool first, double largest_stiffness, double slight) override;
  void refresh() override { linear_.refresh(); }
  void keep(double slight) override { linear_.keep(slight); }
  StepStatus solve(const StepProblem& problem, bool cautious) override;
  StepSolution& solution() override { return linear_; }
  const StepMatrix& matrix() const override { return linear_.matrix(); }
  void add_forces(Points& f) const override;
  double largest_load() const override { return contacts_.largest_load(); }
  void keep_in_front(const Body& body, Points& x) const override;
  /// If a point has several touches, the first gets what the others leave of the reaction in the linear equations.
  void find_reactions(std::vector<Reaction>& reactions) const override;
  Vec3 value(const Reaction& reaction, const Points& values) const override { return row(values, reaction.at); }
  void hold(State& state) const override { contacts_.hold(state.holds); }

 private:
  ContactSet contacts_;
  LinearContact linear_;
  Points free_;  ///< displacements in the step without forces [m]
};

}  // namespace softffd
