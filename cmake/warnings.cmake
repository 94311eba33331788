# SPDX-License-Identifier: Apache-2.0
# Strict warnings for the targets of petzval; they are not exported. tests/run.sh turns them into errors
# (CMAKE_COMPILE_WARNING_AS_ERROR).
function(petzval_warnings target)
  petzval_gnu_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
    -Woverloaded-virtual -Wcast-qual -Wundef -Wvla)
  # g++ 12 reports false overlaps inside std::string (GCC bug 105651), and more false positives with precompiled headers.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
  endif()
endfunction()
