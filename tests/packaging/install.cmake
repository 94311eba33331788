# SPDX-License-Identifier: Apache-2.0
# cmake -DBUILD=... -DSTAGE=... -P install.cmake: installs a build tree, moves the result to STAGE, and looks for paths in it that
# would not survive a move.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${STAGE} ${STAGE}-first)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${STAGE}-first COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(RENAME ${STAGE}-first ${STAGE})

file(GLOB_RECURSE texts ${STAGE}/*.cmake ${STAGE}/*.pc ${STAGE}/*.hpp)
foreach(text IN LISTS texts)
  file(STRINGS ${text} lines REGEX "${STAGE}|${BUILD}")
  if(lines)
    message(FATAL_ERROR "${text} holds an absolute path: ${lines}")
  endif()
endforeach()
