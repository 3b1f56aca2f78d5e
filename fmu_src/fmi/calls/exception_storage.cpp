#include "calls/exception_storage.hpp"

#ifndef _MSC_VER
#include <cxxabi.h>
#endif

namespace softffd::fmi {

#ifdef __ELF__
namespace {

thread_local volatile char described = 0;  // CMakeLists.txt compiles accesses as TLSDESC

}  // namespace
#endif

void claim_exception_storage() {
#ifdef __ELF__
  described = 1;
#endif
#ifndef _MSC_VER
  [[maybe_unused]] const void* volatile claimed = abi::__cxa_get_globals();  // volatile: called for what it does
#endif
}

}  // namespace softffd::fmi
