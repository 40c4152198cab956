# What is installed, and as what others find it: find_package(linespace) and pkg-config.
#
# Private needs of the build (ls_options, generated headers, libraries used by their headers alone) are linked
# as $<BUILD_INTERFACE:...>, so that none of them reaches who uses an installation. Everything installed may be
# moved: no file names the place it was installed to.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(LS_INSTALL_HEADERS ${CMAKE_INSTALL_INCLUDEDIR}/linespace)
set(LS_INSTALL_SHADERS ${CMAKE_INSTALL_DATADIR}/linespace/shaders)
set(LS_INSTALL_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/linespace)
set(LS_INSTALL_LSBAKE ${CMAKE_INSTALL_BINDIR}/lsbake${CMAKE_EXECUTABLE_SUFFIX})
set(LS_INSTALL_PKGCONFIG ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# ls_public_headers(TARGET FOLDER): FOLDER's headers are TARGET's face, in the build and installed.
function(ls_public_headers TARGET FOLDER)
    target_include_directories(${TARGET} PUBLIC
        $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${FOLDER}> $<INSTALL_INTERFACE:${LS_INSTALL_HEADERS}>)
    if(LS_INSTALL)
        install(DIRECTORY ${FOLDER}/ DESTINATION ${LS_INSTALL_HEADERS} FILES_MATCHING PATTERN "*.h")
    endif()
endfunction()

# ls_install_libraries(PART ls_x ...): the libraries, which package users know as ls::x, and their export set. Static
# ones that a shared one has swallowed are nobody's concern.
function(ls_install_libraries PART)
    set(libraries "")
    foreach(library IN LISTS ARGN)
        get_target_property(type ${library} TYPE)
        if(BUILD_SHARED_LIBS AND type STREQUAL "STATIC_LIBRARY")
            continue()
        endif()
        string(REGEX REPLACE "^ls_" "" name ${library})
        set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
        list(APPEND libraries ${library})
    endforeach()
    install(TARGETS ${libraries} EXPORT linespace-${PART}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT linespace-${PART} NAMESPACE ls:: DESTINATION ${LS_INSTALL_PACKAGE}
        FILE linespace-${PART}-targets.cmake)
endfunction()

function(ls_install_programs)
    install(TARGETS ${ARGN} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# ls_install_pkgconfig(NAME): cmake/NAME.pc.in, with the prefix told from where the file lies.
function(ls_install_pkgconfig NAME)
    file(RELATIVE_PATH LS_PREFIX_FROM_PKGCONFIG /prefix/${LS_INSTALL_PKGCONFIG} /prefix)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/${NAME}.pc.in ${PROJECT_BINARY_DIR}/${NAME}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${NAME}.pc DESTINATION ${LS_INSTALL_PKGCONFIG})
endfunction()

# Everything that belongs to no single library.
function(ls_install_package)
    foreach(place BINDIR INCLUDEDIR LIBDIR DATADIR)
        if(IS_ABSOLUTE "${CMAKE_INSTALL_${place}}")
            message(FATAL_ERROR "CMAKE_INSTALL_${place} must be relative, since an installation can be moved; "
                "give the prefix in CMAKE_INSTALL_PREFIX, or set LS_INSTALL=OFF")
        endif()
    endforeach()

    configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/linespace-config.cmake.in
        ${PROJECT_BINARY_DIR}/linespace-config.cmake
        INSTALL_DESTINATION ${LS_INSTALL_PACKAGE} PATH_VARS LS_INSTALL_SHADERS LS_INSTALL_LSBAKE)
    # Before 1.0 a minor version may break what the one before had.
    write_basic_package_version_file(${PROJECT_BINARY_DIR}/linespace-config-version.cmake
        COMPATIBILITY SameMinorVersion)
    install(FILES ${PROJECT_BINARY_DIR}/linespace-config.cmake ${PROJECT_BINARY_DIR}/linespace-config-version.cmake
        ${PROJECT_SOURCE_DIR}/cmake/ls_add_bake.cmake
        DESTINATION ${LS_INSTALL_PACKAGE})

    ls_install_pkgconfig(linespace-format)
    install(FILES format/SPEC.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
    if(LS_BUILD_RUNTIME)
        ls_install_pkgconfig(linespace-runtime)
        install(FILES shaders/scene.glsl shaders/triangle.glsl shaders/carry.glsl shaders/instance.glsl shaders/walk.glsl
            shaders/linespace.glsl shaders/texels.glsl format/include/ls_layout.h
            DESTINATION ${LS_INSTALL_SHADERS})
    endif()
endfunction()
