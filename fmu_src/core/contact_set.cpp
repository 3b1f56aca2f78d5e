#include "contact_set.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace softffd {

namespace {

/// Determinant of the Gram matrix of unit normals below which they count as dependent.
constexpr double dependent = 1e-14;

Vec3 tangential(const Vec3& normal, const Vec3& v) { return v - normal.dot(v) * normal; }

}  // namespace

ContactSet::ContactSet(const Lattice& lattice, int planes)
    : middle_(planes),
      end_(planes),
      friction_(planes, 0.0),
      at_(lattice.points()),
      pinned_(lattice.points(), 0),
      neighbours_(lattice.points()),
      gap_(lattice.points()),
      feasible_(planes) {
  touching_.reserve(lattice.points());
  constraints_.reserve(planes);
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i)
        for (const Direction& direction : directions) {
          if (!direction.within(lattice, i, j, k)) continue;
          const int p = lattice.index(i, j, k), q = p + direction.offset(lattice);
          neighbours_[p].push_back(q);
          neighbours_[q].push_back(p);
        }
}

void ContactSet::open(const Body& body, const Surroundings& around, double t, double h) {
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    middle_[q] = around.planes[q].at(t + 0.5 * h);
    end_[q] = around.planes[q].at(t + h);
    friction_[q] = around.planes[q].friction;
  }
  touching_.clear();
  for (int p = 0; p < body.points(); ++p) {
    pinned_[p] = body.pinned[p];
    at_[p].count = 0;
    refresh(p);
  }
  load_scale_ = 0;
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

bool ContactSet::scale_friction(double length, double largest_stiffness) {
  double largest = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) largest = std::max(largest, friction_[at_[p].touches[i].plane] * at_[p].touches[i].load);
  if (largest == 0 || (largest <= 4 * load_scale_ && largest >= 0.25 * load_scale_)) return false;
  load_scale_ = largest;
  reach_ = std::max(1e-9 * length, largest_stiffness > 0 ? largest / (1e5 * largest_stiffness) : 0.0);
  return true;
}

/// Tangential motion of the point less that of the plane's material.
Vec3 ContactSet::slip(const Touch& touch, const Vec3& x0, const Vec3& moved, double h) const {
  return tangential(touch.normal, moved - h * material_velocity(touch.plane, x0 + 0.5 * moved));
}

void ContactSet::hold_or_slide(Touch& touch, const Vec3& slip) {
  touch.fresh = false;
  touch.used = std::max(0.0, touch.load);
  const double limit = friction_[touch.plane] * touch.used, size = slip.norm(), held = load_scale_ / reach_;
  touch.slip = slip;
  touch.sticks = held * size <= limit;
  touch.wanted = limit == 0 ? 0 : touch.sticks ? held : limit / size;
  touch.friction = -touch.wanted * slip;
}

bool ContactSet::find_friction(const Points& x0, const Points& u, double h, double slight) {
  bool changed = false;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      hold_or_slide(touch, slip(touch, row(x0, p), row(u, p), h));
      const double more = std::abs(touch.wanted - touch.stiffness);
      const bool turned = touch.wanted > slight && touch.stiffness > 0 && touch.sticks != touch.direction.isZero(0);
      changed = changed || turned || (more > slight && more > 0.5 * touch.stiffness);
    }
  return changed;
}

void ContactSet::find_new_friction(const Points& x0, const Points& u, double h) {
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i)
      if (at_[p].touches[i].fresh) hold_or_slide(at_[p].touches[i], slip(at_[p].touches[i], row(x0, p), row(u, p), h));
}

void ContactSet::guess_friction(const Points& x0, const Points& u, const Points& free, double h) {
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      hold_or_slide(touch, slip(touch, row(x0, p), row(free, p), h));
      if (!touch.sticks) continue;
      touch.slip = slip(touch, row(x0, p), row(u, p), h);
      touch.friction = -touch.wanted * touch.slip;
    }
}

