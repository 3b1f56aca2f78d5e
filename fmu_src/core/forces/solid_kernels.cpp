#include "forces/solid_kernels.hpp"

#include "forces/patch_rows.hpp"

namespace softffd::kernels {

namespace patch {
namespace {

/// Calls patch(offset of its first node) for all patches, x fastest.
template <class Patch>
INNER void each_patch(const SolidBody& body, Patch&& patch) {
  for (int k = 0; k < body.patches[2]; ++k)
    for (int j = 0; j < body.patches[1]; ++j)
      for (int i = 0; i < body.patches[0]; ++i) patch(3 * (i + j * body.line + k * body.layer));
}

template <int n>
INNER void gradients(const SolidBody& body, const double* field, Rows<n>* F) {
  for (int c = 0; c < 3; ++c) derive<n>(body, field + c * body.points, F + 3 * c);
}

/// q = J - 1 at the nodes, and its projection t = Pi q.
template <int n>
INNER void volumes(const SolidBody& body, const Rows<n>* F, Rows<n>& q, Rows<n>& t) {
  for (int r = 0; r < rows; ++r) q[r] = determinant(row_of<n>(F, r)) - 1.0;
  project<n>(body.shape, q, t);
}

template <int n>
struct Pressure {
  Four<n> missing;  ///< J0 - J, or 0 if that is negative
  Four<n> p;        ///< derivative of the energy's density by J, at a node [Pa]
};
template <int n>
INNER Pressure<n> pressure(const SolidBody& body, const Four<n>& q, const Four<n>& t) {
  const Four<n> missing = larger((least_volume - 1) - q, 0.0);
  return {missing, body.mu * (q - 1.0) + body.lambda * t - (body.lambda / least_volume) * (missing * missing)};
}

/// Twice the rate of Green's strain, as xx yy zz xy xz yz, and the rate of the strain's trace.
template <int n>
struct StrainRate {
  Four<n> s[6];
  Four<n> trace;
};
constexpr int first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
template <int n>
INNER StrainRate<n> strain_rate(const Nine<n>& f, const Nine<n>& g, double drift = 0) {
  StrainRate<n> rate;
  const auto along = [](const Nine<n>& a, int i, const Nine<n>& b, int j)
                         INLINED { return (a(0, i) * b(0, j) + a(1, i) * b(1, j)) + a(2, i) * b(2, j); };
  for (int e = 0; e < 6; ++e) rate.s[e] = along(f, first[e], g, second[e]) + along(g, first[e], f, second[e]);
  for (int e = 0; e < 6 && drift != 0; ++e) rate.s[e] = rate.s[e] + drift * along(g, first[e], g, second[e]);
  rate.trace = 0.5 * ((rate.s[0] + rate.s[1]) + rate.s[2]);
  return rate;
}

/// Calls use(entry, row, value) for all entries of F S, with S = time (2 mu dE/dt + lambda Pi (tr dE/dt) 1); overwrites G.
template <int n, class Use>
INNER void viscous_stress(const SolidBody& body, double time, double drift, const Rows<n>* F, Rows<n>* G, Use&& use) {
  Rows<n> trace, t;
  for (int r = 0; r < rows; ++r) {
    const StrainRate<n> rate = strain_rate(row_of<n>(F, r), row_of<n>(G, r), drift);
    for (int e = 0; e < 6; ++e) G[e][r] = (time * body.mu) * rate.s[e];
    trace[r] = rate.trace;
  }
  project<n>(body.shape, trace, t);
  for (int r = 0; r < rows; ++r) {
    const Nine<n> f = row_of<n>(F, r);
    const Four<n> of_trace = (time * body.lambda) * t[r];
    Four<n> s[6];
    for (int e = 0; e < 3; ++e) s[e] = G[e][r] + of_trace;
    for (int e = 3; e < 6; ++e) copy(G[e][r], s[e]);
    constexpr int entry[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int c = 0; c < 3; ++c)
      for (int a = 0; a < 3; ++a) use(3 * c + a, r, (f(c, 0) * s[entry[0][a]] + f(c, 1) * s[entry[1][a]]) + f(c, 2) * s[entry[2][a]]);
  }
}

template <int n>
INNER void apply_weights(const SolidBody& body, Rows<n>* P) {
  for (int r = 0; r < rows; ++r) {
    const Four<n> w = load_four<n>(body.shape.weight[r]);
    for (int i = 0; i < 9; ++i) P[i][r] = w * P[i][r];
  }
}

template <int n>
INNER void subtract_divergences(const SolidBody& body, const Rows<n>* P, double* f) {
  for (int c = 0; c < 3; ++c) subtract_divergence<n>(body, P + 3 * c, f + c * body.points);
}

template <int n>
INNER void elastic(const SolidBody& body, const double* x, double* f, double* kept) {
  Rows<n> P[9], q, t;
  Rows<n>* F = kept ? reinterpret_cast<Rows<n>*>(kept) : P;
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    gradients<n>(body, x + at, F);
    volumes<n>(body, F, q, t);
    for (int r = 0; r < rows; ++r) {
      const Nine<n> here = row_of<n>(F, r), c = cofactors(here);
      const Four<n> w = load_four<n>(body.shape.weight[r]), mu = body.mu * w, p = w * pressure<n>(body, q[r], t[r]).p;
      for (int i = 0; i < 9; ++i) P[i][r] = mu * here.m[i] + p * c.m[i];
    }
    subtract_divergences<n>(body, P, f + at);
    if (kept) F += 9;
  });
}

template <int n>
INNER void all_gradients(const SolidBody& body, const double* x, double* kept) {
  Rows<n>* F = reinterpret_cast<Rows<n>*>(kept);
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    gradients<n>(body, x + at, F);
    F += 9;
  });
}

