# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=... -P presets.cmake: CMakePresets.json has the usual builds, each to configure, to build and to test.
cmake_minimum_required(VERSION 3.25)

foreach(kind configure build test)
  execute_process(COMMAND ${CMAKE_COMMAND} --list-presets=${kind} WORKING_DIRECTORY ${ROOT}
    OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE failed)
  string(REGEX MATCHALL "\"[a-z]+\"" presets "${output}")
  if(failed OR NOT presets STREQUAL "\"release\";\"debug\";\"asan\";\"tsan\";\"clang\"")
    message(FATAL_ERROR "${ROOT}/CMakePresets.json: ${kind} presets: found ${output}, wanted release, debug, asan, tsan, clang")
  endif()
endforeach()
