# SPDX-License-Identifier: Apache-2.0

# petzval_guide_blocks(page count prose): splits a Markdown page into its fenced blocks and the rest.
#
# Sets in the scope of the caller:
#   <count>               number of blocks
#   block_<i>             text of block i
#   kind_<i>, line_<i>    the word after ``` and the number of the block's first line
#   <prose>               text outside the blocks
#   lines                 number of lines of the page
function(petzval_guide_blocks page count prose)
  file(READ ${page} text)
  # Semicolons and brackets would split or join the elements of a list.
  string(REPLACE ";" "@semicolon@" text "${text}")
  string(REPLACE "[" "@open@" text "${text}")
  string(REPLACE "]" "@close@" text "${text}")
  string(REPLACE "\\" "@backslash@" text "${text}")
  string(REGEX REPLACE "\n$" "" text "${text}")
  string(REPLACE "\n" ";" text "${text}")
  set(number 0)
  set(blocks 0)
  set(inside FALSE)
  set(outside "")
  foreach(line IN LISTS text)
    math(EXPR number "${number} + 1")
    string(REPLACE "@semicolon@" ";" line "${line}")
    string(REPLACE "@open@" "[" line "${line}")
    string(REPLACE "@close@" "]" line "${line}")
    string(REPLACE "@backslash@" "\\" line "${line}")
    if(line MATCHES "^```(.*)$")
      if(inside)
        set(block_${blocks} "${block}" PARENT_SCOPE)
        math(EXPR blocks "${blocks} + 1")
        set(inside FALSE)
      else()
        math(EXPR first "${number} + 1")
        set(kind_${blocks} "${CMAKE_MATCH_1}" PARENT_SCOPE)
        set(line_${blocks} ${first} PARENT_SCOPE)
        set(block "")
        set(inside TRUE)
      endif()
    elseif(inside)
      string(APPEND block "${line}\n")
    else()
      string(APPEND outside "${line}\n")
    endif()
  endforeach()
  if(inside)
    message(FATAL_ERROR "${page}:${first}: block has no end; must end with a line ```")
  endif()
  set(${count} ${blocks} PARENT_SCOPE)
  set(${prose} "${outside}" PARENT_SCOPE)
  set(lines ${number} PARENT_SCOPE)
endfunction()