template <int n>
INNER void viscous(const SolidBody& body, double time, double drift, double* kept, const double* v, double* f) {
  const Rows<n>* F = reinterpret_cast<Rows<n>*>(kept);
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    Rows<n> G[9];
    gradients<n>(body, v + at, G);
    viscous_stress<n>(body, time, drift, F, G,
                      [&](int i, int r, const Four<n>& stress) INLINED { G[i][r] = load_four<n>(body.shape.weight[r]) * stress; });
    subtract_divergences<n>(body, G, f + at);
    F += 9;
  });
}

template <int n>
INNER void tangent(const SolidBody& body, double softening, double per_time, const double* x, const double* u, double* f) {
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    Rows<n> F[9], G[9], q, t, change, of_change;
    gradients<n>(body, x + at, F);
    gradients<n>(body, u + at, G);
    volumes<n>(body, F, q, t);
    for (int r = 0; r < rows; ++r) change[r] = dot(cofactors(row_of<n>(F, r)), row_of<n>(G, r));
    project<n>(body.shape, change, of_change);
    Rows<n> V[9];
    for (int i = 0; i < 9; ++i)
      for (int r = 0; r < rows; ++r) copy(G[i][r], V[i][r]);
    if (per_time > 0)
      viscous_stress<n>(body, per_time, 0, F, V, [&](int i, int r, const Four<n>& stress) INLINED { copy(stress, V[i][r]); });
    for (int r = 0; r < rows; ++r) {
      const Nine<n> here = row_of<n>(F, r), g = row_of<n>(G, r), c = cofactors(here), dc = cofactors(here, g);
      const Pressure<n> now = pressure<n>(body, q[r], t[r]);
      const Four<n> kept = within(now.p, body.mu / root(longest_square(here, c, q[r] + 1.0)));
      const Four<n> p = kept + softening * (now.p - kept);
      const Four<n> dp = body.mu * change[r] + body.lambda * of_change[r] + (2 * body.lambda / least_volume) * (now.missing * change[r]);
      for (int i = 0; i < 9; ++i) {
        const Four<n> all = (body.mu * g.m[i] + dp * c.m[i]) + p * dc.m[i];
        G[i][r] = per_time > 0 ? all + V[i][r] : all;
      }
    }
    apply_weights<n>(body, G);
    subtract_divergences<n>(body, G, f + at);
  });
}

