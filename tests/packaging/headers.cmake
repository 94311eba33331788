# SPDX-License-Identifier: Apache-2.0
# cmake -DCOMPILER=g++ -DSOURCE=... -DSTAGE=... -DWORK=... -P headers.cmake: checks that every public header below SOURCE is
# installed below STAGE and compiles there as the first include of a file, included twice, with only the standard library and GLM.
cmake_minimum_required(VERSION 3.25)

file(GLOB_RECURSE headers RELATIVE "${SOURCE}" "${SOURCE}/*.hpp" "${SOURCE}/*.h")
set(faults "")
foreach(header IN LISTS headers)
  string(REPLACE "/" "_" source "${header}.cpp")
  file(WRITE "${WORK}/${source}" "#include \"${header}\"\n#include \"${header}\"\n")
  execute_process(
    COMMAND ${COMPILER} -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I "${STAGE}" "${WORK}/${source}"
    RESULT_VARIABLE failed ERROR_VARIABLE messages)
  if(failed)
    string(APPEND faults "\n${messages}")
  endif()
endforeach()
if(faults)
  message(FATAL_ERROR "Headers that do not compile alone:${faults}")
elseif(NOT headers)
  message(FATAL_ERROR "no headers below '${SOURCE}'")
endif()
