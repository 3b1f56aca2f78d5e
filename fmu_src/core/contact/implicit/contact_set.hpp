/// The control points that touch planes, and their contact forces: the unknowns that contact adds to an implicit step.
///
/// A point touches at most three planes whose normals N = (n1 .. n3) are independent. Its normal motion is prescribed,
///
///      N^T dx = d:  d closes the gaps left,       P = I - N (N^T N)^-1 N^T:  projector onto free motion,
///
/// and the normal forces lambda follow from the equations that this motion replaces. Friction on each plane is Coulomb's law with a short
/// elastic part (Huber): the friction on a point that has slipped by s is
///
///      -stiffness s      up to |s| = mu lambda / stiffness,      -mu lambda s / |s|      beyond,
///
/// At the start of the step, s is the elastic slip that belongs to the friction of the step before. A point that sticks under steady
/// forces therefore does not move at all.
///
/// Friction uses the lambda of the last solution. Newton's method iterates until this lambda is that of the solution itself.
///
/// A step calls these functions in this order, from the second line on as often as needed:
///
///      open, add                                      which points touch at first
///      scale_friction, guess_ or find_friction        friction at the displacements so far; after adding: find_new_friction
///      fix_friction_stiffness, constrain              its part of the matrix; every touch must have its friction by then
///      prescribe, find_loads                          the motion and the loads of one solution with this matrix
///      sliding, lacking_loads, friction_of, ...       coupling of loads and friction of sliding points in this solution
///      release_pulling, add_violated                  change the touches; then fix and constrain again
#pragma once
#include <vector>

#include "body/body.hpp"
#include "contact/feasible.hpp"
#include "matrix/lattice_matrix.hpp"
#include "model/drive.hpp"
#include "model/state.hpp"

namespace softffd {

class ContactSet {
 public:
  /// One plane under one point.
  struct Touch {
    int plane = 0;
    Vec3 normal = Vec3::UnitZ();
    double load = 0;                ///< normal force of the last solution [N]
    double used = 0;                ///< normal force that the friction is computed from [N]
    Vec3 held = Vec3::Zero();       ///< friction on the point at the start of the step [N]
    Vec3 slip = Vec3::Zero();       ///< tangential slip in this step, plus the elastic slip at its start [m]
    Vec3 friction = Vec3::Zero();   ///< friction on the point at this slip [N]
    double wanted = 0;              ///< stiffness of friction at this slip; of a sliding point, across the slip [N/m]
    bool sticks = true;             ///< friction is in its elastic part
    bool fresh = true;              ///< its friction has not been found yet
    double stiffness = 0;           ///< stiffness of friction in the matrix, for all tangential motion [N/m] except ...
    Vec3 direction = Vec3::Zero();  ///< ... motion along this unit vector, if the point slides; otherwise zero
  };
  enum class Freedom : char { all, some, none };

  ContactSet(const Lattice& lattice, int planes);

  /// Opens a step from t to t + h [s] without touches. Pinned points have no freedom. `holds` is read until the step's end. again: the
  /// matrix of the step before is to serve, and with it the scale of friction's stiffness.
  void open(const Body& body, const Drive& around, double t, double h, const Holds& holds, bool again = false, double seen = 0.5);
  /// Writes the present friction into `holds`; allocates room there if there is none yet.
  void hold(Holds& holds) const;
  const HalfSpace& plane(int q) const { return end_[q]; }
  const std::vector<HalfSpace>& planes() const { return end_; }  ///< at the end of the step
  /// Velocity of plane q's material at x during the step, in the pose of mid-step [m/s].
  Vec3 material_velocity(int q, const Vec3& x) const { return seen_[q].material_velocity(x); }
  /// True if some position is in front of all planes, to within `slack` [m].
  bool possible(const Vec3& x, double slack);

  /// Adds touches with load 0 where points at x are more than `slack` [m] behind planes. Returns whether there were any.
  bool add_violated(const Points& x, double slack);
  /// Adds a touch of point p at plane q. If p cannot touch all of its planes at once, the least loaded touch in the way is replaced.
  void add(int p, int q, double load);
  /// Ends touches that pull by more than `pull` [N]: all of them, or only the one that pulls most. Returns whether there were any.
  bool release_pulling(double pull, bool all);

