#include "contact/implicit/linear_contact.hpp"

#include <algorithm>

namespace softffd {

namespace {

constexpr int most_guesses = 14;
/// Accuracy of the responses from which the loads are combined [1]: a hundred times better than that of the loads.
constexpr double of_products = 1e-6;
/// From this round on, touches end one by one and friction is cautious: slower, but not in circles.
constexpr int careful_round = 6;

void project(const ContactSet& contacts, Points& u) {
  for (int p : contacts.points()) set_row(u, p, contacts.projector(p) * row(u, p));
}

}  // namespace

LinearContact::LinearContact(const Lattice& lattice) : matrix_(lattice), gmres_(3 * lattice.points()), lack_(3 * lattice.points()) {
  for (Points* points : {&change, &reaction, &prescribed_, &friction_, &response_, &made_, &moved_}) points->setZero(lattice.points(), 3);
}

bool LinearContact::solve(const StepProblem& problem, ContactSet& contacts, bool cautious) {
  fresh = settled = false;
  if (kept_ && !contacts.take_friction_stiffness(slight_)) stale_ = true;
  kept_ = false;
  if (stale_) {
    matrix_.linearise(problem.x, problem.diagonal, problem.h);
    contacts.fix_friction_stiffness(cautious);
  }
  for (int round = 0; round < most_guesses; ++round) {
    if (!solve_with_touches(problem, contacts, cautious)) return false;
    const double pull = problem.load_slack * std::max(problem.force_scale, contacts.largest_load());
    bool changed = contacts.release_pulling(pull, round < careful_round);
    moved_ = problem.x + change;
    if (contacts.add_violated(moved_, problem.slack)) {
      contacts.find_new_friction(problem.x0, problem.u, problem.h);
      changed = true;
    }
    if (!changed && !cautious && round < careful_round) {
      contacts.scale_friction(problem.body.length, problem.stiffness_scale);
      changed = contacts.stop_reversals(change);
    }
    settled = !changed;
    if (settled) return true;
    cautious = cautious || round >= careful_round;
    contacts.fix_friction_stiffness(cautious);
    stale_ = true;
  }
  return true;
}

bool LinearContact::solve_with_touches(const StepProblem& problem, ContactSet& contacts, bool cautious) {
  for (;;) {
    if (stale_) {
      contacts.constrain(matrix_.assemble(problem.body));
      matrix_.factor(problem);
      fresh = true;
      stale_ = false;
    }
    solve_free_part(problem, contacts);
    if (std::isfinite(kernels::largest(change.size(), change.data()))) break;
    if (!matrix_.soften()) return false;
    stale_ = true;
  }
  matrix_.forces_of(problem, change, reaction);
  reaction -= problem.residual;
  contacts.find_loads(reaction, change);
  if (!cautious) couple_loads(problem, contacts);
  return true;
}

void LinearContact::solve_free_part(const StepProblem& problem, const ContactSet& contacts) {
  change = problem.residual;
  if (contacts.prescribe(problem.x, prescribed_)) {
    matrix_.forces_of(problem, prescribed_, made_);
    change -= made_;
  }
  for (int p : contacts.points()) {
    Vec3 force = row(change, p);
    for (int i = 0; i < contacts.touches(p); ++i) force += ContactSet::linear_friction(contacts.touch(p, i), row(prescribed_, p));
    set_row(change, p, force);
  }
  project(contacts, change);
  problem.body.hold_prescribed(change);
  matrix_.solve_residual(problem, change);
  project(contacts, change);
  change += prescribed_;
}

/// Solves (1 - B) more = lack, where B maps loads of sliding points to the loads that their friction causes. A few responses are enough,
/// because the loads of neighbours act much the same.
void LinearContact::couple_loads(const StepProblem& problem, ContactSet& contacts) {
  const int n = contacts.sliding();
  if (n == 0) return;
  contacts.lacking_loads(lack_);
  const double lack = kernels::largest(n, lack_.data()),
               slight = problem.load_slack * std::max(problem.force_scale, contacts.largest_load());
  if (!(lack > slight)) return;
  const Scalars& more = gmres_.solve(n, lack_, std::max(problem.loads_left, slight / lack), [&](const Scalars& loads, Scalars& left) {
    respond(problem, contacts, loads, of_products);
    contacts.loads_of(made_, friction_, response_, left);
    for (int i = 0; i < n; ++i) left[i] = loads[i] - left[i];
  });
  respond(problem, contacts, more, ConjugateGradients::exact);
  if (!std::isfinite(kernels::largest(response_.size(), response_.data()))) return;
  change += response_;
  reaction += made_;
  contacts.use_loads(more);
  contacts.find_loads(reaction, change);
}

/// Computes the motion response_ that the friction of these loads causes, and the forces made_ that this motion takes.
void LinearContact::respond(const StepProblem& problem, const ContactSet& contacts, const Scalars& loads, double accuracy) {
  contacts.friction_of(loads, friction_);
  response_ = friction_;
  project(contacts, response_);
  matrix_.solve(response_, accuracy);
  project(contacts, response_);
  matrix_.forces_of(problem, response_, made_);
}

}  // namespace softffd
