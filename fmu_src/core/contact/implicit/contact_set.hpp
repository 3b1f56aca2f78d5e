/// Which control points touch which planes, and with what forces: the unknowns that contact adds to an implicit step.
///
/// A point touches at most three planes whose normals N = (n1 .. n3) are independent. Its normal motion is prescribed,
///
///      N^T dx = d:  the gaps that are left,       P = I - N (N^T N)^-1 N^T:  what it may still do,
///
/// and the normal forces lambda follow from the equations so left out. Friction on each plane is Coulomb's law with a short elastic part
/// (Huber): a point that has slipped by s is held by
///
///      -stiffness s      up to |s| = mu lambda / stiffness,      -mu lambda s / |s|      beyond,
///
/// s beginning with what the friction of the step before is the elastic part of: what sticks under steady forces does not move at all.
///
/// lambda is the one found last; the steps of Newton's method repeat until it is the one they use.
///
/// A step asks in this order, from the second line on as often as it takes:
///
///      open, add                                      which points touch at first
///      scale_friction, guess_ or find_friction        friction at the displacements so far; whoever adds: find_new_friction
///      fix_friction_stiffness, constrain              what the matrix has of it: for touches with friction found only
///      prescribe, find_loads                          the motion and the loads of one solution with this matrix
///      sliding, lacking_loads, friction_of, ...       how loads and friction of sliding points follow each other in it
///      release_pulling, add_violated                  other touches: fix and constrain again
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
    double load = 0;                ///< normal force, of the last solution [N]
    double used = 0;                ///< the normal force that the friction is taken from [N]
    Vec3 held = Vec3::Zero();       ///< friction on the point at the beginning of the step [N]
    Vec3 slip = Vec3::Zero();       ///< tangential, in this step and before, as far as friction's elastic part has it [m]
    Vec3 friction = Vec3::Zero();   ///< force on the point at this slip [N]
    double wanted = 0;              ///< its stiffness at this slip, across it if the point slides [N/m]
    bool sticks = true;             ///< in its elastic part
    bool fresh = true;              ///< no friction was found yet
    double stiffness = 0;           ///< as the matrix has it: for all tangential motion [N/m] but that ...
    Vec3 direction = Vec3::Zero();  ///< ... along here, if the point slides; unit vector or zero
  };
  enum class Freedom : char { all, some, none };

  ContactSet(const Lattice& lattice, int planes);

  /// Opens a step from t to t + h; nothing touches yet. Pinned points have no freedom. `holds` is read until the step's end.
  /// again: the matrix of the step before is to serve, and with it the scale of friction's stiffness.
  void open(const Body& body, const Drive& around, double t, double h, const Holds& holds, bool again = false);
  /// The friction as it is now; makes room for it where there is none yet.
  void hold(Holds& holds) const;
  const HalfSpace& plane(int q) const { return end_[q]; }
  const std::vector<HalfSpace>& planes() const { return end_; }  ///< at the end of the step
  /// Velocity of plane q's material under a point during the step, seen at mid-step [m/s].
  Vec3 material_velocity(int q, const Vec3& x) const { return middle_[q].material_velocity(x); }
  /// Is there room in front of all planes?
  bool possible(const Vec3& x, double slack);

  /// Points at x behind planes begin to touch them, with load 0. Returns whether there were any.
  bool add_violated(const Points& x, double slack);
  /// Point p begins to touch plane q. If it cannot touch all of its planes at once, the least loaded in the way goes.
  void add(int p, int q, double load);
  /// Ends touches that pull by more than `pull` [N]: all, or the one that pulls most. Returns whether there were any.
  bool release_pulling(double pull, bool all);

  /// Friction forces at displacements u of the step from x0. Returns whether their stiffness has left that of the matrix by more than half
  /// of it and by more than `slight` [N/m].
  bool find_friction(const Points& x0, const Points& u, double h, double slight);
  /// The same for points that have begun to touch since it was called.
  void find_new_friction(const Points& x0, const Points& u, double h);
  /// The same before the first solution: points that have slid so far, by the displacements `free`, still do.
  void guess_friction(const Points& x0, const Points& u, const Points& free, double h);
  /// The matrix is to hold friction's stiffness as it is now; with `cautious` that of sliding points along the slip too, a majorant of the
  /// energy that friction dissipates.
  void fix_friction_stiffness(bool cautious);
  /// Points that this motion would take back across zero slip are held instead. Returns whether there were any.
  bool stop_reversals(const Points& dx);
  /// Takes friction's stiffness as the matrix has it already, if the same points touch the same planes as when it was constrained, and it
  /// has not left that by more than `find_friction` lets it. Returns whether it has.
  bool take_friction_stiffness(double slight);
  /// matrix = P (matrix + friction) P + c (I - P): the equations of what motion the touches leave, c being of the matrix's own size. Rows
  /// and columns of pinned points, which are the identity's, stay so.
  void constrain(LatticeMatrix& matrix);
  /// Adopts a scale for friction's stiffness if the loads have outgrown the present one. Returns whether they had.
  bool scale_friction(double length, double largest_stiffness);

  /// The normal motion that closes the gaps left at x [m]; sets it in dx for touching points, zero for all others. Returns whether any is
  /// not zero.
  bool prescribe(const Points& x, Points& dx) const;
  /// Loads from the forces that the constraints exert on the points, friction included [N].
  void find_loads(const Points& force, const Points& dx);
  /// Sliding points: the friction of each follows its load.
  int sliding() const;
  /// What the loads found lack to those used, for the sliding points [N].
  void lacking_loads(Scalars& lack) const;
  /// force = the friction of sliding points if these were their loads, (sliding); no other forces. [N]
  void friction_of(const Scalars& loads, Points& force) const;
  /// Loads of the sliding points that such a friction and the motion dx cause, from the forces A dx that they make [N].
  void loads_of(const Points& made, const Points& friction, const Points& dx, Scalars& loads) const;
  /// Adds to the loads used.
  void use_loads(const Scalars& more);
  /// The friction force that the linear equations have at a motion dx.
  static Vec3 linear_friction(const Touch& touch, const Vec3& dx);

  Freedom freedom(int p) const { return at_[p].freedom; }
  const Eigen::Matrix3d& projector(int p) const { return at_[p].projector; }
  const std::vector<int>& points() const { return touching_; }  ///< that touch
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
  /// What the matrix has of a touch.
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

  std::vector<HalfSpace> middle_, end_;
  std::vector<double> friction_;  ///< (planes) coefficients
  const Holds* holds_ = nullptr;
  std::vector<AtPoint> at_;  ///< (points)
  std::vector<int> touching_;
  std::vector<InMatrix> in_matrix_;
  std::vector<char> pinned_;
  std::vector<std::vector<int>> neighbours_;  ///< (points) within one cell
  Scalars gap_;
  double load_scale_ = 0, reach_ = 1;  ///< largest load that friction's stiffness is made for [N]; slip at which it is used up [m]
  std::vector<Constraint> constraints_;
  FeasibleSet feasible_;
};

}  // namespace softffd
