/// Marks the functions of the library that the Python package calls, beside the functions of the standards.
#pragma once

#ifdef _WIN32
#define SOFTFFD_EXPORTED extern "C" __declspec(dllexport)
#else
#define SOFTFFD_EXPORTED extern "C" __attribute__((visibility("default")))
#endif
