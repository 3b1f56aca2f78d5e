/// The names of the time integration methods.
#pragma once
#include <cstddef>

namespace softffd {

/// Time integration methods; `automatic` takes one of the others for each communication step, `backward_euler` only where a stiff body is
/// in contact, `sdirk2` where a damped one is, `floating_frame` only where one flies and turns.
enum class Method { automatic, central_difference, leapfrog, bm4, rkn12, dop853, ros34pw2, backward_euler, sdirk2, floating_frame };
constexpr Method last(Method) { return Method::floating_frame; }
inline constexpr std::size_t method_count = std::size_t(Method::floating_frame) + 1;

}  // namespace softffd
