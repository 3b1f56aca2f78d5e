#include "contact/surface/sample_rows.hpp"

#include "contact/surface/surface_loops.hpp"

namespace softffd {

void SampleRows::set(const std::vector<SurfaceRow>& rows) {
  if (rows == rows_) return;
  rows_ = rows;
  weights_.resize(0);
  const int points = samples_.lattice().points();
  if (samples_.support() != points) return;
  weights_.resize(rows.size() * points);
  const Scalars once = Scalars::Ones(points);
  for (std::size_t t = 0; t < rows.size(); ++t) samples_.weights(rows[t].sample, once, &weights_[t * points]);
  range_ = Samples::range(weights_.data(), int(rows.size()), points);
}

void SampleRows::at(const Points& x, std::vector<Vec3>& out) const {
  out.resize(rows_.size());
  if (weights_.size() > 0)
    return kernels::row_places(int(x.rows()), range_, int(rows_.size()), weights_.data(), x.data(), out.front().data());
  for (std::size_t t = 0; t < rows_.size(); ++t) out[t] = samples_.at(rows_[t].sample, x);
}

void SampleRows::at(const Scalars& values, std::vector<double>& out) const {
  out.resize(rows_.size());
  if (weights_.size() > 0)
    return kernels::row_values(int(values.size()), range_, int(rows_.size()), weights_.data(), values.data(), out.data());
  for (std::size_t t = 0; t < rows_.size(); ++t) out[t] = samples_.at(rows_[t].sample, values.data());
}

}  // namespace softffd
