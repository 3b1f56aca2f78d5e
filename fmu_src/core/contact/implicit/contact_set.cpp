#include "contact/implicit/contact_set.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "contact/tolerances.hpp"

namespace softffd {

ContactSet::ContactSet(const Lattice& lattice, int planes)
    : seen_(planes),
      end_(planes),
      friction_(planes, 0.0),
      at_(lattice.points()),
      pinned_(lattice.points(), 0),
      neighbours_(coupled_points(lattice)),
      gap_(lattice.points()),
      feasible_(planes) {
  touching_.reserve(lattice.points());
  in_matrix_.reserve(3 * lattice.points());
  constraints_.reserve(planes);
}

void ContactSet::open(const Body& body, const Drive& around, double t, double h, const Holds& holds, bool again, double seen) {
  seen_at_ = seen;
  holds_ = &holds;
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    seen_[q] = around.planes[q].at(t + seen * h);
    end_[q] = around.planes[q].at(t + h);
    friction_[q] = around.planes[q].friction;
  }
  touching_.clear();
  for (int p = 0; p < body.points(); ++p) {
    pinned_[p] = body.pinned[p];
    at_[p].count = 0;
    refresh(p);
  }
  if (!again) load_scale_ = 0;
}

bool ContactSet::possible(const Vec3& x, double slack) {
  if (end_.size() < 2) return true;
  constraints_.clear();
  for (const HalfSpace& plane : end_) constraints_.push_back({.normal = plane.normal, .bound = plane.offset});
  Vec3 nearest = x;
  return feasible_.project(constraints_, slack, nearest);
}

/// Columns of absent touches are zero.
Eigen::Matrix3d ContactSet::normals(const AtPoint& at) {
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  for (int i = 0; i < at.count; ++i) normals.col(i) = at.touches[i].normal;
  return normals;
}

Eigen::Matrix3d ContactSet::gram(const AtPoint& at) {
  const Eigen::Matrix3d n = normals(at);
  Eigen::Matrix3d gram = n.transpose() * n;
  for (int i = at.count; i < 3; ++i) gram(i, i) = 1;
  return gram;
}

void ContactSet::refresh(int p) {
  AtPoint& at = at_[p];
  at.freedom = pinned_[p] || at.count == 3 ? Freedom::none : at.count > 0 ? Freedom::some : Freedom::all;
  at.projector.setZero();
  if (at.freedom != Freedom::none) at.projector.setIdentity();
  if (at.count == 0) return;
  at.gram_inverse = gram(at).inverse();
  if (at.freedom == Freedom::none) return;
  const Eigen::Matrix3d n = normals(at);
  at.projector -= n * at.gram_inverse * n.transpose();
}

void ContactSet::remove(int p, int i) {
  AtPoint& at = at_[p];
  for (--at.count; i < at.count; ++i) at.touches[i] = at.touches[i + 1];
  if (at.count == 0) touching_.erase(std::find(touching_.begin(), touching_.end(), p));
  refresh(p);
}

void ContactSet::add(int p, int q, double load) {
  AtPoint& at = at_[p];
  Touch fresh;
  fresh.plane = q;
  fresh.normal = end_[q].normal;
  fresh.load = load;
  if (!holds_->empty()) fresh.held = tangential(fresh.normal, row((*holds_)[q], p));
  if (at.count < 3) {
    AtPoint trial = at;
    trial.touches[trial.count++] = fresh;
    if (gram(trial).determinant() >= dependent) {
      if (at.count == 0) touching_.push_back(p);
      at = trial;
      return refresh(p);
    }
  }
  int replaced = -1;
  for (int i = 0; i < at.count; ++i) {
    AtPoint trial = at;
    trial.touches[i] = fresh;
    const bool lighter = replaced < 0 || at.touches[i].load < at.touches[replaced].load;
    if (lighter && gram(trial).determinant() >= dependent) replaced = i;
  }
  if (replaced < 0) return;
  at.touches[replaced] = fresh;
  refresh(p);
}

bool ContactSet::add_violated(const Points& x, double slack) {
  bool any = false;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    if (!kernels::gaps(int(x.rows()), x.data(), end_[q].normal.data(), end_[q].offset, gap_.data())) continue;
    for (int p = 0; p < x.rows(); ++p) {
      if (!(gap_[p] < -slack) || pinned_[p]) continue;
      const auto begin = at_[p].touches.begin(), end = begin + at_[p].count;
      if (std::any_of(begin, end, [&](const Touch& touch) { return touch.plane == int(q); })) continue;
      add(p, int(q), 0);
      any = true;
    }
  }
  return any;
}

bool ContactSet::release_pulling(double pull, bool all) {
  if (all) {
    bool any = false;
    for (int n = int(touching_.size()) - 1; n >= 0; --n) {
      const int p = touching_[n];
      for (int i = at_[p].count - 1; i >= 0; --i)
        if (at_[p].touches[i].load < -pull) remove(p, i), any = true;
    }
    return any;
  }
  int most_p = -1, most_i = 0;
  double most = -pull;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i)
      if (at_[p].touches[i].load < most) most = at_[p].touches[i].load, most_p = p, most_i = i;
  if (most_p >= 0) remove(most_p, most_i);
  return most_p >= 0;
}

double ContactSet::largest_load() const {
  double largest = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) largest = std::max(largest, at_[p].touches[i].load);
  return largest;
}

bool ContactSet::prescribe(const Points& x, Points& dx) const {
  bool any = false;
  dx.setZero();
  for (int p : touching_) {
    const AtPoint& at = at_[p];
    Vec3 lack = Vec3::Zero();
    for (int i = 0; i < at.count; ++i) lack[i] = -end_[at.touches[i].plane].gap(row(x, p));
    if (lack.isZero(0)) continue;
    set_row(dx, p, normals(at) * (at.gram_inverse * lack));
    any = true;
  }
  return any;
}

void ContactSet::find_loads(const Points& force, const Points& dx) {
  for (int p : touching_) {
    AtPoint& at = at_[p];
    Vec3 normal_force = row(force, p);
    for (int i = 0; i < at.count; ++i) normal_force -= linear_friction(at.touches[i], row(dx, p));
    const Vec3 loads = at.gram_inverse * (normals(at).transpose() * normal_force);
    for (int i = 0; i < at.count; ++i) at.touches[i].load = loads[i];
  }
}

void ContactSet::constrain(LatticeMatrix& matrix) {
  in_matrix_.clear();
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) in_matrix_.push_back({p, at_[p].touches[i]});
  for (int p : touching_) {
    const Eigen::Matrix3d& projector = at_[p].projector;
    for (int q : neighbours_[p])
      if (at_[q].count == 0)
        matrix.set_block(p, q, projector * matrix.block(p, q));
      else if (q > p)
        matrix.set_block(p, q, projector * matrix.block(p, q) * at_[q].projector);
    const Eigen::Matrix3d own = matrix.block(p, p) + friction_stiffness(p);
    const double typical = own.trace() / 3;
    matrix.set_block(p, p, projector * own * projector + typical * (Eigen::Matrix3d::Identity() - projector));
  }
}

}  // namespace softffd
