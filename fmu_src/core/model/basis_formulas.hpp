/// The formulas of the basis functions (basis.hpp) without branches, so that a compiler vectorises over several positions.
#pragma once
#include "machine/instructions.hpp"

namespace softffd::formulas {

INNER double larger(double a, double b) { return a < b ? b : a; }
INNER double smaller(double a, double b) { return b < a ? b : a; }
/// Returns the largest whole number not above x, for numbers below 2^51.
INNER double rounded_down(double x) {
  const double rounded = (x + 0x1.8p52) - 0x1.8p52;  // numbers of this size have no fractions
  return rounded > x ? rounded - 1 : rounded;
}

/// Computes the Bernstein polynomials of degree n - 1 at several positions t, by de Casteljau's recurrence: the sum is exact to rounding
/// for any n. weights[i][place].
template <int places>
INNER void bernstein(const double* t, int n, double (*weights)[places]) {
  for (int at = 0; at < places; ++at) weights[0][at] = 1;
  for (int degree = 1; degree < n; ++degree) {
    for (int at = 0; at < places; ++at) weights[degree][at] = t[at] * weights[degree - 1][at];
    for (int i = degree - 1; i > 0; --i)
      for (int at = 0; at < places; ++at) weights[i][at] = (1 - t[at]) * weights[i][at] + t[at] * weights[i - 1][at];
    for (int at = 0; at < places; ++at) weights[0][at] *= 1 - t[at];
  }
}

/// The four B-splines that are nonzero at a parameter, from number `first` on.
struct Span {
  double first, values[4];
};

/// Computes the B-splines by the recurrence of Cox (1972) and de Boor (1972), whose terms are all positive; n > 4. Knots are whole
/// numbers, and the knot differences that occur here are 1, 2 or 3: the code selects their reciprocals.
INNER Span bsplines(double s, int n) {
  constexpr double half = 1.0 / 2, third = 1.0 / 3;
  const double spans = n - 3;
  const double first = smaller(larger(rounded_down(s), 0), spans - 1);
  const double before = smaller(first, 2), after = smaller(spans - 1 - first, 2);  // spans beside this one, up to two
  const double behind1 = s - first, behind2 = behind1 + smaller(before, 1), behind3 = behind1 + before;
  const double ahead1 = first + 1 - s, ahead2 = ahead1 + smaller(after, 1), ahead3 = ahead1 + after;
  const double two = before > 0 ? half : 1, three = after > 0 ? half : 1;
  const double four = before > 1 ? third : two, six = after > 1 ? third : three;
  const double five = before > 0 ? (after > 0 ? third : half) : three;
  const double left = ahead1 * two, right = behind1 * three;
  const double b0 = ahead1 * left * four;
  const double middle = (behind2 * left + ahead2 * right) * five, last = behind1 * right * six;
  return {first, {ahead1 * b0, behind3 * b0 + ahead2 * middle, behind2 * middle + ahead3 * last, behind1 * last}};
}

/// Returns the parameter s in 0 .. n - 3 of a position t, X(s) = t; n > 4. With z = (n - 1) t counted from the nearer end, in cells,
///
///      z = 3 s - 3/2 s^2 + 5/12 s^3                           s up to 1          (two spans: 1/2 s^3)
///      z = 23/12 + 5/4 u - 1/4 u^2 + 1/12 u^3,  u = s - 1     s from 1 to 2      (three spans: 1/6 u^3)
///      z = s + 1                                              from there to the other end's
///
/// The first two are solved by Newton's method, starting from a polynomial of z whose error is at most 0.06.
INNER double parameter(double t, int n) {
  constexpr double joint = 23.0 / 12;
  const double whole = n - 1, along = t * whole, other = whole - along;
  const double z = smaller(along, other);
  const double cubic0 = n > 5 ? 5.0 / 12 : 1.0 / 2, cubic1 = n > 6 ? 1.0 / 12 : 1.0 / 6;
  const double first_ends = n > 5 ? joint : 3;
  const bool near = z < first_ends;
  const double a = near ? 0 : joint, b = near ? 3 : 1.25, c = near ? -1.5 : -0.25, d = near ? cubic0 : cubic1;
  const double begin = near ? 0 : 1;
  double u = z * (0.3558 + z * (-0.0146 + z * (0.0763 - 0.0123 * z))) - begin;
#pragma GCC unroll 4
  for (int step = 0; step < 4; ++step) u -= (a - z + u * (b + u * (c + u * d))) / (b + u * (2 * c + u * (3 * d)));
  const double s = z < 3 ? u + begin : z - 1;
  return other < along ? n - 3 - s : s;
}

}  // namespace softffd::formulas
