/// An exception needs no memory to be thrown, but a few bytes of the thread, and a library that is loaded at run time gets those when a
/// thread first asks for them: from malloc. Where there is no memory left glibc ends the process then.
///
///      R_X86_64_TLSDESC     asks glibc to give the library its bytes of every thread, past and future ones, when it is loaded, and
///                           passes over that where there is no room for them (`initial-exec` would refuse to load)
///
/// One such access moves all of the library's bytes, those of the C++ runtime among them. On ARM it is how every access is compiled.
#pragma once

namespace softffd::fmi {

/// Claims the calling thread's bytes, should they have found no room.
void claim_exception_storage();

}  // namespace softffd::fmi
