/// Eigen includes this name too; all that it calls is in emmintrin.h.
#pragma once
#include "emmintrin.h"
