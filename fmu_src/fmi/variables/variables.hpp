/// The variables of a scene by value reference: which variables exist, their names, the values that a host has set, and checks of accesses.
///
/// A value reference is (family id << 24) | index, with index = instance * components + component. The scene determines which components of
/// poses are inputs and which are parameters; for poses, therefore, the index counts only the components that belong to the family.
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
  /// Highest order of the time derivatives of inputs. Forces and loads have all orders up to this one, other inputs only the first.
  static constexpr int highest_order = 3;

  using Table = std::array<std::vector<double>, family_count>;  ///< in the order of `families`; outputs have no numbers
  /// All values that a host has set; a copy is a snapshot.
  struct Values {
    Table numbers;
    std::array<Table, highest_order> rates;  ///< time derivatives of inputs, for the next step, by order - 1
    bool changed = true;                     ///< a value has changed since the values were applied
    bool material_changed = true;            ///< mass, stiffness or damping has changed
    bool rated = false;                      ///< a rate has been set
  };

  /// The last communication step. Outputs without a time derivative of their own use their change over this step divided by its length.
  struct LastStep {
    Table before;       ///< these outputs at the start of the step
    double length = 0;  ///< [s]; 0: no step yet
  };

  /// Puts the start values of the scene into the settings. The scene must outlive the object.
  Variables(const SceneFile& scene, Settings& settings, Standard standard = Standard::fmi2);
  /// Resets all variables to their start values.
  void reset();

  /// Set and get variables of type Real or Integer. Throw CallError, which names the variable. `set` sets all values or none.
  void set(Phase phase, Type type, const fmi2ValueReference* references, std::size_t count, const double* numbers);
  void get(Type type, const fmi2ValueReference* references, std::size_t count, double* numbers, SoftBody& body,
           const ErrorEstimate* estimate);
  /// Sets time derivatives of Real inputs for the next step only: orders 1 to 3 of forces and loads, order 1 of other inputs.
  void set_input_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, const double* numbers);
  /// Gets first time derivatives of Real outputs: the body's own if it knows them, as of positions and probes; otherwise the change over
  /// the last communication step divided by its length.
  void get_output_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, double* numbers,
                              SoftBody& body, const ErrorEstimate* estimate);
  /// Reads the outputs before a communication step; `end_step` makes them those at the start of the step, which has this length [s].
  void begin_step(SoftBody& body, const ErrorEstimate* estimate);
  void end_step(double length);
  double tolerance() const;
  void set_tolerance(double tolerance);  ///< > 0

  /// A variable of FMI 3.0: the value references of its elements. The first one is the value reference of the array.
  struct Array {
    std::vector<fmi2ValueReference> elements;
    bool output;
  };
  /// Returns all arrays (arrays.cpp).
  std::vector<Array> arrays() const;

  /// Returns the name of a variable as in modelDescription.xml, in FMI 3.0 with the number of the element if it is an array; "value
  /// reference" and the number if there is no such variable.
  std::string name(fmi2ValueReference reference) const;

  /// True if values have been set that the settings do not contain yet.
  bool changed() const { return values_.changed; }
  /// Makes the next `apply` put all values into the settings.
  void touch() { set_changed(true, true); }
  /// Puts the values into the settings. Returns whether mass, stiffness or damping have changed.
  bool apply(Settings& settings);
  void forget_rates();
  void set_changed(bool changed, bool material_changed) { values_.changed = changed, values_.material_changed = material_changed; }

  const Values& values() const { return values_; }
  const LastStep& last_step() const { return last_; }
  /// Restores values of this scene, which must be sound.
  void restore(Values values, LastStep last);
  /// True if `set` and `set_input_derivatives` would accept all values.
  bool sound(const Values& values) const;

 private:
  /// A variable of the scene: its row of the table, and its index in the row.
  struct Variable {
    std::size_t row;
    int index;
    int place;  ///< the index if the family had all components of every instance
    const FamilyInfo& info() const { return families[row]; }
    int instance() const { return place / components_of(row); }
    int component() const { return place % components_of(row); }
  };
  /// The variables of a list of value references. The last list of each kind of call is kept, because hosts repeat the same list.
  struct Meant {
    std::vector<fmi2ValueReference> references;
    std::vector<Variable> variables;
    std::vector<int> places;  ///< positions in the field, for variables of a field; else 0
    void reserve(std::size_t most);
  };
  static int components_of(std::size_t row) { return std::max(1, int(families[row].components.size())); }
  std::optional<Variable> find(fmi2ValueReference reference) const;
  /// Returns the variables. Throws CallError if a reference is not that of a variable of this type.
  const Meant& meant(Meant& last, Type type, const fmi2ValueReference* references, std::size_t count);
  const char* type_name(Type type) const;
  Variable checked(fmi2ValueReference reference, Type type) const;
  void check_settable(Phase phase, fmi2ValueReference reference, const FamilyInfo& info, double value) const;
  int member(const Variable& variable) const { return members(variable.info().part)[variable.instance()]; }
  const std::vector<int>& members(Part part) const { return members_[std::size_t(part)]; }
  void choose(std::size_t row);
  int count(std::size_t row) const;
  Variable variable(std::size_t row, int index) const { return {row, index, families[row].pose.empty() ? index : chosen_[row][index]}; }
  std::vector<fmi2ValueReference> of_points(std::size_t row) const;
  /// Returns the number of an element in its array, from 1 and row by row; 0: it is a variable by itself.
  std::size_t element_number(fmi2ValueReference reference) const;
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
  Standard standard_;
  std::array<std::vector<int>, family_count> members_;  ///< by part, as there are no more parts than families
  std::array<std::vector<int>, family_count> chosen_;   ///< by row, for poses: the places that belong to the family
  std::vector<Embedding> probes_;
  std::vector<SolidPlace> places_;            ///< places of the probes in a solid
  std::vector<int> followed_;                 ///< indices of the probes among the followed points
  bool rates_spread_ = true;                  ///< the settings may contain rates of forces other than 0
  std::vector<Vec3> pin_origins_;             ///< origins of the pins at rest [m]
  std::vector<std::size_t> differenced_;      ///< rows for which `begun_` and `seen_` have values
  std::array<Meant, 2> last_set_, last_got_;  ///< by type
  Table starts_;
  Values values_;
  LastStep last_;
  Table begun_;  ///< outputs of `differenced_` at the start of a communication step that is not done yet
  Table seen_;   ///< the same outputs at present, as far as they were read; NaN: not read
};

}  // namespace softffd::fmi
