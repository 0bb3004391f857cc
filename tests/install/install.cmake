# The installed copy as applications meet it (label "install"): see test_install.py. Left out where
# an application would have to know how the library was built, and where not all is built.
if(MCANOPEN_SANITIZE OR CMAKE_C_FLAGS MATCHES "-m32|--coverage")
    return()
endif()
cmake_path(IS_ABSOLUTE CMAKE_INSTALL_LIBDIR libdir_is_absolute)
if(NOT MCANOPEN_INSTALL_RULES OR NOT MCANOPEN_TOOLS OR libdir_is_absolute)
    return()
endif()

file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/install.json "{
    \"source\": \"${PROJECT_SOURCE_DIR}\",
    \"build\": \"${PROJECT_BINARY_DIR}\",
    \"prefix\": \"${CMAKE_INSTALL_PREFIX}\",
    \"libdir\": \"${CMAKE_INSTALL_LIBDIR}\",
    \"config\": \"${CMAKE_BUILD_TYPE}\",
    \"version\": \"${PROJECT_VERSION}\",
    \"cmake\": \"${CMAKE_COMMAND}\",
    \"generator\": \"${CMAKE_GENERATOR}\",
    \"c_compiler\": \"${CMAKE_C_COMPILER}\",
    \"cxx_compiler\": \"${MCANOPEN_CXX}\"
}
")
set(command ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/install/test_install.py
    ${CMAKE_CURRENT_BINARY_DIR}/install.json)
add_test(NAME install COMMAND ${command} C)
add_test(NAME install_fetched COMMAND ${command} Fetched)
add_test(NAME install_ccf COMMAND ${Python3_EXECUTABLE} -B
    ${CMAKE_CURRENT_SOURCE_DIR}/install/test_install_ccf.py
    ${CMAKE_CURRENT_BINARY_DIR}/install.json)
if(MCANOPEN_CXX)
    add_test(NAME install_cxx COMMAND ${command} Cxx)
else()
    add_test(NAME install_cxx COMMAND ${CMAKE_COMMAND} -E echo "cannot run: no C++ compiler")
    set_tests_properties(install_cxx PROPERTIES SKIP_REGULAR_EXPRESSION "cannot run")
endif()
set_tests_properties(install install_ccf install_cxx install_fetched PROPERTIES
    LABELS install TIMEOUT 300 RESOURCE_LOCK install_manifest)
