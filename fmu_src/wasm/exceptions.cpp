/// Exceptions for WebAssembly. zig has the sources of LLVM's libraries, but leaves these out of what it links for wasi.
#include <cxa_exception.cpp>
#include <cxa_personality.cpp>
// Of libunwind; what the C file includes is not for extern "C".
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
