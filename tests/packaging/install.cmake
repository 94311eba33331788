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

# An OSL camera needs its template; the error names the missing file.
if(EXISTS ${STAGE}/bin/petzval)
  set(convert ${STAGE}/bin/petzval convert achromat_100mm ${STAGE}-camera.osl --quiet)
  execute_process(COMMAND ${convert} COMMAND_ERROR_IS_FATAL ANY ERROR_QUIET)
  file(RENAME ${STAGE}/share/petzval/osl ${STAGE}/share/petzval/away)
  execute_process(COMMAND ${convert} RESULT_VARIABLE failed ERROR_VARIABLE message)
  file(RENAME ${STAGE}/share/petzval/away ${STAGE}/share/petzval/osl)
  if(NOT failed OR NOT message MATCHES "share/petzval/osl/camera.osl")
    message(FATAL_ERROR "${convert} without its template: ${message}; must fail and name osl/camera.osl")
  endif()
endif()
