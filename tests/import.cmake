# What comes in: the importers, and what the programs do with bad input.
ls_add_test(NAME test_import SOURCES test_import.c LIBRARIES ls_import)
ls_add_test(NAME test_import_off_stl SOURCES test_import_off_stl.c mesh_files.c LIBRARIES ls_import)
ls_add_test(NAME test_import_ply SOURCES test_import_ply.c mesh_files.c LIBRARIES ls_import)
ls_add_test(NAME test_import_obj SOURCES test_import_obj.c mesh_files.c LIBRARIES ls_import)

# ls_add_bad_input_test(NAME GROUP): the programs must be built before.
function(ls_add_bad_input_test NAME GROUP)
    add_test(NAME ${NAME} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_bad_input.sh
        ${GROUP} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}/scenes)
endfunction()
ls_add_bad_input_test(test_bad_input bake)
if(LS_BUILD_RUNTIME)
    ls_add_bad_input_test(test_bad_input_runtime runtime)
    set_tests_properties(test_bad_input_runtime PROPERTIES LABELS gpu)
endif()
