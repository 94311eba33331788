# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=... -P tour.cmake: checks that petzval.hpp, an example or the consumer includes each public header, directly or
# through other public headers.
cmake_minimum_required(VERSION 3.25)

get_filename_component(ROOT "${ROOT}" ABSOLUTE)
file(GLOB_RECURSE headers RELATIVE "${ROOT}/include" "${ROOT}/include/petzval/*.hpp")
file(GLOB_RECURSE open "${ROOT}/examples/*.?pp" "${ROOT}/tests/consumer/*.cpp" "${ROOT}/include/petzval/petzval.hpp")
set(met petzval/petzval.hpp)
while(open)
  list(POP_FRONT open file)
  file(STRINGS "${file}" lines REGEX "^#include [<\"]petzval/")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include [<\"]([^>\"]+)[>\"].*" "\\1" header "${line}")
    if(EXISTS "${ROOT}/include/${header}" AND NOT header IN_LIST met)
      list(APPEND met ${header})
      list(APPEND open "${ROOT}/include/${header}")
    endif()
  endforeach()
endwhile()

list(LENGTH headers count)
list(REMOVE_ITEM headers ${met})
if(count LESS 20)
  message(FATAL_ERROR "ROOT = ${ROOT}: only ${count} headers; must be the repository")
elseif(headers)
  list(JOIN headers "\n  " faults)
  message(FATAL_ERROR "Public headers that petzval.hpp, the examples and the consumer do not include:\n  ${faults}")
endif()
