# mcanopen_add_ccf(TARGET DCF... [NODE_ID ID] [OLD_STYLE] [ALL_VALUES] [QUIET]
#                  [OUTPUT_DIRECTORY FOLDER] [OUTPUT NAME])
#
# Makes the concise DCF of each device configuration file by dcf2ccf, as part of the build:
#
#   TARGET            a target of this name makes them all; others may depend on it
#   DCF               below the source folder, else below the build folder (where others make it)
#   NODE_ID           for $NODEID, 1 to 127; without it that of the file
#   OLD_STYLE         PDO mapping: the number of entries first
#   ALL_VALUES        entries without a ParameterValue as well, with their DefaultValue
#   QUIET             no warnings
#   OUTPUT_DIRECTORY  where they are to be, a folder below the build folder (the build folder)
#   OUTPUT            the name, where there is only one; else it is that of the DCF, with .ccf
#
# They are made anew when the DCF, a DownloadFile of it or dcf2ccf is newer. An error in a DCF ends
# the build, with "file:line: error: ...", and leaves an older CCF as it was. Their paths are the
# target's property CCF_FILES: install(FILES $<TARGET_PROPERTY:plant,CCF_FILES> DESTINATION plant).
#
# dcf2ccf is the one of this copy of mcanopen. Where that cannot run, since it is for another
# machine, the variable MCANOPEN_DCF2CCF names another one.
if(CMAKE_VERSION VERSION_LESS 3.20) # has no dependency files for all generators
    function(mcanopen_add_ccf)
        message(FATAL_ERROR "mcanopen_add_ccf needs CMake 3.20 or newer, this is ${CMAKE_VERSION}")
    endfunction()
    return()
endif()

cmake_policy(PUSH)
cmake_policy(VERSION 3.20...3.25)

# An absolute path, as add_custom_command() takes names of files it depends on.
function(mcanopen_ccf_input name ret_path)
    cmake_path(ABSOLUTE_PATH name BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE
        OUTPUT_VARIABLE path)
    if(NOT EXISTS ${path})
        cmake_path(ABSOLUTE_PATH name BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} NORMALIZE
            OUTPUT_VARIABLE path)
    endif()
    set(${ret_path} ${path} PARENT_SCOPE)
endfunction()

function(mcanopen_ccf_program ret_program)
    set(${ret_program} mcanopen::dcf2ccf PARENT_SCOPE)
    if(MCANOPEN_DCF2CCF)
        set(${ret_program} ${MCANOPEN_DCF2CCF} PARENT_SCOPE)
    elseif(NOT TARGET mcanopen::dcf2ccf)
        message(FATAL_ERROR "mcanopen_add_ccf: this copy of mcanopen was built without its tools; "
            "set MCANOPEN_DCF2CCF to a dcf2ccf")
    endif()
endfunction()

function(mcanopen_ccf_refuse target text)
    message(FATAL_ERROR "mcanopen_add_ccf(${target}): ${text}")
endfunction()

# Where it is to be, of what mcanopen_add_ccf() has been told.
function(mcanopen_ccf_output input ret_path)
    cmake_path(GET input STEM LAST_ONLY stem)
    set(name ${stem}.ccf)
    if(DEFINED ccf_OUTPUT)
        set(name ${ccf_OUTPUT})
    endif()
    if(NOT DEFINED ccf_OUTPUT_DIRECTORY)
        set(ccf_OUTPUT_DIRECTORY .)
    endif()
    cmake_path(APPEND ccf_OUTPUT_DIRECTORY ${name} OUTPUT_VARIABLE path)
    cmake_path(ABSOLUTE_PATH path BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} NORMALIZE)
    cmake_path(GET path PARENT_PATH folder)
    file(MAKE_DIRECTORY ${folder})
    set(${ret_path} ${path} PARENT_SCOPE)
endfunction()

function(mcanopen_ccf_command input output)
    mcanopen_ccf_program(program)
    cmake_path(RELATIVE_PATH output BASE_DIRECTORY ${CMAKE_BINARY_DIR} OUTPUT_VARIABLE shown)
    add_custom_command(OUTPUT ${output}
        COMMAND ${program}
            "$<$<BOOL:${ccf_NODE_ID}>:--node-id;${ccf_NODE_ID}>"
            $<$<BOOL:${ccf_OLD_STYLE}>:--old-style>
            $<$<BOOL:${ccf_ALL_VALUES}>:--all>
            $<$<BOOL:${ccf_QUIET}>:--quiet>
            --depfile ${output}.d ${input} ${output}
        DEPENDS ${input} ${program}
        DEPFILE ${output}.d
        COMMENT "Making ${shown}"
        COMMAND_EXPAND_LISTS VERBATIM)
endfunction()

# Decimal, or hexadecimal with 0x.
function(mcanopen_ccf_check_node_id target node_id)
    set(number 0)
    if(node_id MATCHES "^(0[xX][0-9A-Fa-f]+|[0-9]+)$")
        math(EXPR number "${node_id}")
    endif()
    if(number LESS 1 OR number GREATER 127)
        mcanopen_ccf_refuse(${target} "NODE_ID: 1..127 expected, not ${node_id}")
    endif()
endfunction()

function(mcanopen_add_ccf target)
    cmake_parse_arguments(PARSE_ARGV 1 ccf "OLD_STYLE;ALL_VALUES;QUIET"
        "NODE_ID;OUTPUT_DIRECTORY;OUTPUT" "")
    list(LENGTH ccf_UNPARSED_ARGUMENTS count)
    if(count EQUAL 0)
        mcanopen_ccf_refuse(${target} "a DCF expected")
    elseif(ccf_KEYWORDS_MISSING_VALUES)
        mcanopen_ccf_refuse(${target} "${ccf_KEYWORDS_MISSING_VALUES}: a value expected")
    elseif(DEFINED ccf_OUTPUT AND count GREATER 1)
        mcanopen_ccf_refuse(${target} "OUTPUT: one DCF expected, not ${count}")
    elseif(DEFINED ccf_NODE_ID)
        mcanopen_ccf_check_node_id(${target} "${ccf_NODE_ID}")
    endif()

    set(outputs)
    foreach(name ${ccf_UNPARSED_ARGUMENTS})
        mcanopen_ccf_input(${name} input)
        mcanopen_ccf_output(${input} output)
        get_property(others GLOBAL PROPERTY MCANOPEN_CCF_FILES)
        if(output IN_LIST others)
            mcanopen_ccf_refuse(${target} "two files would be ${output}: give one another OUTPUT")
        endif()
        set_property(GLOBAL APPEND PROPERTY MCANOPEN_CCF_FILES ${output})
        list(APPEND outputs ${output})
        mcanopen_ccf_command(${input} ${output})
    endforeach()
    add_custom_target(${target} ALL DEPENDS ${outputs})
    set_property(TARGET ${target} PROPERTY CCF_FILES ${outputs})
endfunction()

cmake_policy(POP)