/// For one node of the quadrature: the nodes on its lines along the three axes, and the derivatives along these lines at the node.
struct Lines {
  int node[3][4];
  double slope[3][4];
  INLINED Lines(const PatchShape& shape, int i, int j, int k) {
    for (int s = 0; s < 4; ++s) {
      node[0][s] = s + 4 * j + 16 * k, node[1][s] = i + 4 * s + 16 * k, node[2][s] = i + 4 * j + 16 * s;
      slope[0][s] = shape.along[s][i], slope[1][s] = shape.across[0][j][s], slope[2][s] = shape.across[1][k][s];
    }
  }
};

/// Computes a vector of the patch's unknowns for each product of linear functions onto which Pi projects, the product having unit mean
/// square: sqrt(factor / volume) times the sum of w times the product times M : gradient. The matrix of factor (Pi M : gradient)^2 is the
/// sum of the squares v v' of these vectors.
constexpr int products = 8;
template <int n>
INNER void find_projected(const SolidBody& alone, double factor, const Rows<n>* M, double (*v)[3][64]) {
  constexpr double root3 = 1.7320508075688772935, inner = root3 / lobatto::root5, at[4] = {-root3, -inner, inner, root3};
  double volume = 0;
  for (int r = 0; r < rows; ++r) volume += sum_of(load_four<n>(alone.shape.weight[r]));
  const double scale = root(factor / volume);
  for (int t = 0; t < products; ++t) {
    Rows<n> P[9];
    for (int r = 0; r < rows; ++r) {
      const double across = scale * (t & 2 ? at[r & 3] : 1) * (t & 4 ? at[r >> 2] : 1);
      Four<n> w = across * load_four<n>(alone.shape.weight[r]);
      if (t & 1) w = w * load_four<n>(at);
      for (int i = 0; i < 9; ++i) P[i][r] = w * M[i][r];
    }
    std::memset(v[t], 0, sizeof v[t]);
    subtract_divergences<n>(alone, P, v[t][0]);
  }
}

/// into = the sum of v v' over these vectors; entries with p < q have no meaning.
template <int wide>
INNER void sum_squares(int count, const double (*v)[3][64], PatchMatrix& into) {
  constexpr int together = 4;
  for (int c = 0; c < 3; ++c)
    for (int e = 0; e < 3; ++e)
      for (int q = 0; q < 64; q += together)
        for (int p = q / wide * wide; p < 64; p += wide) {
          Lanes<wide> sums[together]{};
          for (int t = 0; t < count; ++t) {
            const Lanes<wide> of_p = load<wide>(v[t][c] + p);
            for (int i = 0; i < together; ++i) sums[i] = sums[i] + of_p * v[t][e][q + i];
          }
          for (int i = 0; i < together; ++i) store<wide>(into.of[3 * c + e].at[q + i] + p, sums[i]);
        }
}

/// Computes the contributions of a row of quadrature nodes apart from the projected terms, as 3 x 3 blocks by the axes a, b of two
/// derivatives.
template <int n>
INNER void blocks_of_row(const SolidBody& body, double viscous, const Four<n>& w, const Nine<n>& f, const Nine<n>& c, const Four<n>& k,
                         const Four<n>& s, double (*block)[9][4]) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int m = 0; m < 3; ++m)
        for (int e = 0; e < 3; ++e) {
          Four<n> entry = k * (c(m, a) * c(e, b));
          if (a == b && m == e) entry = entry + body.mu;
          if (a != b && m != e) {
            const Four<n> turned = s * f(3 - m - e, 3 - a - b);
            entry = ((e - m + 3) % 3 == 1) == ((b - a + 3) % 3 == 1) ? entry + turned : entry - turned;
          }
          if (viscous > 0) {
            entry = entry + viscous * (f(m, b) * f(e, a));
            if (a == b) entry = entry + viscous * ((f(m, 0) * f(e, 0) + f(m, 1) * f(e, 1)) + f(m, 2) * f(e, 2));
          }
          store_four<n>(block[3 * a + b][3 * m + e], w * entry);
        }
}

