/// Sets the floating-point environment that the core assumes for the duration of a call: rounding to nearest, denormals kept, no traps.
/// The environment of the host is restored at the end.
///
/// Most hosts have this environment already. On x86-64 it is then left alone, because saving and loading all of it takes as long as reading
/// a hundred outputs.
#pragma once
#include <cfenv>

#if defined(__GNUC__) && defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace softffd::fmi {

class FloatEnvironment {
 public:
  FloatEnvironment() {
    if (fits_) return;
    std::fegetenv(&host_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatEnvironment() {
    if (fits_)
      give_back_flags();
    else
      std::fesetenv(&host_);
  }
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
#if defined(__GNUC__) && defined(__x86_64__)
  static constexpr unsigned default_control = 0x1f80, flags = 0x3f;
  static constexpr unsigned short default_control87 = 0x37f;

  static unsigned short control87() {
    unsigned short word;
    __asm__ volatile("fnstcw %0" : "=m"(word));
    return word;
  }
  static unsigned short flags87() {
    unsigned short word;
    __asm__ volatile("fnstsw %0" : "=m"(word));
    return word & flags;
  }
  /// Clears the flags that the C library may have raised in the x87 unit, which the core does not use, and restores the SSE register.
  void give_back_flags() const {
    if (const int raised = flags87() & ~flags87_) std::feclearexcept(raised);
    _mm_setcsr(control_);
  }

  unsigned control_ = _mm_getcsr();
  unsigned short flags87_ = flags87();
  bool fits_ = (control_ & ~flags) == default_control && control87() == default_control87;
#else
  void give_back_flags() const {}
  static constexpr bool fits_ = false;
#endif
  std::fenv_t host_;
};

}  // namespace softffd::fmi
