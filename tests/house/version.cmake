# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=... -P version.cmake: checks that the version in the pages equals include/petzval/core/config.hpp.
cmake_minimum_required(VERSION 3.25)

file(STRINGS ${ROOT}/include/petzval/core/config.hpp line REGEX "define PETZVAL_VERSION ")
string(REGEX REPLACE ".*\"(.*)\"" "\\1" version "${line}")
string(REGEX MATCH "^[0-9]+\\.[0-9]+" minor "${version}")

# petzval_names(file regex expected): the first match of the regex in the file must be the expected text.
function(petzval_names file regex expected)
  file(READ ${ROOT}/${file} text)
  string(REGEX MATCH "${regex}" found "${text}")
  if(NOT CMAKE_MATCH_1 STREQUAL expected)
    message(FATAL_ERROR "${file}: version = ${CMAKE_MATCH_1}; must be ${expected}, as in core/version.hpp")
  endif()
endfunction()

petzval_names(.github/CHANGELOG.md "\n## ([0-9.]+)" ${version})
petzval_names(.github/CITATION.cff "\nversion: ([^\n]+)" ${version})
petzval_names(lib/README.md "find_package[(]petzval ([0-9.]+)" ${minor})
petzval_names(tests/consumer/CMakeLists.txt "find_package[(]petzval ([0-9.]+)" ${minor})
