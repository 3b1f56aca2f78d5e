#include "contact/surface/sample_rows.hpp"

#include <utility>

#include "contact/surface/surface_loops.hpp"

namespace softffd {

void SampleRows::set(const std::vector<SurfaceRow>& rows) {
  if (rows == now_.rows) return;
  std::swap(now_, before_);
  if (rows == now_.rows) return;
  now_.rows = rows;
  now_.weights.resize(0);
  const int points = samples_.lattice().points();
  if (samples_.support() != points) return;
  now_.weights.resize(rows.size() * points);
  const Scalars once = Scalars::Ones(points);
  for (std::size_t t = 0; t < rows.size(); ++t) samples_.weights(rows[t].sample, once, &now_.weights[t * points]);
  now_.range = Samples::range(now_.weights.data(), int(rows.size()), points);
}

void SampleRows::at(const Points& x, std::vector<Vec3>& out) const {
  out.resize(now_.rows.size());
  if (now_.weights.size() > 0)
    return kernels::row_places(int(x.rows()), now_.range, int(now_.rows.size()), now_.weights.data(), x.data(), out.front().data());
  for (std::size_t t = 0; t < now_.rows.size(); ++t) out[t] = samples_.at(now_.rows[t].sample, x);
}

void SampleRows::at(const Scalars& values, std::vector<double>& out) const {
  out.resize(now_.rows.size());
  if (now_.weights.size() > 0)
    return kernels::row_values(int(values.size()), now_.range, int(now_.rows.size()), now_.weights.data(), values.data(), out.data());
  for (std::size_t t = 0; t < now_.rows.size(); ++t) out[t] = samples_.at(now_.rows[t].sample, values.data());
}

}  // namespace softffd
