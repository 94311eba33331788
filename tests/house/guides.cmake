# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=... -P guides.cmake: checks README.md and the guides, lib/docs/*.md, without a build.
#
# - A compiled source contains the lines of each block ```cpp, apart from the indentation.
# - The targets of links and the paths in back quotes exist.
# - Blocks have a known kind and an end. guide_commands.cmake runs blocks of kind sh and compares blocks of kind text.
# - A guide has at most 350 lines.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/guide_blocks.cmake)

get_filename_component(ROOT "${ROOT}" ABSOLUTE)
file(GLOB guides RELATIVE ${ROOT} ${ROOT}/lib/docs/*.md)
set(sources "")
foreach(folders "lib/docs;examples" "lib;include;tests")  # the first two have most blocks
  set(patterns "")
  foreach(folder IN LISTS folders)
    list(APPEND patterns ${ROOT}/${folder}/*.cpp ${ROOT}/${folder}/*.hpp)
  endforeach()
  file(GLOB_RECURSE more ${patterns})
  list(APPEND sources ${more})
endforeach()
list(REMOVE_DUPLICATES sources)

# in_a_source(block found): true if a source contains the lines of the block, apart from the indentation.
function(in_a_source block found)
  set(${found} FALSE PARENT_SCOPE)
  string(STRIP "${block}" block)
  string(REGEX REPLACE "\n +" "\n" block "\n${block}\n")
  foreach(source IN LISTS sources)
    file(READ ${source} text)
    string(REGEX REPLACE "\n +" "\n" text "\n${text}")
    string(FIND "${text}" "${block}" position)
    if(NOT position EQUAL -1)
      set(${found} TRUE PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# check_path(page path): adds a fault if the path exists neither in the root nor in the folder of the page.
function(check_path page path)
  get_filename_component(folder ${ROOT}/${page} DIRECTORY)
  if(NOT EXISTS ${ROOT}/${path} AND NOT EXISTS ${folder}/${path})
    set(faults "${faults}\n  ${page}: ${path}: must exist" PARENT_SCOPE)
  endif()
endfunction()

set(faults "")
set(checked 0)
foreach(page README.md ${guides})
  petzval_guide_blocks(${ROOT}/${page} blocks prose)
  foreach(index RANGE ${blocks})
    if(index EQUAL blocks)
      break()
    endif()
    set(block "${block_${index}}")
    if(kind_${index} STREQUAL "cpp")
      math(EXPR checked "${checked} + 1")
      in_a_source("${block}" found)
      if(NOT found)
        string(APPEND faults "\n  ${page}:${line_${index}}: a block cpp; must be a part of a source in lib/docs or examples")
      endif()
    elseif(page MATCHES "^lib/docs/" AND NOT kind_${index} MATCHES "^(sh|text|cmake|json)$")
      string(APPEND faults "\n  ${page}:${line_${index}}: kind of the block = \"${kind_${index}}\"; must be cpp, sh, text, cmake or json")
    endif()
  endforeach()

  string(REPLACE "](" "@link(" prose "${prose}")  # a bracket would join the elements of a list
  string(REGEX MATCHALL "@link\\([^)#: ]+[)#]" links "${prose}")
  foreach(link IN LISTS links)
    string(REGEX REPLACE "^@link\\((.*)[)#]$" "\\1" link "${link}")
    check_path(${page} "${link}")
  endforeach()
  string(REGEX MATCHALL "`(cmake|data|examples|include|lib|tests)/[A-Za-z0-9_./-]*`" paths "${prose}")
  foreach(path IN LISTS paths)
    string(REPLACE "`" "" path "${path}")
    check_path(${page} "${path}")
  endforeach()

  if(page MATCHES "^lib/docs/" AND lines GREATER 350)
    string(APPEND faults "\n  ${page}: lines = ${lines}; must be at most 350")
  endif()
endforeach()

if(NOT sources OR NOT checked)
  message(FATAL_ERROR "ROOT = ${ROOT}: no sources or no blocks; must be the repository")
elseif(faults)
  message(FATAL_ERROR "Guides:${faults}")
endif()
