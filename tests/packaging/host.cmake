# SPDX-License-Identifier: Apache-2.0
# cmake -DHOST=... -DSOURCE=... -DWORK=... -DGENERATOR=... -DOPTIONS=... -P host.cmake: checks that petzval as a subproject of HOST
# changes neither the kind of the host's libraries, nor its `all` target, nor its installed files.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${WORK})
foreach(time first second)  # cache entries of the first run must not change the second run
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${HOST} -B ${WORK}/build -G ${GENERATOR} -DPETZVAL_SOURCE=${SOURCE} ${OPTIONS}
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
endforeach()

# expect(what found wanted): compares two lists, sorted.
function(expect what found wanted)
  list(SORT found)
  list(SORT wanted)
  if(NOT found STREQUAL wanted)
    message(FATAL_ERROR "${what}: ${found}; must be: ${wanted}")
  endif()
endfunction()

# build(target result): lists the targets of petzval that a target of the host would build.
function(build target result)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --target ${target} -- -n
    OUTPUT_VARIABLE commands COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "lib/libpetzval-[a-z]+|CMakeFiles/petzval-(core|blur|fit|figure|image)\\.dir" parts "${commands}")
  list(TRANSFORM parts REPLACE ".*petzval-([a-z]+).*" "\\1")
  list(REMOVE_DUPLICATES parts)
  set(${result} "${parts}" PARENT_SCOPE)
endfunction()

build(all found)
expect("libraries of petzval that `all` builds" "${found}" "")
build(viewer found)
expect("libraries of petzval that a program with petzval::core builds" "${found}" "core")

execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/stage COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(GLOB_RECURSE installed RELATIVE ${WORK}/stage ${WORK}/stage/*)
expect("files installed by the host" "${installed}" "lib/libafter.a;lib/libbefore.a")
