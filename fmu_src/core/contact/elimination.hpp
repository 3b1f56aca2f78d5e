/// Small sets of linear equations.
#pragma once
#include <vector>

namespace softffd {

/// a x = b, a (n * n) row by row, b (n), by elimination with row exchanges; b becomes x. Loops of one order, so that every machine has the
/// same bits. Returns false if there is no finite solution.
bool eliminate(int n, std::vector<double>& a, std::vector<double>& b);

}  // namespace softffd
