# What comes in: the importers, and what the programs do with bad input.
ls_add_test(NAME test_import SOURCES test_import.c LIBRARIES ls_import)
add_library(ls_gltf_fixture STATIC gltf_fixture.c)
target_link_libraries(ls_gltf_fixture PUBLIC ls_import PRIVATE ls_options PkgConfig::CMOCKA)
foreach(topic IN ITEMS "" _looks _meshes _nodes)
    ls_add_test(NAME test_import_gltf${topic} SOURCES test_import_gltf${topic}.c LIBRARIES ls_gltf_fixture)
endforeach()
ls_add_test(NAME test_import_off_stl SOURCES test_import_off_stl.c mesh_files.c
    LIBRARIES ls_import ls_test_mesh_writers)
ls_add_test(NAME test_import_ply SOURCES test_import_ply.c mesh_files.c LIBRARIES ls_import)
ls_add_test(NAME test_import_obj SOURCES test_import_obj.c mesh_files.c LIBRARIES ls_import)

# ls_add_bad_input_test(NAME GROUP): the programs must be built before.
function(ls_add_bad_input_test NAME GROUP)
    add_test(NAME ${NAME} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_bad_input.sh
        ${GROUP} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}/scenes)
    set_tests_properties(${NAME} PROPERTIES ENVIRONMENT "LS_SANITIZE=${LS_SANITIZE}")
endfunction()
ls_add_bad_input_test(test_bad_input bake)
if(LS_BUILD_RUNTIME)
    ls_add_bad_input_test(test_bad_input_runtime runtime)
    set_tests_properties(test_bad_input_runtime PROPERTIES LABELS gpu)
endif()

# Sanitizers want to be loaded first themselves.
if(NOT LS_SANITIZE)
    add_library(slow_disk MODULE slow_disk.c)
    add_test(NAME test_interrupt COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_interrupt.sh
        ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}/scenes $<TARGET_FILE:slow_disk>)
endif()