void ContactSet::fix_friction_stiffness(bool cautious) {
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      touch.stiffness = touch.wanted;
      touch.direction = cautious || touch.sticks || touch.wanted == 0 ? Vec3::Zero() : Vec3(touch.slip / touch.slip.norm());
    }
}

bool ContactSet::stop_reversals(const Points& dx) {
  bool any = false;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      if (touch.sticks || touch.wanted == 0 || touch.slip.dot(touch.slip + row(dx, p)) > 0) continue;
      touch.sticks = true;
      touch.wanted = load_scale_ / reach_;
      touch.friction = -touch.wanted * touch.slip;
      any = true;
    }
  return any;
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

Vec3 ContactSet::linear_friction(const Touch& touch, const Vec3& dx) {
  const Vec3 along = tangential(touch.normal, dx);
  return touch.friction - touch.stiffness * (along - touch.direction.dot(along) * touch.direction);
}

Eigen::Matrix3d ContactSet::friction_stiffness(int p) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < at_[p].count; ++i) {
    const Touch& touch = at_[p].touches[i];
    sum += touch.stiffness * (Eigen::Matrix3d::Identity() - touch.normal * touch.normal.transpose() -
                              touch.direction * touch.direction.transpose());
  }
  return sum;
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

bool ContactSet::slides(const Touch& touch) const { return !touch.sticks && friction_[touch.plane] > 0; }

int ContactSet::sliding() const {
  int count = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) count += slides(at_[p].touches[i]);
  return count;
}

void ContactSet::lacking_loads(Scalars& lack) const {
  int n = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      const Touch& touch = at_[p].touches[i];
      if (slides(touch)) lack[n++] = touch.load - touch.used;
    }
}

void ContactSet::friction_of(const Scalars& loads, Points& force) const {
  force.setZero();
  int n = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      const Touch& touch = at_[p].touches[i];
      if (slides(touch)) set_row(force, p, row(force, p) - friction_[touch.plane] * loads[n++] / touch.slip.norm() * touch.slip);
    }
}

void ContactSet::loads_of(const Points& made, const Points& friction, const Points& dx, Scalars& loads) const {
  int n = 0;
  for (int p : touching_) {
    const AtPoint& at = at_[p];
    Vec3 normal_force = row(made, p) - row(friction, p);
    for (int i = 0; i < at.count; ++i) normal_force -= linear_friction(at.touches[i], row(dx, p)) - at.touches[i].friction;
    const Vec3 all = at.gram_inverse * (normals(at).transpose() * normal_force);
    for (int i = 0; i < at.count; ++i)
      if (slides(at.touches[i])) loads[n++] = all[i];
  }
}

void ContactSet::use_loads(const Scalars& more) {
  int n = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      if (!slides(touch)) continue;
      touch.friction -= friction_[touch.plane] * more[n] / touch.slip.norm() * touch.slip;
      touch.used += more[n++];
    }
}

namespace {

Eigen::Matrix3d block(LayerMatrix& matrix, int p, int q) {
  Eigen::Matrix3d block;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) block(a, b) = matrix.at(p, a, q, b);
  return block;
}

void set_block(LayerMatrix& matrix, int p, int q, const Eigen::Matrix3d& block) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < (p == q ? a + 1 : 3); ++b) matrix.at(p, a, q, b) = block(a, b);
}

}  // namespace

void ContactSet::constrain(LayerMatrix& matrix) const {
  for (int p : touching_) {
    const Eigen::Matrix3d& projector = at_[p].projector;
    for (int q : neighbours_[p])
      if (at_[q].count == 0)
        set_block(matrix, p, q, projector * block(matrix, p, q));
      else if (q > p)
        set_block(matrix, p, q, projector * block(matrix, p, q) * at_[q].projector);
    const Eigen::Matrix3d own = block(matrix, p, p) + friction_stiffness(p);
    const double typical = own.trace() / 3;
    set_block(matrix, p, p, projector * own * projector + typical * (Eigen::Matrix3d::Identity() - projector));
  }
}

}  // namespace softffd
