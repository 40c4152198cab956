# Exactness: the GPU, the reference, double precision and Embree on the same rays.
add_library(ls_test_embree STATIC reference/ref_embree.c)
target_link_libraries(ls_test_embree PUBLIC ls_test_reference ${LS_EMBREE} PRIVATE ls_options OpenMP::OpenMP_C m)

ls_add_test(NAME test_exact SOURCES test_exact.c
    LIBRARIES ls_test_gpu ls_test_scenes ls_test_reference ls_test_embree)

ls_add_test(NAME test_hard SOURCES test_hard.c hard_meshes.c
    LIBRARIES ls_test_gpu ls_test_scenes)
set_tests_properties(test_hard PROPERTIES LABELS gpu)

# The layouts of masks against each other.
ls_add_test(NAME test_masks SOURCES test_masks.c LIBRARIES ls_test_gpu ls_test_scenes ls_file_fixture)

# The same scenes with scene shafts and without; and the suite with them.
ls_add_test(NAME test_scene_trace SOURCES test_scene_trace.c LIBRARIES ls_test_gpu ls_test_scenes)
set_tests_properties(test_scene_trace PROPERTIES LABELS gpu)
add_test(NAME test_exact_scene_shafts COMMAND test_exact --rays 2000 --scene-shafts 6)
set_tests_properties(test_exact_scene_shafts PROPERTIES LABELS gpu)

# Arrays cut into segments against whole ones.
ls_add_test(NAME test_segments SOURCES test_segments.c LIBRARIES ls_test_gpu ls_test_scenes ls_render)
set_tests_properties(test_segments PROPERTIES LABELS gpu)

# Lists about a grid, in one pass and in two.
ls_add_test(NAME test_lists SOURCES test_lists.c fake_vulkan.c
    LIBRARIES ls_test_gpu ls_test_scenes ls_format_write)
target_include_directories(test_lists PRIVATE ${PROJECT_SOURCE_DIR}/runtime)
set_tests_properties(test_lists PROPERTIES LABELS gpu)
