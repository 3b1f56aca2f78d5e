#include "contact/implicit/point_touches.hpp"

#include "contact/tolerances.hpp"

namespace softffd {

PointTouches::PointTouches(const Lattice& lattice, int planes) : contacts_(lattice, planes), linear_(lattice), free_(lattice.points(), 3) {}

void PointTouches::open(const Step& step) {
  contacts_.open(step.equations.body, step.equations.around, step.t, step.h, step.from.holds, step.same_matrix, step.seen);
}

void PointTouches::guess(const Step& step, const Points& force, const Points& x) {
  const auto& [body, around] = step.equations;
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    const HalfSpace begin = around.planes[q].at(step.t);
    for (int p = 0; p < body.points(); ++p) {
      if (body.pinned[p]) continue;
      const double load = -begin.normal.dot(row(step.from.spring, p) + row(force, p));
      const bool rests = load > 0 && begin.gap(row(step.from.x, p)) <= touching * body.length;
      if (rests || contacts_.plane(int(q)).gap(row(x, p)) < 0) contacts_.add(p, int(q), rests ? load : 0);
    }
  }
}

bool PointTouches::find_friction(const Step& step, const Points& u, bool first, double largest_stiffness, double slight) {
  bool changed = contacts_.scale_friction(step.equations.body.length, largest_stiffness);
  if (first) {
    free_ = step.h * (step.along ? *step.along : step.from.v);
    contacts_.guess_friction(step.from.x, u, free_, step.h);
  } else {
    changed = contacts_.find_friction(step.from.x, u, step.h, slight) || changed;
  }
  if (changed) linear_.refresh();
  return !changed;
}

StepStatus PointTouches::solve(const StepProblem& problem, bool cautious) {
  return linear_.solve(problem, contacts_, cautious) ? StepStatus::ok : StepStatus::not_finite;
}

void PointTouches::add_forces(Points& f) const {
  for (int p : contacts_.points())
    for (int i = 0; i < contacts_.touches(p); ++i) {
      const ContactSet::Touch& touch = contacts_.touch(p, i);
      set_row(f, p, row(f, p) + touch.load * touch.normal + touch.friction);
    }
}

void PointTouches::keep_in_front(const Body& body, Points& x) const {
  for (int p = 0; p < body.points(); ++p) {
    if (body.pinned[p]) continue;
    Vec3 here = row(x, p);
    push_out(contacts_.planes(), here);
    set_row(x, p, here);
  }
}

void PointTouches::find_reactions(std::vector<Reaction>& reactions) const {
  reactions.clear();
  for (int p : contacts_.points()) {
    Vec3 left = row(linear_.reaction, p);
    const std::size_t first = reactions.size();
    for (int i = 0; i < contacts_.touches(p); ++i) {
      const ContactSet::Touch& touch = contacts_.touch(p, i);
      const Vec3 force = touch.load * touch.normal + ContactSet::linear_friction(touch, row(linear_.change, p));
      if (i > 0) left -= force;
      reactions.push_back({touch.plane, p, touch.normal, force, i == 0});
    }
    reactions[first].force = left;
  }
}

}  // namespace softffd
