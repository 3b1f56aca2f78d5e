/// Binds the rows of the table of variables: the members of a part in the scene, and the place of a family in the settings, or its output.
#pragma once
#include "estimate.hpp"
#include "forces/solid.hpp"
#include "resource/scene_file.hpp"
#include "variable_table.hpp"

namespace softffd::fmi {

inline constexpr std::size_t family_count = std::size(families), no_row = family_count;

/// Row of each family in the table, by the id of the family.
inline constexpr auto rows_by_id = [] {
  std::array<std::size_t, 128> rows{};
  rows.fill(no_row);
  for (std::size_t row = 0; row < family_count; ++row) rows[std::size_t(families[row].family)] = row;
  return rows;
}();
constexpr std::size_t row_of(Family family) { return rows_by_id[std::size_t(family)]; }

/// The members of a part: control points, or indices into one of the scene's lists. Each member is an instance of the families of the part.
/// A part without a list has one member or none.
struct PartBinding {
  Part part;
  std::vector<int> (*members)(const SceneFile& scene);
  std::string (*name)(const SceneFile& scene, int member) = nullptr;         ///< text for {name}, {obstacle} or {body}
  bool of_points = false;                                                    ///< members are control points: {i} {j} {k}
  std::array<int, 2> (*cell)(const SceneFile& scene, int member) = nullptr;  ///< {i} {j} of a cell in the grid `name`
  bool (*by_input)(const SceneFile& scene, int member,
                   std::string_view component) = nullptr;  ///< true if this component of the pose, such as point.z, is an input
};
const PartBinding& binding_of(Part part);

/// The objects from which outputs are read.
struct Observed {
  const std::vector<Embedding>& probes;
  const std::vector<SolidPlace>& places;  ///< places of the probes in a solid
  const std::vector<int>& followed;       ///< indices of the probes among the followed points of the body
  SoftBody& body;
  const ErrorEstimate* estimate;  ///< null if the scene has none
};

/// A family has a place in the settings, or an output: a field, or a function for each component. If it has neither, its values are put
/// into the settings by code of their own.
struct Binding {
  using Place = double* (*)(Settings& settings, int member);
  using Output = double (*)(const Observed& observed, int member, int axis);
  using Field = const Points& (*)(const SoftBody& body);

  Family family;
  bool is_output = false;        ///< it has `field` or `output`; a flag, as GCC's sanitizers compare no function pointers at compile time
  Place place = nullptr;         ///< place of the first component of a member
  Place rate_place = nullptr;    ///< place of the first time derivative
  Field field = nullptr;         ///< values (points, 3), if the members are control points
  Output output = nullptr;       ///< value of a component
  Output rate_output = nullptr;  ///< its time derivative, if the body knows it
};
/// The bindings, in the order of `families`.
extern const std::array<Binding, family_count> bindings;
/// True if the time derivative of a row's outputs is taken as their mean rate of change over the last communication step.
bool differenced(std::size_t row);

}  // namespace softffd::fmi