template <int n, int wide>
INNER void matrix(const SolidBody& body, double softening, double per_time, const double* x, PatchMatrix& into) {
  Rows<n> F[9], C[9], q, t;
  gradients<n>(body, x, F);
  volumes<n>(body, F, q, t);
  for (int r = 0; r < rows; ++r) {
    const Nine<n> c = cofactors(row_of<n>(F, r));
    for (int i = 0; i < 9; ++i) copy(c.m[i], C[i][r]);
  }
  SolidBody alone = body;
  alone.points = 64, alone.line = 4, alone.layer = 16;
  double projected[2 * products][3][64];
  find_projected<n>(alone, body.lambda, C, projected);
  if (per_time > 0) find_projected<n>(alone, per_time * body.lambda, F, projected + products);
  sum_squares<wide>(per_time > 0 ? 2 * products : products, projected, into);
  for (int r = 0; r < rows; ++r) {
    const Nine<n> f = row_of<n>(F, r), c = row_of<n>(C, r);
    const Pressure<n> now = pressure<n>(body, q[r], t[r]);
    const Four<n> kept = within(now.p, body.mu / root(longest_square(f, c, q[r] + 1.0)));
    double block[9][9][4];
    blocks_of_row<n>(body, per_time * body.mu, load_four<n>(body.shape.weight[r]), f, c,
                     (2 * body.lambda / least_volume) * now.missing + body.mu, kept + softening * (now.p - kept), block);
    for (int i = 0; i < 4; ++i) {
      const Lines lines(body.shape, i, r & 3, r >> 2);
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          for (int u = 0; u < 4; ++u)
            for (int v = 0; v < 4; ++v) {
              const int of_p = lines.node[a][u], of_q = lines.node[b][v];
              if (of_q > of_p) continue;
              const double slopes = lines.slope[a][u] * lines.slope[b][v];
              for (int m = 0; m < 9; ++m) into.of[m].at[of_q][of_p] += slopes * block[3 * a + b][m][i];
            }
    }
  }
}

template <int n>
INNER void volumes_of(const SolidBody& body, const double* x, double* volumes) {
  Rows<n> F[9];
  gradients<n>(body, x, F);
  for (int r = 0; r < rows; ++r) store_four<n>(volumes + 4 * r, determinant(row_of<n>(F, r)) - 1.0);
}

template <int n>
INNER double energy(const SolidBody& body, const double* x) {
  double total = 0;
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    Rows<n> F[9], q, t;
    gradients<n>(body, x + at, F);
    volumes<n>(body, F, q, t);
    Four<n> sum{};
    for (int r = 0; r < rows; ++r) {
      const Nine<n> here = row_of<n>(F, r);
      const Four<n> missing = pressure<n>(body, q[r], t[r]).missing;
      const Four<n> shape = 0.5 * (dot(here, here) - 3.0) - q[r] + 0.5 * (q[r] * q[r]);
      const Four<n> volume = 0.5 * (q[r] * t[r]) + (1 / (3 * least_volume)) * (missing * missing * missing);
      sum = sum + load_four<n>(body.shape.weight[r]) * (body.mu * shape + body.lambda * volume);
    }
    total += sum_of(sum);
  });
  return total;
}

template <int n>
INNER double power(const SolidBody& body, const double* x, const double* v) {
  double total = 0;
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    Rows<n> F[9], G[9], squares, trace, t;
    gradients<n>(body, x + at, F);
    gradients<n>(body, v + at, G);
    for (int r = 0; r < rows; ++r) {
      const StrainRate<n> rate = strain_rate(row_of<n>(F, r), row_of<n>(G, r));
      const Four<n>* s = rate.s;
      squares[r] = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
      trace[r] = rate.trace;
    }
    project<n>(body.shape, trace, t);
    Four<n> sum{};
    for (int r = 0; r < rows; ++r)
      sum = sum + load_four<n>(body.shape.weight[r]) * ((0.5 * body.mu) * squares[r] + body.lambda * (trace[r] * t[r]));
    total += sum_of(sum);
  });
  return total;
}

