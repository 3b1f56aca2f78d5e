# What WebAssembly has in the place of, or beside, what CMakeLists.txt says of all platforms. The library is for web pages.
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)
set(SOFTFFD_HAS_TLSDESC OFF)
set(SOFTFFD_HARDENS OFF)  # a page's memory is apart anyway

# All three flags of exceptions: -fwasm-exceptions alone ends zig's compiler. Relaxed SIMD, which fuses, stays off.
set(wasm_flags -msimd128 -mexception-handling -fwasm-exceptions "SHELL:-mllvm -wasm-enable-eh")
target_compile_options(softffd_flags INTERFACE ${wasm_flags} -g0)
target_link_options(softffd_flags INTERFACE ${wasm_flags})
# Eigen as on x86-64: the same instructions, and as many registers, which decide in what order it adds.
target_compile_definitions(softffd_flags INTERFACE __SSE2__ EIGEN_ARCH_DEFAULT_NUMBER_OF_REGISTERS=16)
target_include_directories(softffd_flags INTERFACE fmu_src/wasm/sse2)

function(make_wasm_library target)
  set(exported softffd_open malloc free)
  foreach(name SetDebugLogging SetupExperiment EnterInitializationMode ExitInitializationMode Terminate Reset FreeInstance DoStep
               GetReal SetReal GetInteger SetInteger SetRealInputDerivatives
               GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate)
    list(APPEND exported fmi2${name})
  endforeach()
  list(TRANSFORM exported PREPEND -Wl,--export=)
  target_sources(${target} PRIVATE fmu_src/wasm/open.cpp fmu_src/wasm/exceptions.cpp)
  target_link_options(${target} PRIVATE -mexec-model=reactor ${exported} -Wl,--gc-sections -Wl,--strip-all)
  set_target_properties(${target} PROPERTIES SUFFIX .wasm)

  execute_process(COMMAND "${CMAKE_CXX_COMPILER}" -c "import ziglang; print(*ziglang.__path__)" OUTPUT_VARIABLE zig
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(folders libcxxabi/include libcxxabi/src libcxx/src libunwind/include libunwind/src)
  list(TRANSFORM folders PREPEND "${zig}/lib/")
  set_source_files_properties(fmu_src/wasm/exceptions.cpp PROPERTIES
    INCLUDE_DIRECTORIES "${folders}" COMPILE_OPTIONS "-std=c++23;-w"
    COMPILE_DEFINITIONS "_LIBCPP_BUILDING_LIBRARY;_LIBCXXABI_BUILDING_LIBRARY;LIBCXX_BUILDING_LIBCXXABI;_LIBCXXABI_HAS_NO_THREADS;\
_LIBUNWIND_HAS_NO_THREADS;_LIBUNWIND_HIDE_SYMBOLS")
endfunction()
