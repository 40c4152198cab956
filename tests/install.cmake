# The build installed, moved, and used from outside by CMake and pkg-config, in C and C++.
set(consumer_programs lsinfo lsbake)
if(LS_BUILD_RUNTIME)
    list(APPEND consumer_programs lstrace lsview lsbench)
endif()
list(JOIN consumer_programs "," consumer_programs)
set(consumer_flags "")
if(LS_SANITIZE)
    set(consumer_flags "-fsanitize=${LS_SANITIZE}")
endif()
set(consumer_arguments
    -D SOURCE_DIR=${PROJECT_SOURCE_DIR}
    -D CONFIG=$<CONFIG>
    -D GENERATOR=${CMAKE_GENERATOR}
    -D MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM}
    -D C_COMPILER=${CMAKE_C_COMPILER}
    -D CXX_COMPILER=${CMAKE_CXX_COMPILER}
    "-DC_FLAGS=${CMAKE_C_FLAGS} ${consumer_flags}"
    "-DCXX_FLAGS=${CMAKE_CXX_FLAGS} ${consumer_flags}"
    -D LIBDIR=${CMAKE_INSTALL_LIBDIR}
    -D READELF=${CMAKE_READELF}
    -D PKG_CONFIG=${PKG_CONFIG_EXECUTABLE}
    -D GLSLANG=${LS_GLSLANG}
    -D PROGRAMS=${consumer_programs}
    -D RUNTIME=${LS_BUILD_RUNTIME})
add_test(NAME test_install COMMAND ${CMAKE_COMMAND} ${consumer_arguments}
    -D BINARY_DIR=${PROJECT_BINARY_DIR} -D SCRATCH_DIR=${CMAKE_CURRENT_BINARY_DIR}/install
    -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/test_install.cmake)

# The same with shared libraries, which are built for it. How they are linked has nothing to do with sanitizers.
if(NOT LS_SANITIZE)
    add_test(NAME test_shared COMMAND ${CMAKE_COMMAND} ${consumer_arguments}
        -D SCRATCH_DIR=${CMAKE_CURRENT_BINARY_DIR}/shared -D NM=${CMAKE_NM}
        -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/test_shared.cmake)
endif()

# Installed programs have lost the path to what tells the thread sanitizer of OpenMP's barriers (libarcher.so beside
# libomp.so); the tests in the build folder have it.
if(LS_SANITIZE MATCHES thread)
    set_tests_properties(test_install PROPERTIES ENVIRONMENT OMP_THREAD_LIMIT=1)
endif()