/// Computes the mean of M over the quadrature; returns the largest squared distance of a node's M from this mean.
template <int n>
INNER double spread(const SolidBody& body, const Rows<n>* M, double (&mean)[9]) {
  double volume = 0;
  for (int r = 0; r < rows; ++r) volume += sum_of(load_four<n>(body.shape.weight[r]));
  for (int i = 0; i < 9; ++i) {
    Four<n> sum{};
    for (int r = 0; r < rows; ++r) sum = sum + load_four<n>(body.shape.weight[r]) * M[i][r];
    mean[i] = sum_of(sum) / volume;
  }
  Four<n> most{};
  for (int r = 0; r < rows; ++r) {
    Four<n> square{};
    for (int i = 0; i < 9; ++i) square = square + (M[i][r] - mean[i]) * (M[i][r] - mean[i]);
    most = larger(most, square);
  }
  return largest_of(most);
}

template <int n>
INNER void bounds(const SolidBody& body, const double* x, PatchBounds* each) {
  each_patch(body, [&](std::ptrdiff_t at) INLINED {
    Rows<n> F[9], q, t;
    gradients<n>(body, x + at, F);
    volumes<n>(body, F, q, t);
    double mean[9];
    each->of_stretch = spread<n>(body, F, mean);
    each->average = norm(mean);
    Four<n> curvature{}, stretch{};
    for (int r = 0; r < rows; ++r) {
      const Nine<n> here = row_of<n>(F, r), c = cofactors(here);
      const Pressure<n> now = pressure<n>(body, q[r], t[r]);
      const Four<n> k = (2 * body.lambda / least_volume) * now.missing + body.mu, s = now.p;
      const Four<n> lengths = dot(here, here), areas = dot(c, c);
      const Four<n> volume = q[r] + 1.0, longest = longest_square(here, c, volume);
      // k c c' + s M: the part that changes the principal stretches
      const Four<n> minors = -1.0 * (2.0 * ((k * s) * (volume * lengths)) + s * s * lengths);
      const Four<n> scaling = top(k * areas, minors, (s * s) * (volume * (2.0 * s + 3.0 * (k * volume))));
      curvature = larger(curvature, larger(scaling, root((s * s) * longest)) + body.mu);
      stretch = larger(stretch, longest);
      for (int i = 0; i < 9; ++i) copy(c.m[i], F[i][r]);
    }
    each->curvature = largest_of(curvature);
    each->stretch = largest_of(stretch);
    each->unevenness = spread<n>(body, F, mean);
    each->mean = norm(mean);
    ++each;
  });
}

}  // namespace
}  // namespace patch

decltype(subtract_elastic) subtract_elastic = chosen<patch::elastic<2>, patch::elastic<4>>();
decltype(find_gradients) find_gradients = chosen<patch::all_gradients<2>, patch::all_gradients<4>>();
decltype(subtract_viscous) subtract_viscous = chosen<patch::viscous<2>, patch::viscous<4>>();
decltype(subtract_tangent) subtract_tangent = chosen<patch::tangent<2>, patch::tangent<4>>();
decltype(patch_matrix) patch_matrix = chosen<patch::matrix<2, 2>, patch::matrix<4, 4>, patch::matrix<4, 8>>();
decltype(patch_volumes) patch_volumes = chosen<patch::volumes_of<2>, patch::volumes_of<4>>();
decltype(solid_energy) solid_energy = chosen<patch::energy<2>, patch::energy<4>>();
decltype(viscous_power) viscous_power = chosen<patch::power<2>, patch::power<4>>();
decltype(bound_patches) bound_patches = chosen<patch::bounds<2>, patch::bounds<4>>();

}  // namespace softffd::kernels
