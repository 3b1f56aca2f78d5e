#include "matrix/dissected_matrix.hpp"

#include <algorithm>
#include <new>

#include "matrix/panels.hpp"

namespace softffd {

namespace {

constexpr std::align_val_t cache_line{64};
constexpr int width = kernels::block;

int padded(int unknowns, int to = width) { return (unknowns + to - 1) / to * to; }

}  // namespace

void DissectedMatrix::Free::operator()(double* values) const { ::operator delete[](values, cache_line); }

DissectedMatrix::Values DissectedMatrix::taken(std::size_t count) {
  return Values(static_cast<double*>(::operator new[](count * sizeof(double), cache_line)));
}

DissectedMatrix::DissectedMatrix(const Lattice& lattice) : order_(lattice), first_(lattice.points()) {
  std::size_t values = 0;
  int unknowns = 0, longest = 0;
  for (const auto& front : order_.fronts()) {
    const int own = padded(3 * front.own), rows = own + padded(3 * front.boundary());
    const std::size_t stride = rows % 64 ? rows : rows + width;  // prevents columns from sharing cache sets
    blocks_.push_back({own, rows, stride, values, 0, unknowns});
    for (int row = 0; row < front.own; ++row) first_[front.points[row]] = unknowns + 3 * row;
    values += own * stride;
    unknowns += own;
    longest = std::max(longest, rows);
  }
  std::size_t left = 0;
  for (int f = int(blocks_.size()) - 1; f >= 0; --f) {  // the update matrix of a front is stored behind its parent's
    const int parent = order_.fronts()[f].parent;
    const auto size = [&](int front) {
      return std::size_t(blocks_[front].rows - blocks_[front].own) * (blocks_[front].rows - blocks_[front].own);
    };
    if (parent >= 0) blocks_[f].left = blocks_[parent].left + size(parent);
    left = std::max(left, blocks_[f].left + size(f));
  }
  values_ = taken(values);
  left_ = taken(left);
  inverse_diagonal_ = unknowns_ = Scalars::Zero(unknowns);
  local_ = Scalars::Zero(longest);
}

void DissectedMatrix::clear() {
  unknowns_.setZero();  // the padding may hold NaN of a matrix that was not positive definite
  for (std::size_t f = 0; f < blocks_.size(); ++f) {
    const Block& block = blocks_[f];
    double* columns = values_.get() + block.columns;
    for (int j = 0; j < block.own; ++j) {
      double* column = columns + j * block.stride;
      std::fill(column + j / width * width, column + block.rows, 0.0);  // entries above the diagonal's panel have no meaning
    }
    for (int i = 3 * order_.fronts()[f].own; i < block.own; ++i) columns[i * block.stride + i] = 1;
  }
}

Mat3 DissectedMatrix::block(int p, int q) const {
  Mat3 block;
  visit(p, q, [&](int a, int b, double entry) { block(a, b) = entry; });
  return p == q ? Mat3(block.selfadjointView<Eigen::Lower>()) : block;
}

void DissectedMatrix::factor() {
  for (std::size_t f = 0; f < blocks_.size(); ++f) {
    const Block& block = blocks_[f];
    double *columns = values_.get() + block.columns, *left = left_.get() + block.left;
    for (int j = 0; j < block.own; j += width) {
      double* panel = columns + j * block.stride + j;
      const int blocks = (block.rows - j) / width;
      kernels::subtract_products(blocks, j, block.stride, columns + j, block.stride, panel);
      kernels::factor_panel(blocks, block.stride, panel, inverse_diagonal_.data() + block.first + j);
    }
    const int rest = block.rows - block.own, columns_used = padded(3 * order_.fronts()[f].own, 4);
    const bool leaf = f == 0 || order_.fronts()[f - 1].parent != int(f);
    if (leaf) std::fill_n(left, std::size_t(rest) * rest, 0.0);
    for (int j = 0; j < rest; j += width)
      kernels::subtract_products((rest - j) / width, columns_used, block.stride, columns + block.own + j, rest,
                                 left + j * std::size_t(rest) + j);
    if (rest > 0) add_to_parent(order_.fronts()[f], block);
  }
}

void DissectedMatrix::add_to_parent(const Dissection::Front& front, const Block& block) {
  const Dissection::Front& parent = order_.fronts()[front.parent];
  const Block& to = blocks_[front.parent];
  const std::size_t rest = block.rows - block.own, parent_rest = to.rows - to.own;
  const double* left = left_.get() + block.left;
  double *columns = values_.get() + to.columns, *gathered = left_.get() + to.left;
  if (front.first_child) std::fill_n(gathered, parent_rest * parent_rest, 0.0);
  const auto& runs = front.in_parent;
  for (std::size_t r = 0; r < runs.size(); ++r)
    for (int i = 0; i < 3 * runs[r].count; ++i) {
      const int column = unknown(parent, to, runs[r].to) + i, from = 3 * runs[r].from + i;
      double* into = column < to.own ? columns + column * to.stride : gathered + (column - to.own) * parent_rest - to.own;
      const double* entries = left + from * rest;
      const auto add = [&](int to_row, int from_row, int count) {
        for (int k = 0; k < count; ++k) into[to_row + k] += entries[from_row + k];
      };
      add(column, from, 3 * runs[r].count - i);
      for (std::size_t s = r + 1; s < runs.size(); ++s) add(unknown(parent, to, runs[s].to), 3 * runs[s].from, 3 * runs[s].count);
    }
}

/// Copies the own unknowns and the boundary unknowns of a front side by side into `local`; the padding is 0.
template <int sides>
void DissectedMatrix::take(const Dissection::Front& front, const Block& block, const double* unknowns, double* local) const {
  std::copy_n(unknowns + block.first * sides, block.own * sides, local);
  double* to = local + block.own * sides;
  for (int i = 0; i < front.boundary(); ++i, to += 3 * sides)
    std::copy_n(unknowns + first_[front.points[front.own + i]] * sides, 3 * sides, to);
  std::fill(to, local + block.rows * sides, 0.0);
}

template <int sides>
void DissectedMatrix::give(const Dissection::Front& front, const Block& block, const double* local, double* unknowns, bool boundary) const {
  std::copy_n(local, block.own * sides, unknowns + block.first * sides);
  const double* from = local + block.own * sides;
  for (int i = 0; boundary && i < front.boundary(); ++i, from += 3 * sides)
    std::copy_n(from, 3 * sides, unknowns + first_[front.points[front.own + i]] * sides);
}

template <int sides, class Lower, class Upper>
void DissectedMatrix::substitute(double* unknowns, double* local, Lower lower, Upper upper) const {
  const int fronts = int(blocks_.size());
  for (int f = 0; f < fronts; ++f) {
    const Block& block = blocks_[f];
    const double* own = unknowns + block.first * sides;
    if (std::all_of(own, own + block.own * sides, [](double value) { return value == 0; })) continue;
    take<sides>(order_.fronts()[f], block, unknowns, local);
    lower(block.own, block.rows, block.stride, values_.get() + block.columns, inverse_diagonal_.data() + block.first, local);
    give<sides>(order_.fronts()[f], block, local, unknowns, true);
  }
  for (int f = fronts - 1; f >= 0; --f) {
    const Block& block = blocks_[f];
    take<sides>(order_.fronts()[f], block, unknowns, local);
    upper(block.own, block.rows, block.stride, values_.get() + block.columns, inverse_diagonal_.data() + block.first, local);
    give<sides>(order_.fronts()[f], block, local, unknowns, false);
  }
}

void DissectedMatrix::solve(Points& b) {
  for (int a = 0; a < 3; ++a)
    for (int p = 0; p < int(first_.size()); ++p) unknowns_[first_[p] + a] = b(p, a);
  substitute<1>(unknowns_.data(), local_.data(), kernels::solve_lower, kernels::solve_upper);
  for (int a = 0; a < 3; ++a)
    for (int p = 0; p < int(first_.size()); ++p) b(p, a) = unknowns_[first_[p] + a];
}

void DissectedMatrix::solve_together(std::span<Points* const> sides) {
  static_assert(together == kernels::block);
  unknowns_of_all_.setZero(unknowns_.size() * together);
  local_of_all_.resize(local_.size() * together);
  const auto visit = [&](auto take) {
    for (int a = 0; a < 3; ++a)
      for (int p = 0; p < int(first_.size()); ++p) {
        double* together_at = &unknowns_of_all_[(first_[p] + a) * Eigen::Index(together)];
        for (std::size_t s = 0; s < sides.size(); ++s) take((*sides[s])(p, a), together_at[s]);
      }
  };
  visit([](double from, double& to) { to = from; });
  substitute<together>(unknowns_of_all_.data(), local_of_all_.data(), kernels::solve_lower_together, kernels::solve_upper_together);
  visit([](double& to, double from) { to = from; });
}

}  // namespace softffd
