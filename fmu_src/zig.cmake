# Toolchain: the compiler of the Python package `ziglang`, for the platform ZIG_TARGET.
set(CMAKE_CXX_COMPILER python3 -m ziglang c++ -target ${ZIG_TARGET})
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ZIG_TARGET)
