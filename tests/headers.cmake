# The public headers as applications meet them (label "house"): other languages, other warnings. A
# compiler that is missing gives a test that is skipped by name, never one that passes silently.
set(header_flags -Wall -Wextra -Wpedantic -Werror -I${PROJECT_SOURCE_DIR}/include
    -I${CMAKE_CURRENT_SOURCE_DIR} -c -o /dev/null)

# header_test(NAME COMPILER FLAGS... FILE): the file compiles without a warning
function(header_test name compiler)
    if(compiler)
        add_test(NAME headers_${name} COMMAND ${compiler} ${header_flags} ${ARGN}
            WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/headers)
    else()
        add_test(NAME headers_${name} COMMAND ${CMAKE_COMMAND} -E echo "cannot run: no compiler")
        set_tests_properties(headers_${name} PROPERTIES SKIP_REGULAR_EXPRESSION "cannot run")
    endif()
    set_tests_properties(headers_${name} PROPERTIES LABELS house TIMEOUT 60)
endfunction()

find_program(MCANOPEN_CXX NAMES c++ g++ clang++)
header_test(c99 ${CMAKE_C_COMPILER} -std=c99 include_all.c)
header_test(c11 ${CMAKE_C_COMPILER} -std=c11 -Wconversion -Wcast-qual include_all.c)
header_test(c11_pointers ${CMAKE_C_COMPILER} -std=c11 -Wno-int-conversion pointer_descriptor.c)
header_test(c11_no_short_types ${CMAKE_C_COMPILER} -std=c11 no_short_types.c)
header_test(cxx17 "${MCANOPEN_CXX}" -std=c++17 -Wconversion -Wold-style-cast -x c++ include_all.c)
header_test(cxx17_no_short_types "${MCANOPEN_CXX}" -std=c++17 -x c++ no_short_types.c)

include(CheckCSourceCompiles)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_REQUIRED_FLAGS -m32)
check_c_source_compiles("#include <stdlib.h>\nint abs32(int x) { return abs(x); }" MCANOPEN_CAN_M32)
unset(CMAKE_REQUIRED_FLAGS)
unset(CMAKE_TRY_COMPILE_TARGET_TYPE)
set(compiler_m32 "")
if(MCANOPEN_CAN_M32)
    set(compiler_m32 ${CMAKE_C_COMPILER})
endif()
header_test(abi_m32 "${compiler_m32}" -std=c11 -m32 ../abi.c)
header_test(abi_slave_m32 "${compiler_m32}" -std=c11 -m32 ../abi_slave.c)
header_test(c11_m32 "${compiler_m32}" -std=c11 -m32 include_all.c)

# What this build itself has: compiled with the tests.
add_library(test_abi OBJECT abi.c abi_slave.c)
target_link_libraries(test_abi PRIVATE mcanopen_settings)
target_include_directories(test_abi PRIVATE ${PROJECT_SOURCE_DIR}/include)
