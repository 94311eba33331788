# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=... -P measured.cmake: counts the commits since the tables of tests/bench/README.md were measured that change the
# sources of a table. Prints a note; fails above 300 commits. A table names its commit and sources in a line such as
#     Measured at 1a2b3c4d on <processor>; sources: lib/trace lib/camera.
cmake_minimum_required(VERSION 3.25)

set(most 300)
set(page ${ROOT}/tests/bench/README.md)
file(STRINGS ${page} tables REGEX "^Measured at ")
if(NOT tables)
  message(FATAL_ERROR "${page}: no line starts with \"Measured at\"; every table must name its commit and sources")
endif()
foreach(table IN LISTS tables)
  if(NOT table MATCHES "^Measured at ([0-9a-f]+) on (.+); sources: ([a-z_/ ]+)[.]$")
    message(FATAL_ERROR "${page}: \"${table}\" must have the form: Measured at COMMIT on PROCESSOR; sources: FOLDERS.")
  endif()
  set(commit ${CMAKE_MATCH_1})
  separate_arguments(sources UNIX_COMMAND "${CMAKE_MATCH_3}")
  foreach(source IN LISTS sources)
    if(NOT EXISTS ${ROOT}/${source})
      message(FATAL_ERROR "${page}: ${source} does not exist")
    endif()
  endforeach()
  execute_process(COMMAND git -C ${ROOT} rev-list --count ${commit}..HEAD -- ${sources} OUTPUT_VARIABLE count ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(failed)  # a source archive, or a clone without the history
    message(STATUS "${commit}: not in this history")
  elseif(count GREATER most)
    message(FATAL_ERROR "${page}: ${count} commits changed ${CMAKE_MATCH_3} since ${commit}; must be at most ${most}: measure anew")
  else()
    message(STATUS "${commit}: ${count} commits changed ${CMAKE_MATCH_3} since")
  endif()
endforeach()
