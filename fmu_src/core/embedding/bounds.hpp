/// The box of many points, for the Python package.
#pragma once
#include "machine/exported.hpp"

/// points: (count, 3), in rows. low, high: (3) of them all, infinite without any, NaN where a coordinate is.
SOFTFFD_EXPORTED void softffd_bounds(long long count, const double* points, double* low, double* high);
