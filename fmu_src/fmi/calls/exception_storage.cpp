#include "calls/exception_storage.hpp"

#include <exception>  // defines __GLIBCXX__

#ifndef _MSC_VER
namespace __cxxabiv1 {

struct __cxa_eh_globals;
/// Itanium C++ ABI: Exception Handling, 2.2.2. Declared here, because LLVM's library defines it but does not declare it in its header.
extern "C" __cxa_eh_globals* __cxa_get_globals() noexcept;

}  // namespace __cxxabiv1
#endif

#ifdef __GLIBCXX__
namespace __gnu_cxx {

/// Frees the memory of libstdc++ for exceptions. The library exports it for memory checkers and does not declare it in a header.
void __freeres();

}  // namespace __gnu_cxx
#endif

namespace softffd::fmi {

#ifdef __GLIBCXX__
namespace {

__attribute__((destructor)) void free_exception_pool() { __gnu_cxx::__freeres(); }

}  // namespace
#endif

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
