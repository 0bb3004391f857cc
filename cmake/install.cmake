# What `cmake --install` puts where. Nothing of it knows its prefix: an installed copy may be moved,
# packed or unpacked elsewhere. tests/install has the list of files.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_build ${PROJECT_BINARY_DIR}/package)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mcanopen)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(doc_dir ${CMAKE_INSTALL_DOCDIR})
if(NOT PROJECT_IS_TOP_LEVEL) # there it is the other project's
    set(doc_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/mcanopen)
endif()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    FILES_MATCHING PATTERN *.h)
install(TARGETS mcanopen EXPORT mcanopenTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_BINARY_DIR}/libmcanopen.a DESTINATION ${CMAKE_INSTALL_LIBDIR})

install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${doc_dir})
install(FILES docs/limits.md docs/network-xml.md docs/real-hardware.md docs/threading.md DESTINATION ${doc_dir}/docs)
install(FILES docs/network.xsd DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/mcanopen)
foreach(section 1 5)
    file(GLOB pages CONFIGURE_DEPENDS docs/man/*.${section})
    install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()

# ---- CMake: mcanopen::mcanopen, mcanopen::static, mcanopen::dcf2ccf ------------------------------

install(EXPORT mcanopenTargets NAMESPACE mcanopen:: DESTINATION ${package_dir})
set(static_library ${CMAKE_INSTALL_FULL_LIBDIR}/libmcanopen.a)
configure_package_config_file(cmake/mcanopenConfig.cmake.in
    ${package_build}/mcanopenConfig.cmake
    INSTALL_DESTINATION ${package_dir}
    PATH_VARS CMAKE_INSTALL_INCLUDEDIR static_library)
write_basic_package_version_file(${package_build}/mcanopenConfigVersion.cmake
    COMPATIBILITY SameMajorVersion) # as the SONAME
install(FILES ${package_build}/mcanopenConfig.cmake
    ${package_build}/mcanopenConfigVersion.cmake cmake/mcanopenCcf.cmake
    DESTINATION ${package_dir})

# ---- pkg-config ----------------------------------------------------------------------------------

# pkgconfig_path(FOLDER RET): a folder of the installation as mcanopen.pc writes it, absolute only
# where it was configured so
function(pkgconfig_path folder ret)
    cmake_path(IS_ABSOLUTE folder absolute)
    if(absolute)
        set(${ret} ${folder} PARENT_SCOPE)
    else()
        set(${ret} "\${prefix}/${folder}" PARENT_SCOPE)
    endif()
endfunction()

pkgconfig_path(${CMAKE_INSTALL_LIBDIR} pc_libdir)
pkgconfig_path(${CMAKE_INSTALL_INCLUDEDIR} pc_includedir)
cmake_path(IS_ABSOLUTE CMAKE_INSTALL_LIBDIR libdir_is_absolute)
if(libdir_is_absolute)
    set(pc_prefix ${CMAKE_INSTALL_PREFIX})
else()
    file(RELATIVE_PATH up /prefix/${pkgconfig_dir} /prefix)
    string(REGEX REPLACE "/$" "" up ${up})
    set(pc_prefix "\${pcfiledir}/${up}")
endif()
configure_file(cmake/mcanopen.pc.in ${package_build}/mcanopen.pc @ONLY)
install(FILES ${package_build}/mcanopen.pc DESTINATION ${pkgconfig_dir})
