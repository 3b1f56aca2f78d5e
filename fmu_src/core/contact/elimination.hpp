/// Small systems of linear equations.
#pragma once
#include <vector>

namespace softffd {

/// Solves a x = b by elimination with row exchanges; a: (n * n) row by row, b: (n), which becomes x. The loops have one fixed order, so
/// that every machine gets the same bits. Returns false if there is no finite solution.
bool eliminate(int n, std::vector<double>& a, std::vector<double>& b);

}  // namespace softffd
