/// Thread-local storage for exceptions. Throwing an exception needs no memory except a few thread-local bytes. A library that is loaded at
/// run time gets these bytes from malloc when a thread first accesses them. If no memory is left, glibc then ends the process.
///
///      R_X86_64_TLSDESC     asks glibc to allocate the library's bytes in every thread, existing and future, when the library is loaded;
///                           glibc does not do so if there is no room for them (`initial-exec` would refuse to load the library)
///
/// One such access covers all bytes of the library, including those of the C++ runtime. On ARM, every access is compiled in this way.
///
/// The C++ runtime is a part of the library. When it is loaded, libstdc++ allocates 70 kB for exceptions that are thrown when no memory is
/// left, and never frees them. The library frees them when it is unloaded, because hosts load and unload it for each run.
#pragma once

namespace softffd::fmi {

/// Claims the bytes of the calling thread, in case there was no room for them when the library was loaded.
void claim_exception_storage();

}  // namespace softffd::fmi
