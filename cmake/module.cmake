# SPDX-License-Identifier: Apache-2.0

# petzval_look_for(PETZVAL_WITH_CERES Ceres CONFIG): calls find_package for an option with the values ON, OFF and AUTO.
macro(petzval_look_for option)
  if(${option} STREQUAL "AUTO")
    find_package(${ARGN} QUIET)
  elseif(${option})
    find_package(${ARGN} REQUIRED)
  endif()
endmacro()

# Disables vectors of adjacent scalars: a vector load of two values that were just stored separately stalls until both are in the
# cache (67 instead of 50 ns for a single camera sample).
set(PETZVAL_NO_PAIRS -fno-tree-slp-vectorize)

# petzval_gnu_options(target PRIVATE -Wall ...): adds flags for GCC and Clang only.
function(petzval_gnu_options target scope)
  target_compile_options(${target} ${scope} "$<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:${ARGN}>")
endfunction()

# petzval_library(core): adds a library with the properties that all libraries share.
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
    UNITY_BUILD_MODE GROUP  # with CMAKE_UNITY_BUILD: the JOINED sources of each module
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    WINDOWS_EXPORT_ALL_SYMBOLS ON
    INSTALL_RPATH $<IF:$<PLATFORM_ID:Darwin>,@loader_path,$ORIGIN>)
  target_compile_features(petzval-${name} PUBLIC cxx_std_20)
  # No contraction into fused operations, so that all compilers and processors give the same bits.
  petzval_gnu_options(petzval-${name} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math ${PETZVAL_NO_PAIRS})
  if(UNIX AND NOT APPLE)  # ELF
    target_link_options(petzval-${name} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exports.map)
    set_property(TARGET petzval-${name} PROPERTY LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exports.map)
  endif()
  target_include_directories(petzval-${name} PRIVATE ${PROJECT_SOURCE_DIR}/lib)  # internal headers: "module/header.hpp"
  target_sources(petzval-${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${ARGN})
  set_target_properties(petzval-${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  petzval_warnings(petzval-${name})
endfunction()

# petzval_module(core glass SOURCES dispersion.cpp HEADERS glass.hpp): adds the files of a module to a library. A unity build
# (CMAKE_UNITY_BUILD) compiles the sources after JOINED in groups of eight, so no two of them may define the same name.
function(petzval_module library module)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "JOINED;SOURCES;HEADERS")
  list(TRANSFORM arg_JOINED PREPEND ${PROJECT_SOURCE_DIR}/lib/${module}/)
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/lib/${module}/)
  list(TRANSFORM arg_HEADERS PREPEND ${PROJECT_SOURCE_DIR}/include/petzval/${module}/)
  target_sources(petzval-${library} PRIVATE ${arg_JOINED} ${arg_SOURCES}
    PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${arg_HEADERS})
  set(position 0)
  foreach(source IN LISTS arg_JOINED)
    math(EXPR group "${position} / 8")
    math(EXPR position "${position} + 1")
    set_source_files_properties(${source} TARGET_DIRECTORY petzval-${library} PROPERTIES UNITY_GROUP ${module}_${group})
  endforeach()
endfunction()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(PETZVAL_X86_64 ON)
endif()

# petzval_lanes(core block.cpp tracer_avx2_fast avx2 PETZVAL_FAST=1 ...): adds the loops for one instruction set to a library, as an
# object with its own flags and definitions. PETZVAL_FAST=1 allows fused operations. The object is optimised in every build type:
# otherwise it would contain inline functions of headers, and the linker could use them in files of another instruction set.
function(petzval_lanes library file name set)
  set(flags_avx2 -mavx2 -mfma)
  set(flags_avx512 ${flags_avx2} -mavx512f -mavx512dq -mavx512bw -mavx512vl)
  set(contract off)
  if("PETZVAL_FAST=1" IN_LIST ARGN)
    set(contract fast)
    # With "fast", Clang fuses differently in the body and in the remainder of a loop: the bits of a ray would depend on its
    # position in the batch.
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
      set(contract on)
    endif()
  endif()
  add_library(petzval-${name} OBJECT ${file})
  target_compile_features(petzval-${name} PRIVATE cxx_std_20)
  target_compile_definitions(petzval-${name} PRIVATE ${ARGN})
  petzval_gnu_options(petzval-${name} PRIVATE -O3 -fno-math-errno -fno-trapping-math -ffp-contract=${contract} ${flags_${set}}
    -Wno-psabi)  # vectors pass between functions of this file only
  # Clang does not vectorise some loops if the instruction set has no gathers.
  target_compile_options(petzval-${name} PRIVATE $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>)
  target_include_directories(petzval-${name} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/lib)
  target_link_libraries(petzval-${name} PRIVATE glm::glm)
  set_target_properties(petzval-${name} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
  petzval_warnings(petzval-${name})
  target_sources(petzval-${library} PRIVATE $<TARGET_OBJECTS:petzval-${name}>)
endfunction()

# petzval_loops(core film_pupil_table.cpp film_pupil_table): compiles a file of loops for every instruction set. PETZVAL_LOOPS is
# the name that each object defines: film_pupil_table_baseline, film_pupil_table_avx2, film_pupil_table_avx512. The code is tuned
# for processors with fast gathers, which doubles the speed of pupil tables.
# REPRODUCIBLE: no fused operations, so that all instruction sets give the same bits.
function(petzval_loops library file name)
  set(fast PETZVAL_FAST=1)
  if("REPRODUCIBLE" IN_LIST ARGN)
    set(fast PETZVAL_FAST=0)
  endif()
  petzval_lanes(${library} ${file} ${name}_baseline baseline PETZVAL_LOOPS=${name}_baseline PETZVAL_FAST=0)
  petzval_gnu_options(petzval-${name}_baseline PRIVATE ${PETZVAL_NO_PAIRS})
  if(PETZVAL_X86_64)
    foreach(set avx2 avx512)
      petzval_lanes(${library} ${file} ${name}_${set} ${set} PETZVAL_LOOPS=${name}_${set} ${fast})
    endforeach()
    petzval_gnu_options(petzval-${name}_avx2 PRIVATE ${PETZVAL_NO_PAIRS} -mtune=haswell)
    petzval_gnu_options(petzval-${name}_avx512 PRIVATE ${PETZVAL_NO_PAIRS} -mtune=icelake-server -mprefer-vector-width=512)
  endif()
endfunction()

# petzval_test(trace/reference_test.cpp core): adds a file of tests and the libraries that it uses. The files of one folder form one
# program, trace_tests; each test case becomes a test.
function(petzval_test file)
  get_filename_component(folder ${file} DIRECTORY)
  set(name ${folder}_tests)
  if(NOT TARGET ${name})
    add_executable(${name})
    target_link_libraries(${name} PRIVATE petzval-testing)
    target_precompile_headers(${name} REUSE_FROM petzval-testing-precompiled)
    petzval_warnings(${name})
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 TEST_FILTER -${petzval_long_tests}
      PROPERTIES LABELS "${petzval_labels}")
    if(PETZVAL_FULL_TESTS)
      gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 TEST_FILTER ${petzval_long_tests} PROPERTIES LABELS full)
    endif()
    set_property(GLOBAL APPEND PROPERTY PETZVAL_TEST_PROGRAMS ${name})
  endif()
  target_sources(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/${file})
  list(TRANSFORM ARGN PREPEND petzval::)
  target_link_libraries(${name} PRIVATE ${ARGN})
endfunction()

# petzval_label_full(): adds the label "full" to the tests that this folder has added so far.
function(petzval_label_full)
  get_property(tests DIRECTORY PROPERTY TESTS)
  set_property(TEST ${tests} APPEND PROPERTY LABELS full)
endfunction()
