/// Exceptions for WebAssembly. zig contains the sources of LLVM's libraries, but does not link these sources for wasi.
#include <cxa_exception.cpp>
#include <cxa_personality.cpp>
// From libunwind. The headers that the C file includes come first, outside of extern "C".
#include <config.h>
#include <threads.h>
#include <unwind.h>
extern "C" {
#include <Unwind-wasm.c>
}

__asm__(R"(
.globl __cpp_exception
.tagtype __cpp_exception i32
__cpp_exception:
)");