  /// Computes the friction at displacements u of the step from x0. Returns whether its stiffness differs from that of the matrix by more
  /// than half of that and by more than `slight` [N/m], or a point has changed between sticking and sliding.
  bool find_friction(const Points& x0, const Points& u, double h, double slight);
  /// Computes the friction of the touches that have been added since.
  void find_new_friction(const Points& x0, const Points& u, double h);
  /// Computes the friction before the first solution: points that slide at the displacements `free` of the motion so far slide on.
  void guess_friction(const Points& x0, const Points& u, const Points& free, double h);
  /// Fixes friction's present stiffness for the matrix. cautious: also the stiffness of sliding points along the slip, which makes a
  /// majorant of the energy that friction dissipates.
  void fix_friction_stiffness(bool cautious);
  /// Makes sliding points stick whose slip the motion dx would take back across zero. Returns whether there were any.
  bool stop_reversals(const Points& dx);
  /// Takes friction's stiffness from the present matrix. Returns whether the same points touch the same planes as when the matrix was
  /// constrained, and friction's stiffness differs from that of the matrix by no more than `find_friction` allows.
  bool take_friction_stiffness(double slight);
  /// matrix = P (matrix + friction) P + c (I - P): the equations of the motion that the touches leave free; c is of the size of the
  /// matrix's own entries. Rows and columns of pinned points remain those of the identity.
  void constrain(LatticeMatrix& matrix);
  /// Adopts a new scale for friction's stiffness if the loads have left the present one, up or down. Returns whether they had.
  bool scale_friction(double length, double largest_stiffness);

  /// Sets dx to the normal motion that closes the gaps left at x [m] for touching points, to zero for all others. Returns whether any of
  /// it is not zero.
  bool prescribe(const Points& x, Points& dx) const;
  /// Computes the loads from the forces that the constraints exert on the points, friction included [N].
  void find_loads(const Points& force, const Points& dx);
  /// Number of sliding touches; the friction of each follows its load.
  int sliding() const;
  /// lack = loads found less loads used, of the sliding touches [N].
  void lacking_loads(Scalars& lack) const;
  /// force = friction of the sliding touches if their loads were these, (sliding); no other forces [N].
  void friction_of(const Scalars& loads, Points& force) const;
  /// Computes the loads of the sliding touches that this friction and the motion dx cause; made: the forces A dx [N].
  void loads_of(const Points& made, const Points& friction, const Points& dx, Scalars& loads) const;
  /// Adds `more`, (sliding), to the loads that friction is computed from [N].
  void use_loads(const Scalars& more);
  /// Friction in the linearised equations at a motion dx [N].
  static Vec3 linear_friction(const Touch& touch, const Vec3& dx);

  Freedom freedom(int p) const { return at_[p].freedom; }
  const Eigen::Matrix3d& projector(int p) const { return at_[p].projector; }
  const std::vector<int>& points() const { return touching_; }  ///< points that touch
  int touches(int p) const { return at_[p].count; }
  const Touch& touch(int p, int i) const { return at_[p].touches[i]; }
  double largest_load() const;

 private:
  struct AtPoint {
    int count = 0;
    Freedom freedom = Freedom::all;
    std::array<Touch, 3> touches;
    Eigen::Matrix3d gram_inverse, projector = Eigen::Matrix3d::Identity();
  };
  /// A touch as it is in the matrix.
  struct InMatrix {
    int point;
    Touch touch;
  };
  bool slides(const Touch& touch) const;
  static bool left(const Touch& touch, double slight);
  Vec3 slip(const Touch& touch, const Vec3& x0, const Vec3& moved, double h) const;
  void hold_or_slide(Touch& touch, const Vec3& slip);
  static Eigen::Matrix3d gram(const AtPoint& at);
  static Eigen::Matrix3d normals(const AtPoint& at);
  void refresh(int p);
  void remove(int p, int i);
  Eigen::Matrix3d friction_stiffness(int p) const;

  double seen_at_ = 0.5;  ///< part of the step after which obstacles are seen [1]
  std::vector<HalfSpace> seen_, end_;
  std::vector<double> friction_;  ///< (planes) Coulomb coefficients
  const Holds* holds_ = nullptr;
  std::vector<AtPoint> at_;  ///< (points)
  std::vector<int> touching_;
  std::vector<InMatrix> in_matrix_;
  std::vector<char> pinned_;
  std::vector<std::vector<int>> neighbours_;  ///< (points) points coupled with each, within one cell
  Scalars gap_;
  double load_scale_ = 0, reach_ = 1;  ///< largest friction that its stiffness is made for [N]; slip at which that is reached [m]
  std::vector<Constraint> constraints_;
  FeasibleSet feasible_;
};

}  // namespace softffd
