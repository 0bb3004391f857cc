# What the programs of tests/contract.tsv are linked with so that disabling/run.py can take single
# functions of the API, and elements of the manager's XML file, away from them, and run their
# functions alone.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(here ${CMAKE_CURRENT_SOURCE_DIR}/disabling)
set(map ${PROJECT_SOURCE_DIR}/src/api/mcanopen.map)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${map})
file(STRINGS ${map} functions REGEX "^ +m?canOpen[A-Za-z]+;")
list(TRANSFORM functions REPLACE "[ ;]" "")

add_custom_command(OUTPUT switches.c
    COMMAND ${Python3_EXECUTABLE} -B ${here}/make_switches.py ${PROJECT_SOURCE_DIR}/include switches.c
    DEPENDS ${here}/make_switches.py ${CMAKE_CURRENT_SOURCE_DIR}/contract.py
        ${PROJECT_SOURCE_DIR}/include/scanopen.h ${PROJECT_SOURCE_DIR}/include/mcanopen.h
    VERBATIM)
add_library(test_disabling OBJECT ${CMAKE_CURRENT_BINARY_DIR}/switches.c ${here}/elements.c
    ${here}/select.c)
target_link_libraries(test_disabling PUBLIC mcanopen_archive PkgConfig::CHECK)
list(TRANSFORM functions PREPEND "-Wl,--wrap=")
target_link_options(test_disabling INTERFACE ${functions} -Wl,--wrap=_tcase_add_test
    -Wl,--wrap=element_find -Wl,--wrap=element_set)
