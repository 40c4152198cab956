# The libraries as shared ones: built, installed, moved and used. What they export begins with ls_, C++ and all; and the
# runtime needs the C library and ls_format. install.cmake says with what.
cmake_minimum_required(VERSION 3.25)

set(build ${SCRATCH_DIR}/build)
file(REMOVE_RECURSE ${build})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${build} -G ${GENERATOR}
    -D CMAKE_MAKE_PROGRAM=${MAKE_PROGRAM} -D CMAKE_BUILD_TYPE=${CONFIG}
    -D CMAKE_C_COMPILER=${C_COMPILER} -D CMAKE_CXX_COMPILER=${CXX_COMPILER}
    -D BUILD_SHARED_LIBS=ON -D LS_BUILD_TESTS=OFF -D LS_BUILD_RUNTIME=${RUNTIME} -D CMAKE_INSTALL_LIBDIR=${LIBDIR}
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --parallel 2 COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)

# Installs, moves, and runs consumers, as with static libraries; leaves `prefix`.
set(BINARY_DIR ${build})
set(SCRATCH_DIR ${SCRATCH_DIR}/install)
set(ENV{LD_LIBRARY_PATH} ${SCRATCH_DIR}/moved/${LIBDIR}) # for what pkg-config's users link
include(${CMAKE_CURRENT_LIST_DIR}/test_install.cmake)

file(GLOB archives ${prefix}/${LIBDIR}/*.a)
file(GLOB libraries ${prefix}/${LIBDIR}/libls_*.so)
list(LENGTH libraries count)
if(archives OR count LESS 3)
    message(FATAL_ERROR "not the shared libraries alone: ${archives} ${libraries}")
endif()
foreach(library IN LISTS libraries)
    run(${NM} --dynamic --defined-only --extern-only --format=posix ${library})
    string(REGEX MATCHALL "[^\n]+ [A-Za-z] [^\n]*" lines "${printed}")
    set(foreign ${lines})
    list(FILTER foreign EXCLUDE REGEX "^ls_[a-z0-9_]+ ")
    if(foreign OR NOT lines)
        list(JOIN foreign "\n  " foreign)
        message(FATAL_ERROR "${library} exports nothing, or what does not begin with ls_:\n  ${foreign}")
    endif()
    # Programs' paths to libraries must not lead back to the build.
    run(${READELF} --dynamic --wide ${library})
    if(printed MATCHES "${build}")
        message(FATAL_ERROR "${library} names the build:\n${printed}")
    endif()
endforeach()
if(RUNTIME)
    check_needed(${prefix}/${LIBDIR}/libls_runtime.so)
endif()
