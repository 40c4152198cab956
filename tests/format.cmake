# The file format: reading, writing, checking, layouts, and the rules between folders.
add_library(ls_file_fixture STATIC file_fixture.c shaft_layout.c)
target_link_libraries(ls_file_fixture PUBLIC ls::format_write PkgConfig::CMOCKA PRIVATE ls_options)
target_compile_definitions(ls_file_fixture PRIVATE LS_BINARY_DIR="${PROJECT_BINARY_DIR}")

ls_add_test(NAME test_check SOURCES test_check.c LIBRARIES ls_file_fixture)
ls_add_test(NAME test_file SOURCES test_file.c LIBRARIES ls_file_fixture)
target_link_options(test_file PRIVATE -Wl,--wrap=madvise)
ls_add_test(NAME test_catalogue SOURCES test_catalogue.c LIBRARIES ls_format)
ls_add_test(NAME test_write SOURCES test_write.c LIBRARIES ls_file_fixture)
foreach(call open64 posix_fallocate64 ftruncate64 pwrite64 fsync rename linkat)
    target_link_options(test_write PRIVATE -Wl,--wrap=${call})
endforeach()
ls_add_test(NAME test_garbage SOURCES test_garbage.c LIBRARIES ls_file_fixture)
ls_add_test(NAME test_roundtrip SOURCES test_roundtrip.c LIBRARIES ls_file_fixture ls_test_scenes)
pkg_check_modules(CJSON REQUIRED IMPORTED_TARGET libcjson)
ls_add_test(NAME test_lsinfo SOURCES test_lsinfo.c LIBRARIES ls_file_fixture PkgConfig::CJSON
    ARGS $<TARGET_FILE:lsinfo>)
add_dependencies(test_lsinfo lsinfo)

# C and GLSL layouts, compared through reflection.
find_program(LS_GLSLANG glslangValidator REQUIRED DOC "GLSL compiler (package glslang-tools)")
find_program(LS_SPIRV_CROSS spirv-cross REQUIRED DOC "SPIR-V reflection (package spirv-cross)")
set(layout_json ${CMAKE_CURRENT_BINARY_DIR}/layout.json)
add_custom_command(OUTPUT ${layout_json}
    COMMAND ${LS_GLSLANG} --quiet -V --target-env vulkan1.2 -S comp
        -I${PROJECT_SOURCE_DIR}/format/include
        -o ${CMAKE_CURRENT_BINARY_DIR}/layout.spv ${CMAKE_CURRENT_SOURCE_DIR}/layout.comp.glsl
    COMMAND ${LS_SPIRV_CROSS} ${CMAKE_CURRENT_BINARY_DIR}/layout.spv --reflect --output ${layout_json}
    DEPENDS layout.comp.glsl ${PROJECT_SOURCE_DIR}/format/include/ls_layout.h
    VERBATIM)
ls_add_test(NAME test_layout SOURCES test_layout.c ${layout_json}
    LIBRARIES ls_file_fixture PkgConfig::CJSON ARGS ${layout_json})

# Each public header compiles alone, as C17 and as C++17; building this is the test.
set(public_headers ls_base.h ls_messages.h ls_layout.h ls_format.h ls_output.h ls_write.h ls_bake.h import.h)
if(LS_BUILD_RUNTIME)
    list(APPEND public_headers ls_runtime.h)
endif()
set(header_sources "")
foreach(header IN LISTS public_headers)
    foreach(ending c cpp)
        set(source ${CMAKE_CURRENT_BINARY_DIR}/compile/${header}.${ending})
        configure_file(compile/header.in ${source} @ONLY)
        list(APPEND header_sources ${source})
    endforeach()
endforeach()
add_library(test_headers OBJECT ${header_sources})
target_compile_options(test_headers PRIVATE -Wall -Wextra -Wpedantic -Wundef -Werror)
target_include_directories(test_headers PRIVATE
    ${PROJECT_SOURCE_DIR}/format/include ${PROJECT_SOURCE_DIR}/bake/include
    ${PROJECT_SOURCE_DIR}/bake/import ${PROJECT_SOURCE_DIR}/runtime/include)

add_test(NAME test_layers COMMAND ${CMAKE_COMMAND}
    -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D SCRATCH_DIR=${CMAKE_CURRENT_BINARY_DIR}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/test_layers.cmake)

set(libraries $<TARGET_FILE:ls_format> $<TARGET_FILE:ls_format_write>)
foreach(library ls_bake ls_import ls_runtime ls_app ls_render)
    if(TARGET ${library})
        list(APPEND libraries $<TARGET_FILE:${library}>)
    endif()
endforeach()
list(JOIN libraries "," libraries)
add_test(NAME test_symbols COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D LIBRARIES=${libraries}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/test_symbols.cmake)
