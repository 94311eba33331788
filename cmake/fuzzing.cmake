# SPDX-License-Identifier: Apache-2.0
# A build for fuzzing: all targets below are instrumented, including the loops of every instruction set. Memory errors and
# undefined behaviour end the program, and the standard library checks its preconditions.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "PETZVAL_BUILD_FUZZERS: compiler = ${CMAKE_CXX_COMPILER_ID}; must be Clang (libFuzzer)")
endif()
set(petzval_sanitizers address,undefined)
# Traced comparisons teach the fuzzer the keywords of a format. In loops over numbers they are useless and take three quarters of
# the time. tests/fuzz enables them for parsers.
add_compile_options(-fsanitize=fuzzer-no-link,${petzval_sanitizers} -fno-sanitize-coverage=trace-cmp
  -fno-sanitize-recover=undefined -fno-omit-frame-pointer -gline-tables-only -O2 -D_GLIBCXX_ASSERTIONS)
add_link_options(-fsanitize=${petzval_sanitizers})
