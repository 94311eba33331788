# SPDX-License-Identifier: Apache-2.0
# cmake -DLIBRARY=libpetzval-core.so [-DNEEDED=regex] -P exports.cmake: checks that a shared library exports only symbols of petzval
# and needs only libraries that match.
cmake_minimum_required(VERSION 3.25)

execute_process(COMMAND nm --dynamic --defined-only --format=posix ${LIBRARY}
  OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" symbols "${table}")
set(faults "")
set(functions 0)
foreach(symbol IN LISTS symbols)
  if(symbol MATCHES "^_ZNK?7petzval|^petzval_[a-z_]+ ")
    math(EXPR functions "${functions} + 1")
  elseif(NOT symbol MATCHES "^_ZT[ISVT]N7petzval")
    string(APPEND faults "\n  ${symbol}")
  endif()
endforeach()
if(faults)
  message(FATAL_ERROR "${LIBRARY} exports foreign symbols (c++filt makes them readable):${faults}")
elseif(functions EQUAL 0)
  message(FATAL_ERROR "${LIBRARY} exports no symbol")
endif()

if(NEEDED)
  execute_process(COMMAND readelf --dynamic ${LIBRARY} OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "\\(NEEDED\\)[^\n]*" entries "${table}")
  foreach(entry IN LISTS entries)
    string(REGEX REPLACE "^.*\\[(.*)\\]$" "\\1" needed "${entry}")
    if(NOT needed MATCHES "^(${NEEDED})$")
      message(FATAL_ERROR "${LIBRARY} needs ${needed}; must match ${NEEDED}")
    endif()
  endforeach()
endif()
