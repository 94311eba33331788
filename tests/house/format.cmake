# SPDX-License-Identifier: Apache-2.0
# cmake -DFORMAT=clang-format-14 -DROOT=... -P format.cmake: checks that clang-format changes no source.
cmake_minimum_required(VERSION 3.25)

set(patterns "")
foreach(folder include lib tests examples)
  list(APPEND patterns ${ROOT}/${folder}/*.hpp ${ROOT}/${folder}/*.cpp)
endforeach()
file(GLOB_RECURSE files RELATIVE ${ROOT} ${patterns})
if(NOT files)
  message(FATAL_ERROR "ROOT = ${ROOT}: no sources; must be the repository")
endif()
execute_process(COMMAND ${FORMAT} --dry-run -Werror ${files} WORKING_DIRECTORY ${ROOT}
  RESULT_VARIABLE failed ERROR_VARIABLE messages)
if(failed)
  string(REGEX MATCHALL "[^\n]*: error: [^\n]*" errors "${messages}")
  list(JOIN errors "\n  " errors)
  message(FATAL_ERROR "sources are not formatted; run ${FORMAT} -i:\n  ${errors}")
endif()
