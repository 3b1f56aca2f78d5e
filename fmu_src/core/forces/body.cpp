#include "forces/body.hpp"

namespace softffd {

double dashpot_power(const Springs& springs, const Points& x, const Points& v, Points& scratch) {
  scratch.setZero(v.rows(), 3);
  springs.add_dashpot_force(x, v, scratch);
  return -(scratch * v).sum();
}

}  // namespace softffd
