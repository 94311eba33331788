# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=... -DWORK=... -DOPTIONS=... -P readme.cmake: checks that the command of README.md, "Linking", configures petzval
# if only the packages of the library are installed.
cmake_minimum_required(VERSION 3.25)

file(READ ${SOURCE}/README.md text)
string(REGEX REPLACE ".*\n## Linking\n" "" text "${text}")
if(NOT text MATCHES "^[^#]*`(cmake [^`&]*-B build[^`&]*) && ")
  message(FATAL_ERROR "README.md, Linking: no command with -B build; must have one")
endif()
string(REPLACE "-B build" "-S ${SOURCE} -B ${WORK}" command "${CMAKE_MATCH_1}")
separate_arguments(command UNIX_COMMAND "${command}")
file(REMOVE_RECURSE ${WORK})
set(missing "")
foreach(package GTest CLI11 embree tinyobjloader)
  list(APPEND missing -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
execute_process(COMMAND ${command} ${missing} ${OPTIONS} COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(STRINGS ${WORK}/CMakeCache.txt generator REGEX "^CMAKE_GENERATOR:.*=Ninja")
if(NOT generator)  # run.sh installs no make
  message(FATAL_ERROR "README.md, Linking: generator is not Ninja; must be Ninja")
endif()
