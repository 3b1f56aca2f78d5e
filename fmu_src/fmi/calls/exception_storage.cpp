#include "calls/exception_storage.hpp"

#ifndef _MSC_VER
namespace __cxxabiv1 {

struct __cxa_eh_globals;
/// Itanium C++ ABI: Exception Handling, 2.2.2. Declared here, because LLVM's library defines it but does not declare it in its header.
extern "C" __cxa_eh_globals* __cxa_get_globals() noexcept;

}  // namespace __cxxabiv1
#endif

namespace softffd::fmi {

#ifdef __ELF__
namespace {

thread_local volatile char described = 0;  // CMakeLists.txt makes the compiler access it by TLSDESC

}  // namespace
#endif

void claim_exception_storage() {
#ifdef __ELF__
  described = 1;
#endif
#ifndef _MSC_VER
  [[maybe_unused]] const void* volatile claimed = __cxxabiv1::__cxa_get_globals();  // volatile: the call is made for its effect
#endif
}

}  // namespace softffd::fmi
