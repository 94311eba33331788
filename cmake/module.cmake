# SPDX-License-Identifier: Apache-2.0

# petzval_library(core): one of the libraries, with what all of them share.
function(petzval_library name)
  add_library(petzval-${name})
  add_library(petzval::${name} ALIAS petzval-${name})
  set_target_properties(petzval-${name} PROPERTIES
    EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON
    POSITION_INDEPENDENT_CODE ON
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    INSTALL_RPATH $ORIGIN)
  target_compile_features(petzval-${name} PUBLIC cxx_std_20)
  # No contraction into fused operations: the same bits from every compiler and processor.
  target_compile_options(petzval-${name} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math)
  target_link_options(petzval-${name} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exports.map)
  set_property(TARGET petzval-${name} PROPERTY LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exports.map)
  target_sources(petzval-${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${ARGN})
  set_target_properties(petzval-${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  petzval_warnings(petzval-${name})
endfunction()

# petzval_module(core media SOURCES dispersion.cpp HEADERS dispersion.hpp): a module's files, into a library.
function(petzval_module library module)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "SOURCES;HEADERS")
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/lib/${module}/)
  list(TRANSFORM arg_HEADERS PREPEND ${PROJECT_SOURCE_DIR}/include/petzval/${module}/)
  target_sources(petzval-${library} PRIVATE ${arg_SOURCES}
    PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${arg_HEADERS})
endfunction()

# petzval_test(trace/reference_test.cpp core): one test program, discovered case by case.
function(petzval_test file)
  string(REGEX REPLACE "[/.]" "_" name ${file})
  string(REGEX REPLACE "_cpp$" "" name ${name})
  add_executable(${name} ${PROJECT_SOURCE_DIR}/tests/${file})
  list(TRANSFORM ARGN PREPEND petzval::)
  target_link_libraries(${name} PRIVATE ${ARGN} petzval-testing)
  petzval_warnings(${name})
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120)
endfunction()
