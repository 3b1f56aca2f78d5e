/// The variables of a scene by value reference: which there are, their names, what a host has set, and the checks of setting and getting.
///
/// A value reference is (family id << 24) | index, with index = instance * components + component; of poses, whose components are inputs or
/// parameters as the scene says, the place among those that are there.
#pragma once
#include <array>
#include <optional>
#include <vector>

extern "C" {
#include "fmi2TypesPlatform.h"
}

#include "life_cycle.hpp"
#include "variables/bindings.hpp"

namespace softffd::fmi {

class Variables {
 public:
  /// Highest order of the time derivatives that inputs take: forces and loads have all, the others the first.
  static constexpr int highest_order = 3;

  using Table = std::array<std::vector<double>, family_count>;  ///< in the order of `families`; outputs have no numbers
  /// All that a host has set: its copy is a snapshot.
  struct Values {
    Table numbers;
    std::array<Table, highest_order> rates;  ///< of inputs, for the next step, by order - 1
    bool changed = true;                     ///< since they were applied
    bool material_changed = true;            ///< among them mass, stiffness or damping
    bool rated = false;                      ///< any rate was set
  };

  /// The last communication step, for derivatives of outputs that have none of their own: the change over it by its length.
  struct LastStep {
    Table before;       ///< those outputs at its start
    double length = 0;  ///< [s]; 0: there was none
  };

  /// Puts the scene's start values into the settings. The scene must outlive this.
  Variables(const SceneFile& scene, Settings& settings);
  /// Back to the start values.
  void reset();

  /// Real and Integer variables share one access path. Throw CallError naming the variable; set all or nothing.
  void set(Phase phase, Type type, const fmi2ValueReference* references, std::size_t count, const double* numbers);
  void get(Type type, const fmi2ValueReference* references, std::size_t count, double* numbers, SoftBody& body,
           const ErrorEstimate* estimate);
  /// Time derivatives of Real inputs; they hold for the next step only. Orders 1 to 3 of forces and loads, order 1 of the others.
  void set_input_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, const double* numbers);
  /// First time derivatives of Real outputs: of positions and probes as they are, of all others over the last communication step.
  void get_output_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, double* numbers,
                              SoftBody& body, const ErrorEstimate* estimate);
  /// Looks at the outputs before a communication step, and takes them for its start once it is done [s].
  void begin_step(SoftBody& body, const ErrorEstimate* estimate);
  void end_step(double length);
  void set_tolerance(double tolerance);  ///< > 0

  /// A variable of FMI 3.0: the value references of its elements, of which the first is its own.
  struct Array {
    std::vector<fmi2ValueReference> elements;
    bool output;
  };
  /// All that there are (arrays.cpp).
  std::vector<Array> arrays() const;

  /// Name of a variable as in modelDescription.xml; the bare number for an unknown one.
  std::string name(fmi2ValueReference reference) const;

  /// Whether the settings are behind what was set.
  bool changed() const { return values_.changed; }
  /// Has all applied anew.
  void touch() { set_changed(true, true); }
  /// Takes what has changed over into the settings. Returns whether mass, stiffness or damping are among it.
  bool apply(Settings& settings);
  void forget_rates();
  void set_changed(bool changed, bool material_changed) { values_.changed = changed, values_.material_changed = material_changed; }

  const Values& values() const { return values_; }
  const LastStep& last_step() const { return last_; }
  /// Takes what is of this scene and sound.
  void restore(Values values, LastStep last);
  /// Whether all values are such as `set` takes.
  bool sound(const Values& values) const;

 private:
  /// A variable that there is: a row of the table, and its index there.
  struct Variable {
    std::size_t row;
    int index;
    int place;  ///< index if the family had all components of every instance
    const FamilyInfo& info() const { return families[row]; }
    int instance() const { return place / components_of(row); }
    int component() const { return place % components_of(row); }
  };
  /// What a list of value references means: the last one of a kind of call is kept, for hosts call with the same again and again.
  struct Meant {
    std::vector<fmi2ValueReference> references;
    std::vector<Variable> variables;
    std::vector<int> places;  ///< in the field, of those of fields
    void reserve(std::size_t most);
  };
  static int components_of(std::size_t row) { return std::max(1, int(families[row].components.size())); }
  std::optional<Variable> find(fmi2ValueReference reference) const;
  /// Throws CallError where a reference is none of a variable of this type.
  const Meant& meant(Meant& last, Type type, const fmi2ValueReference* references, std::size_t count);
  Variable checked(fmi2ValueReference reference, Type type) const;
  void check_settable(Phase phase, fmi2ValueReference reference, const FamilyInfo& info, double value) const;
  int member(const Variable& variable) const { return members(variable.info().part)[variable.instance()]; }
  const std::vector<int>& members(Part part) const { return members_[std::size_t(part)]; }
  void choose(std::size_t row);
  int count(std::size_t row) const;
  Variable variable(std::size_t row, int index) const { return {row, index, families[row].pose.empty() ? index : chosen_[row][index]}; }
  std::vector<fmi2ValueReference> of_points(std::size_t row) const;
  bool together(const Variable& one, const Variable& other) const;
  template <class Motions>
  void follow_pose(Family pose, Motions& moved) const;
  void take_pins_along(Settings& settings) const;
  bool method_fits(double method) const;
  void check_method(double method) const;
  void spread(const Table& table, Points& force) const;
  void spread_forces(Settings& settings);
  double read(const Variable& variable, const Observed& observed);
  void forget_seen();
  static int highest_order_of(Family family);

  const SceneFile& scene_;
  std::array<std::vector<int>, family_count> members_;  ///< by part; there are no more parts than families
  std::array<std::vector<int>, family_count> chosen_;   ///< by row, of poses: the places that are there
  std::vector<Embedding> probes_;
  std::vector<SolidPlace> places_;            ///< of the probes, in a solid
  std::vector<int> followed_;                 ///< of the probes
  bool rates_spread_ = true;                  ///< the settings may have rates of forces that are not 0
  std::vector<Vec3> pin_origins_;             ///< at rest [m]
  std::vector<std::size_t> differenced_;      ///< the rows of `begun_` and `seen_` that have any
  std::array<Meant, 2> last_set_, last_got_;  ///< by type
  Table starts_;
  Values values_;
  LastStep last_;
  Table begun_;  ///< those outputs at the start of a communication step that is not done yet
  Table seen_;   ///< those of this moment that were read; the others are no numbers
};

}  // namespace softffd::fmi
