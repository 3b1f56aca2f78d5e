/// Arrays of FMI 3.0: the part of Variables that combines scalars into arrays.
///
///   position, velocity, force    one array for all control points that the scene lists: (ni, nj, nk, 3) if they fill a box of the
///                                lattice in ascending order, otherwise (points, 3)
///   taxels of a sensor           (n, m, 3)
///   vectors                      (3) or (4); if a pose is partly input, partly parameter, each component is a scalar
///
/// As FMI 3.0 requires, elements are stored row by row: the last index runs fastest. In the scene's lists of points, i runs fastest.
#include <algorithm>

#include "variables/variables.hpp"

namespace softffd::fmi {

namespace {

/// Returns the numbers of points along the axes, if a list of control points fills a box of the lattice in ascending order. Otherwise all
/// points count along the first axis.
std::array<int, 3> box_of(const std::vector<int>& points, const std::array<int, 3>& counts) {
  const auto at = [&](int point) { return std::array{point % counts[0], point / counts[0] % counts[1], point / counts[0] / counts[1]}; };
  const std::array<int, 3> single{int(points.size()), 1, 1}, first = at(points.front()), last = at(points.back());
  std::array<int, 3> sides;
  for (int axis = 0; axis < 3; ++axis) sides[axis] = last[axis] - first[axis] + 1;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const std::array<int, 3> here = at(points[n]);
    int index = 0;
    for (int axis = 2; axis >= 0; --axis) {
      if (here[axis] < first[axis] || here[axis] > last[axis]) return single;
      index = index * sides[axis] + here[axis] - first[axis];
    }
    if (index != int(n)) return single;
  }
  return sides[0] * sides[1] * sides[2] == int(points.size()) ? sides : single;
}

}  // namespace

std::vector<fmi2ValueReference> Variables::of_points(std::size_t row) const {
  const auto [ni, nj, nk] = box_of(members(families[row].part), scene_.definition.lattice.counts);
  const fmi2ValueReference base = fmi2ValueReference(families[row].family) << 24;
  const int components = components_of(row);
  std::vector<fmi2ValueReference> elements;
  elements.reserve(count(row));
  for (int i = 0; i < ni; ++i)
    for (int j = 0; j < nj; ++j)
      for (int k = 0; k < nk; ++k)
        for (int c = 0; c < components; ++c) elements.push_back(base | fmi2ValueReference((i + ni * (j + nj * k)) * components + c));
  return elements;
}

/// True if the variables belong to one instance, or to cells of one grid.
bool Variables::together(const Variable& one, const Variable& other) const {
  const PartBinding& part = binding_of(one.info().part);
  return one.instance() == other.instance() || (part.cell && part.name(scene_, member(one)) == part.name(scene_, member(other)));
}

std::vector<Variables::Array> Variables::arrays() const {
  std::vector<Array> found;
  for (std::size_t row = 0; row < family_count; ++row) {
    const bool output = bindings[row].is_output;
    if (binding_of(families[row].part).of_points) {
      if (count(row) > 0) found.push_back({of_points(row), output});
      continue;
    }
    const fmi2ValueReference base = fmi2ValueReference(families[row].family) << 24;
    for (int index = 0, behind = 0; index < count(row); index = behind) {
      while (behind < count(row) && together(variable(row, behind), variable(row, index))) ++behind;
      const bool whole = behind - index >= components_of(row);
      for (int n = index; n < behind; ++n) {
        if (n == index || !whole) found.push_back({{}, output});
        found.back().elements.push_back(base | fmi2ValueReference(n));
      }
    }
  }
  return found;
}

std::size_t Variables::element_number(fmi2ValueReference reference) const {
  for (const Array& array : arrays()) {
    const auto found = std::ranges::find(array.elements, reference);
    if (found != array.elements.end()) return array.elements.size() > 1 ? std::size_t(found - array.elements.begin()) + 1 : 0;
  }
  return 0;
}

}  // namespace softffd::fmi
