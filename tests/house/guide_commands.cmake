# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=... -DBUILD=... -DWORK=... -DPAGE=lib/docs/renderers.md -P guide_commands.cmake: runs the commands of a guide.
#
# Every line of a block ```sh is run in a shell, in a folder that looks like the repository with its build: links to its folders and
# to README.md. Commands write to out. A command whose example program is not built, for want of a library, is left out.
# A block ```text must be a part of the output of the last block ```sh, or of the guide's own program (lib/docs/renderers.cpp), line by
# line, apart from the indentation.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/guide_blocks.cmake)

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
foreach(folder README.md cmake data examples include lib tests)
  file(CREATE_LINK ${ROOT}/${folder} ${WORK}/${folder} SYMBOLIC)
endforeach()
file(CREATE_LINK ${BUILD} ${WORK}/build SYMBOLIC)

# run(command line): runs a command and appends its output to `printed`.
function(run command line)
  execute_process(COMMAND sh -c "${command}" WORKING_DIRECTORY ${WORK}
    OUTPUT_VARIABLE out ERROR_VARIABLE err RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${PAGE}:${line}: ${command}\nexit status = ${status}; must be 0\n${out}${err}")
  endif()
  set(printed "${printed}${out}" PARENT_SCOPE)
endfunction()

# plain(text): the lines of a text without indentation and without blanks at their ends.
function(plain variable)
  string(REGEX REPLACE " *\n *" "\n" text "\n${${variable}}\n")
  string(STRIP "${text}" text)
  set(${variable} "\n${text}\n" PARENT_SCOPE)
endfunction()

set(own "")
get_filename_component(name ${PAGE} NAME_WE)
if(EXISTS ${BUILD}/guides/${name})
  set(printed "")
  run(build/guides/${name} 1)
  set(own "${printed}")
endif()

petzval_guide_blocks(${ROOT}/${PAGE} blocks prose)
set(printed "")
set(skipped FALSE)
foreach(index RANGE ${blocks})
  if(index EQUAL blocks)
    break()
  endif()
  if(kind_${index} STREQUAL "sh")
    set(printed "")
    set(skipped FALSE)
    set(text "${block_${index}}")
    string(REGEX REPLACE "\\\\\n *" "" text "${text}")  # a line that ends in a backslash goes on
    set(line ${line_${index}})
    while(NOT text STREQUAL "")
      string(FIND "${text}" "\n" end)
      string(SUBSTRING "${text}" 0 ${end} command)
      math(EXPR end "${end} + 1")
      string(SUBSTRING "${text}" ${end} -1 text)
      if(command MATCHES "^build/examples/([a-z0-9_]+)")
        set(program ${CMAKE_MATCH_1})
        file(GLOB_RECURSE source ${ROOT}/examples/${program}.cpp)
        if(NOT source)
          message(FATAL_ERROR "${PAGE}:${line}: ${command}\nprogram = ${program}; must be one of examples/")
        elseif(NOT EXISTS ${BUILD}/examples/${program})
          message(STATUS "${PAGE}:${line}: left out, as ${program} is not built")
          set(skipped TRUE)
          continue()
        endif()
      endif()
      run("${command}" ${line})
    endwhile()
  elseif(kind_${index} STREQUAL "text" AND NOT skipped)
    set(expected "${block_${index}}")
    set(output "${own}\n${printed}")
    plain(expected)
    plain(output)
    string(FIND "${output}" "${expected}" position)
    if(position EQUAL -1)
      message(FATAL_ERROR "${PAGE}:${line_${index}}: a block text; must be a part of the output:\n${output}")
    endif()
  endif()
endforeach()
