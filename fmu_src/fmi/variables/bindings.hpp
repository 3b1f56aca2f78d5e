/// What the rows of the table of variables stand for: a part's members in the scene, a family's place in the body's settings or its output.
#pragma once
#include "estimate.hpp"
#include "forces/solid.hpp"
#include "resource/scene_file.hpp"
#include "variable_table.hpp"

namespace softffd::fmi {

inline constexpr std::size_t family_count = std::size(families), no_row = family_count;

/// Where a family's row is in the table, by its id.
inline constexpr auto rows_by_id = [] {
  std::array<std::size_t, 128> rows{};
  rows.fill(no_row);
  for (std::size_t row = 0; row < family_count; ++row) rows[std::size_t(families[row].family)] = row;
  return rows;
}();
constexpr std::size_t row_of(Family family) { return rows_by_id[std::size_t(family)]; }

/// The members of a part, one instance of its families each: control points, or numbers in one of the scene's lists. A part without a list
/// has one member or none.
struct PartBinding {
  Part part;
  std::vector<int> (*members)(const SceneFile& scene);
  std::string (*name)(const SceneFile& scene, int member) = nullptr;         ///< what {name}, or {obstacle}, stands for
  bool of_points = false;                                                    ///< members are control points: {i} {j} {k}
  std::array<int, 2> (*cell)(const SceneFile& scene, int member) = nullptr;  ///< {i} {j} of one that belongs to a grid with that name
  bool (*by_input)(const SceneFile& scene, int member,
                   std::string_view component) = nullptr;  ///< is this of its pose, as point.z, an input?
};
const PartBinding& binding_of(Part part);

/// What outputs are read from.
struct Observed {
  const std::vector<Embedding>& probes;
  const std::vector<SolidPlace>& places;  ///< the same in a solid
  const std::vector<int>& followed;       ///< their numbers among those that the body follows
  SoftBody& body;
  const ErrorEstimate* estimate;  ///< null where the scene has none
};

/// A family has a place in the settings, or an output, as a field or by component, or neither: then its values go into the settings in a
/// way of their own.
struct Binding {
  using Place = double* (*)(Settings& settings, int member);
  using Output = double (*)(const Observed& observed, int member, int axis);
  using Field = const Points& (*)(const SoftBody& body);

  Family family;
  bool is_output = false;        ///< then it has `field` or `output`: GCC's sanitizers do not compare function pointers while compiling
  Place place = nullptr;         ///< of a member's first component
  Place rate_place = nullptr;    ///< the same for the first time derivative
  Field field = nullptr;         ///< of which members are control points
  Output output = nullptr;       ///< a component
  Output rate_output = nullptr;  ///< its time derivative, where the body knows it
};
/// In the order of `families`.
extern const std::array<Binding, family_count> bindings;
/// Whether the derivative of a row's output is its change over the last communication step.
bool differenced(std::size_t row);

}  // namespace softffd::fmi
