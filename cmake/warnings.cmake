# SPDX-License-Identifier: Apache-2.0
# Strict for our own targets, never exported. tests/run.sh makes them errors (CMAKE_COMPILE_WARNING_AS_ERROR).
function(petzval_warnings target)
  petzval_gnu_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
    -Woverloaded-virtual -Wcast-qual -Wundef -Wvla)
  # g++ 12 reports overlaps inside std::string that do not exist (GCC bug 105651), and with precompiled headers more.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
  endif()
endfunction()
