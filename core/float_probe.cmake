# Looks, while configuring, whether the compiler computes what is written, with the flags Pelt's files get: in the
# assembly of float_probe.cpp there must be a multiplication (a * b + c was not fused), a subtraction ((a + b) - a was
# not simplified) and a division (not a product with the inverse). Works for any target, as nothing is run.
#
# What breaks without it: a compiler that ignores -ffp-contract=off (clang-cl does) builds silently, and every frame
# has other bits than all other machines.
#   pelt_probe_floats(FLAG...)    FLAGs: those that are to forbid it, as PELT_FLOAT_FLAGS
function(pelt_probe_floats)
  set(types ${CMAKE_BUILD_TYPE})
  if(CMAKE_CONFIGURATION_TYPES)
    set(types ${CMAKE_CONFIGURATION_TYPES})
  endif()
  if(NOT types)
    set(types none)
  endif()
  set(source ${PROJECT_SOURCE_DIR}/core/float_probe.cpp)
  set(assembly ${PROJECT_BINARY_DIR}/CMakeFiles/pelt_float_probe.s)
  set(target "")
  if(CMAKE_CXX_COMPILER_TARGET)
    set(target ${CMAKE_CXX_COMPILE_OPTIONS_TARGET}${CMAKE_CXX_COMPILER_TARGET})
  endif()
  # With the instruction that would fuse, as the widest kernels have it.
  set(machine "")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    set(machine -mfma)
  endif()
  if(CMAKE_CXX_COMPILER_FRONTEND_VARIANT STREQUAL "MSVC")
    set(to_assembly /O2 /c /FA /Fa${assembly} /Fo${assembly}.obj --)  # a path may begin like an option
  else()
    set(to_assembly -O2 -fno-lto -S -o ${assembly})
  endif()
  foreach(type ${types})
    string(TOUPPER ${type} type)
    separate_arguments(flags NATIVE_COMMAND "${CMAKE_CXX_COMPILER_ARG1} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}")
    # The flags of the build come first, as on a command line of the build.
    set(command ${CMAKE_CXX_COMPILER} ${target} ${flags} ${ARGN} ${machine} ${to_assembly} ${source})
    execute_process(COMMAND ${command} RESULT_VARIABLE failed ERROR_VARIABLE output OUTPUT_VARIABLE output)
    if(failed)
      message(FATAL_ERROR "The probe of floating-point arithmetic does not compile:\n${output}")
    endif()
    file(READ ${assembly} text)
    set(faults "")
    foreach(expected "mul|meeb|vmla=a * b + c is fused into one operation" "sub|seb=(a + b) - a is simplified"
                     "div|deb=a / 3 becomes a product with the inverse")
      string(REGEX REPLACE "=.*" "" operation "${expected}")
      string(REGEX REPLACE "^[^=]*=" "" fault "${expected}")
      # As a mnemonic: mulss, vmulss, fmuls, fmul, f32.mul, meebr; 32-bit ARM's vmla rounds twice.
      if(NOT text MATCHES "[ \t][a-z0-9.]*(${operation})[a-z0-9.]*[ \t]")
        string(APPEND faults "\n  ${fault}")
      endif()
    endforeach()
    if(faults)
      list(JOIN command " " command)
      message(FATAL_ERROR "This compiler, with these flags, does not compute what is written, and Pelt's bits would "
                          "not be those of other machines:${faults}\nForbid it in the compiler's own words "
                          "(-ffp-contract=off, clang-cl /clang:-ffp-contract=off, no -ffast-math or a part of it). "
                          "What was looked at:\n  ${command}")
    endif()
  endforeach()
endfunction()
