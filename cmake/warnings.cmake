# SPDX-License-Identifier: Apache-2.0
# Strict for our own targets, never exported. tests/run.sh makes them errors (CMAKE_COMPILE_WARNING_AS_ERROR).
function(petzval_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
    -Woverloaded-virtual -Wcast-qual -Wundef -Wvla
    # g++ 12 sees overlaps in std::string's operator+ that are not there (GCC bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
endfunction()
