# SPDX-License-Identifier: Apache-2.0
# The target `docs`: pages of the public interface in build/docs/html, made by Doxygen. A class page links the examples that
# use the class.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E echo "docs: Doxygen was not found; install it (apt-get install doxygen) and configure again"
    COMMAND ${CMAKE_COMMAND} -E false
    VERBATIM)
  return()
endif()

# Each source file of the examples and guides becomes a page, linked from the classes that it uses.
set(example_pages "")
foreach(folder examples lib/docs)
  file(GLOB_RECURSE programs RELATIVE ${PROJECT_SOURCE_DIR}/${folder} CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/${folder}/*.cpp ${PROJECT_SOURCE_DIR}/${folder}/*.hpp)
  foreach(program IN LISTS programs)
    string(APPEND example_pages "/** @example ${program} */\n")
  endforeach()
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/docs/examples.dox CONTENT "${example_pages}" @ONLY)

# Doxygen resolves links to pages, not to their sections, and collects pictures in one folder.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/docs/page_filter @ONLY CONTENT [=[#!/bin/sh
exec sed -e 's/\[\([^]]*\)\](#[a-z0-9_-]*)/\1/g' -e 's/[.]md#[a-z0-9_-]*)/.md)/g' -e 's,([./]*examples/pictures/,(,g' "$1"
]=])
file(CHMOD ${PROJECT_BINARY_DIR}/docs/page_filter PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
file(GLOB pictures CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/examples/pictures/*)

set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/docs)
set(DOXYGEN_PROJECT_BRIEF "${PROJECT_DESCRIPTION}")
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
set(DOXYGEN_IMAGE_PATH ${PROJECT_SOURCE_DIR}/examples/pictures)
set(DOXYGEN_HTML_EXTRA_FILES ${pictures})
set(DOXYGEN_EXAMPLE_PATH ${PROJECT_SOURCE_DIR}/examples ${PROJECT_SOURCE_DIR}/lib/docs)
set(DOXYGEN_EXAMPLE_RECURSIVE YES)
set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR})
set(DOXYGEN_STRIP_FROM_INC_PATH ${PROJECT_SOURCE_DIR}/include)
set(DOXYGEN_FILE_PATTERNS *.hpp *.h *.md *.dox)
set(DOXYGEN_FILTER_PATTERNS *.md=${PROJECT_BINARY_DIR}/docs/page_filter)
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)  # the first sentence of a comment is its summary
set(DOXYGEN_BUILTIN_STL_SUPPORT YES)
set(DOXYGEN_MACRO_EXPANSION YES)
set(DOXYGEN_EXPAND_ONLY_PREDEF YES)
set(DOXYGEN_PREDEFINED "PETZVAL_API=" "PETZVAL_C_API=")
set(DOXYGEN_EXCLUDE_SYMBOLS *detail* kernel*)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lib/docs/*.md)
set(sources ${PROJECT_SOURCE_DIR}/README.md ${pages})
foreach(page CHANGELOG CONTRIBUTING SECURITY)
  list(APPEND sources ${PROJECT_SOURCE_DIR}/.github/${page}.md)
endforeach()
foreach(folder lib data tests tests/bench tests/conformance examples/hosts examples/hosts/mitsuba examples/hosts/pbrt
    examples/python examples/renderer)
  list(APPEND sources ${PROJECT_SOURCE_DIR}/${folder}/README.md)
endforeach()
doxygen_add_docs(docs ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/docs/examples.dox ${sources}
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} COMMENT "Pages of the public interface: docs/html/index.html")
