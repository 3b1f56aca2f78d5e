/// Geometric operations on Triple, that is on one vector in space in each lane, with the order of sums that Eigen has for one vector.
#pragma once
#include "machine/lanes.hpp"

namespace softffd::kernels {

/// A vector that is the same in all lanes. Its operations combine a number with a register, for which processors have instructions. Some
/// compilers would fill a register with the number lane by lane first.
struct Uniform {
  double x, y, z;
};

template <int n>
INNER Triple<n> operator+(const Triple<n>& a, const Triple<n>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int n>
INNER Triple<n> operator-(const Triple<n>& a, const Triple<n>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// factor: one number, or one number for each lane.
template <class Factor, int n>
INNER Triple<n> operator*(const Factor& factor, const Triple<n>& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
template <int n>
INNER Triple<n> operator/(const Triple<n>& a, const Lanes<n>& divisor) {
  return {a.x / divisor, a.y / divisor, a.z / divisor};
}
template <int n>
INNER Lanes<n> dot(const Triple<n>& a, const Triple<n>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int n>
INNER Triple<n> operator+(const Uniform& a, const Triple<n>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int n>
INNER Triple<n> operator-(const Triple<n>& a, const Uniform& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Factor>
INNER Triple<sizeof(Factor) / sizeof(double)> operator*(const Factor& factor, const Uniform& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
template <int n>
INNER Lanes<n> dot(const Uniform& a, const Triple<n>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// Returns the cross product a x b in each lane. a: a Triple or a Uniform.
template <class A, int n>
INNER Triple<n> cross(const A& a, const Triple<n>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int n>
INNER Lanes<n> length(const Triple<n>& a) {
  return square_root<n>(dot(a, a));
}
/// Returns `yes` where the condition holds, otherwise `no`, in each lane.
template <class Condition, int n>
INNER Triple<n> choose(const Condition& condition, const Triple<n>& yes, const Triple<n>& no) {
  return {condition ? yes.x : no.x, condition ? yes.y : no.y, condition ? yes.z : no.z};
}

}  // namespace softffd::kernels
