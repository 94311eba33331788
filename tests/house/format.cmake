# SPDX-License-Identifier: Apache-2.0
# cmake -DFORMAT=clang-format-14 -DROOT=... -P format.cmake: every source is as clang-format writes it.
cmake_minimum_required(VERSION 3.25)

set(patterns "")
foreach(folder include lib tests examples)
  list(APPEND patterns ${ROOT}/${folder}/*.hpp ${ROOT}/${folder}/*.cpp)
endforeach()
file(GLOB_RECURSE files RELATIVE ${ROOT} ${patterns})
if(NOT files)
  message(FATAL_ERROR "no sources below '${ROOT}': -DROOT=<the repository> is wanted")
endif()
execute_process(COMMAND ${FORMAT} --dry-run -Werror ${files} WORKING_DIRECTORY ${ROOT}
  RESULT_VARIABLE failed ERROR_VARIABLE messages)
if(failed)
  string(REGEX MATCHALL "[^\n]*: error: [^\n]*" errors "${messages}")
  list(JOIN errors "\n  " errors)
  message(FATAL_ERROR "${FORMAT} -i is wanted:\n  ${errors}")
endif()
