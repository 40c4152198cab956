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

# Arrays cut into segments against whole ones.
ls_add_test(NAME test_segments SOURCES test_segments.c LIBRARIES ls_test_gpu ls_test_scenes ls_render)
set_tests_properties(test_segments PROPERTIES LABELS gpu)
