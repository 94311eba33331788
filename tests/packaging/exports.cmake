# SPDX-License-Identifier: Apache-2.0
# cmake -DLIBRARY=libpetzval-core.so [-DNEEDED=regex] -P exports.cmake: a shared library exports what belongs to petzval and
# nothing else, and needs only the libraries that match.
cmake_minimum_required(VERSION 3.25)

execute_process(COMMAND nm --dynamic --defined-only --format=posix ${LIBRARY}
  OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" symbols "${table}")
set(faults "")
set(functions 0)
foreach(symbol IN LISTS symbols)
  if(symbol MATCHES "^_ZNK?7petzval")
    math(EXPR functions "${functions} + 1")
  elseif(NOT symbol MATCHES "^_ZT[ISVT]N7petzval")
    string(APPEND faults "\n  ${symbol}")
  endif()
endforeach()
if(faults)
  message(FATAL_ERROR "${LIBRARY} exports what is not petzval's (c++filt makes it readable):${faults}")
elseif(functions EQUAL 0)
  message(FATAL_ERROR "${LIBRARY} exports nothing")
endif()

if(NEEDED)
  execute_process(COMMAND readelf --dynamic ${LIBRARY} OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "\\(NEEDED\\)[^\n]*" entries "${table}")
  foreach(entry IN LISTS entries)
    string(REGEX REPLACE "^.*\\[(.*)\\]$" "\\1" needed "${entry}")
    if(NOT needed MATCHES "^(${NEEDED})$")
      message(FATAL_ERROR "${LIBRARY} needs ${needed}; wanted none but ${NEEDED}")
    endif()
  endforeach()
endif()
