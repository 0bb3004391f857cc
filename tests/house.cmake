# The rules of the house as tests (label "house"): check_x.py judges the tree, test_check_x.py sees
# that it can fail. They look at sources and objects, so one build type is enough for them.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

function(house_check script)
    set(python ${Python3_EXECUTABLE} -B)
    add_test(NAME ${script} COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/${script}.py ${ARGN})
    add_test(NAME test_${script} COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/test_${script}.py)
    set_tests_properties(${script} test_${script} PROPERTIES LABELS house TIMEOUT 120)
endfunction()

house_check(check_layers
    --objects ${PROJECT_BINARY_DIR}/CMakeFiles/mcanopen_objects.dir/src)
house_check(check_budgets)
house_check(check_exports
    ${PROJECT_SOURCE_DIR}/src/api/mcanopen.map
    $<TARGET_FILE:mcanopen> ${PROJECT_BINARY_DIR}/libmcanopen.a)
house_check(check_messages)
house_check(check_rules)
house_check(check_contract)
foreach(name test_disabling test_mutants)
    add_test(NAME ${name}
        COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/${name}.py)
    set_tests_properties(${name} PROPERTIES LABELS house TIMEOUT 120)
endforeach()
house_check(check_prototypes
    ${PROJECT_SOURCE_DIR}/src/api/mcanopen.map ${PROJECT_SOURCE_DIR}/include)

add_test(NAME check_schema
    COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/docs/make_schema.py --check)
set_tests_properties(check_schema PROPERTIES LABELS house)

if(MCANOPEN_TOOLS)
    house_check(check_man $<TARGET_FILE_DIR:mcanopen_tool>)
    add_test(NAME check_man_made COMMAND ${Python3_EXECUTABLE} -B
        ${PROJECT_SOURCE_DIR}/docs/make_man.py $<TARGET_FILE_DIR:mcanopen_tool> --check)
    set_tests_properties(check_man_made PROPERTIES LABELS house)
endif()

# An application of the static library that has functions named like internal ones.
add_executable(static_link static_link.c)
target_link_libraries(static_link PRIVATE mcanopen_settings mcanopen_static)
add_test(NAME static_link COMMAND static_link)
