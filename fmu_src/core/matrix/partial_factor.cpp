#include "matrix/partial_factor.hpp"

#include "matrix/panels.hpp"

namespace softffd {

namespace {

constexpr int panel_width = kernels::block;
int in_panels(int unknowns) { return (unknowns + panel_width - 1) / panel_width * panel_width; }

}  // namespace

void PartialFactor::resize(int first, int others) {
  first_ = first;
  own_ = in_panels(first);
  rows_ = own_ + in_panels(others);
  stride_ = rows_ % 64 ? rows_ : rows_ + panel_width;  // keeps columns off each other's cache sets
  values_.assign(rows_ * stride_, 0.0);
  inverse_.resize(own_);
  right_.assign(rows_, 0.0);
  for (int i = first; i < own_; ++i) values_[i * stride_ + i] = 1;
}

void PartialFactor::factor() {
  double* a = values_.data();
  for (int j = 0; j < rows_; j += panel_width) {
    const int blocks = (rows_ - j) / panel_width;
    double* panel = a + j * stride_ + j;
    kernels::subtract_products(blocks, j < own_ ? j : own_, stride_, a + j, stride_, panel);
    if (j < own_) kernels::factor_panel(blocks, stride_, panel, &inverse_[j]);
  }
}

void PartialFactor::eliminate() { kernels::solve_lower(own_, rows_, stride_, values_.data(), inverse_.data(), right_.data()); }

void PartialFactor::substitute() { kernels::solve_upper(own_, rows_, stride_, values_.data(), inverse_.data(), right_.data()); }

}  // namespace softffd
