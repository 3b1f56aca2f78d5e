/// Values that are stored, compared and checked field by field. Each struct lists its fields once, next to its definition,
///
///      struct Clock {
///        double origin = 0, h = 0;
///        template <class Self, class Fields> static auto visit(Self& s, Fields&& fields) { return fields(s.origin, s.h); }
///      };
///      static_assert(visits_every_field<Clock>);
///
/// and code that needs all of a value, its bytes or whether it is finite, goes through this list. The assertion counts the fields of the
/// aggregate itself, so that a new field that is not listed does not compile.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include "model/marked_points.hpp"
#include "model/types.hpp"

namespace softffd {

namespace visiting {

/// Stands for any field in an initializer.
struct Anything {
  template <class T>
  operator T() const;
};

template <class T, class... Fields>
consteval std::size_t count_fields() {
  if constexpr (requires { T{Fields{}..., Anything{}}; })
    return count_fields<T, Fields..., Anything>();
  else
    return sizeof...(Fields);
}

struct Counter {
  template <class... Fields>
  constexpr std::integral_constant<std::size_t, sizeof...(Fields)> operator()(Fields&...) const {
    return {};
  }
};

template <class T>
struct is_list : std::false_type {};
template <class T>
struct is_list<std::vector<T>> : std::true_type {};
template <class T, std::size_t n>
struct is_list<std::array<T, n>> : std::true_type {};

}  // namespace visiting

template <class T>
concept Visited = requires(T& value) { T::visit(value, visiting::Counter{}); };

/// True if `visit` lists as many fields as the struct has.
template <class T>
inline constexpr bool visits_every_field =
    decltype(T::visit(std::declval<T&>(), visiting::Counter{}))::value == visiting::count_fields<T>();

/// Calls `leaf` for every number, flag, enumerator and array of numbers of a value, in the order of the fields.
template <class T, class Leaf>
void each_leaf(T& value, Leaf&& leaf) {
  using Plain = std::remove_const_t<T>;
  if constexpr (Visited<Plain>)
    Plain::visit(value, [&](auto&... fields) { (each_leaf(fields, leaf), ...); });
  else if constexpr (visiting::is_list<Plain>::value)
    for (auto& element : value) each_leaf(element, leaf);
  else if constexpr (std::is_same_v<T, const MarkedPoints>)
    leaf(*value);
  else if constexpr (std::is_same_v<T, MarkedPoints>)
    leaf(value.change());
  else
    leaf(value);
}

/// to = from. Arrays of numbers are copied as memory, for which the C library uses wider registers than this code is compiled for.
template <class T>
void assign(T& to, const T& from) {
  if constexpr (Visited<T>) {
    T::visit(to, [&](auto&... into) { T::visit(from, [&](const auto&... value) { (assign(into, value), ...); }); });
  } else if constexpr (requires { to.resizeLike(from); }) {
    to.resizeLike(from);
    std::copy_n(from.data(), from.size(), to.data());
  } else {
    to = from;
  }
}

/// True if all numbers are finite.
template <class T>
bool all_finite(const T& value) {
  bool finite = true;
  each_leaf(value, [&](const auto& leaf) {
    using Leaf = std::remove_cvref_t<decltype(leaf)>;
    if constexpr (std::is_same_v<Leaf, double>)
      finite = finite && std::isfinite(leaf);
    else if constexpr (!std::is_integral_v<Leaf> && !std::is_enum_v<Leaf>)
      finite = finite && (leaf - leaf).sum() == 0;  // NaN unless finite; vectorised, unlike allFinite()
  });
  return finite;
}

}  // namespace softffd
