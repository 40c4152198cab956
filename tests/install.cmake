# The build installed, moved, and used from outside by CMake and pkg-config, in C and C++.
set(consumer_programs lsinfo lsbake)
if(LS_BUILD_RUNTIME)
    list(APPEND consumer_programs lstrace lsview)
endif()
set(consumer_flags "")
if(LS_SANITIZE)
    set(consumer_flags "-fsanitize=${LS_SANITIZE}")
endif()
add_test(NAME test_install COMMAND ${CMAKE_COMMAND}
    -D SOURCE_DIR=${PROJECT_SOURCE_DIR}
    -D BINARY_DIR=${PROJECT_BINARY_DIR}
    -D SCRATCH_DIR=${CMAKE_CURRENT_BINARY_DIR}/install
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
    -D "PROGRAMS=$<JOIN:${consumer_programs},$<COMMA>>"
    -D RUNTIME=${LS_BUILD_RUNTIME}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/test_install.cmake)
