# Libraries as shared ones, with -D BUILD_SHARED_LIBS=ON. They are static by default: nothing else is as easy to embed.
#
# ls_export_own(TARGET ...): a shared library exports what begins with ls_ and nothing else, neither of its own nor of
# the libraries in it (C++ templates, for one), and bears the version with which it may be exchanged.
set(LS_EXPORTS ${CMAKE_CURRENT_LIST_DIR}/exports.map)

function(ls_export_own)
    foreach(library IN LISTS ARGN)
        if(NOT TARGET ${library})
            continue()
        endif()
        get_target_property(type ${library} TYPE)
        if(type STREQUAL "SHARED_LIBRARY")
            # Before 1.0 a minor version may break what the one before had.
            set_target_properties(${library} PROPERTIES
                VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION} LINK_DEPENDS ${LS_EXPORTS})
            target_link_options(${library} PRIVATE -Wl,--version-script=${LS_EXPORTS} -Wl,--no-undefined)
        endif()
    endforeach()
endfunction()

# What is installed finds its libraries from where it lies, since an installation may be moved.
if(BUILD_SHARED_LIBS AND PROJECT_IS_TOP_LEVEL)
    include(GNUInstallDirs)
    file(RELATIVE_PATH libraries_from_programs /prefix/${CMAKE_INSTALL_BINDIR} /prefix/${CMAKE_INSTALL_LIBDIR})
    set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/${libraries_from_programs}")
endif()
