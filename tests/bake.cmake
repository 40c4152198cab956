# The baker and the slow second opinions on it.
find_package(OpenMP REQUIRED COMPONENTS C)

# Written from the specification alone: the tracer that tests every triangle, the exact polytope test.
add_library(ls_test_reference STATIC reference/polytope.c reference/ref_trace.c)
target_include_directories(ls_test_reference PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(ls_test_reference PUBLIC ls_format PRIVATE ls_options OpenMP::OpenMP_C m)
# Debug builds test every triangle too.
set_source_files_properties(reference/ref_trace.c PROPERTIES
    COMPILE_OPTIONS "-O3;-fno-trapping-math;-fno-math-errno")

# Meshes, the files baked from them, and rays for those.
add_library(ls_test_scenes STATIC baked.c meshes.c ray_sets.c)
target_include_directories(ls_test_scenes PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(ls_test_scenes PRIVATE
    LS_SOURCE_DIR="${PROJECT_SOURCE_DIR}" LS_BINARY_DIR="${PROJECT_BINARY_DIR}")
target_link_libraries(ls_test_scenes PUBLIC ls_bake ls_format PRIVATE ls_options PkgConfig::CMOCKA m)

ls_add_test(NAME test_reference SOURCES test_reference.c
    LIBRARIES ls_test_scenes ls_test_reference)

# The separable shaft test is private to the baker.
ls_add_test(NAME test_shafts SOURCES test_shafts.c LIBRARIES ls_bake ls_test_reference)
target_include_directories(test_shafts PRIVATE ${PROJECT_SOURCE_DIR}/bake)

ls_add_test(NAME test_voxels SOURCES test_voxels.c
    LIBRARIES ls_test_scenes ls_test_reference)

# What the bake does with its inputs before the mesh stage is private to it too.
foreach(test test_compose test_material_file test_place)
    ls_add_test(NAME ${test} SOURCES ${test}.c compose_fixture.c LIBRARIES ls_bake ls_import)
    target_include_directories(${test} PRIVATE ${PROJECT_SOURCE_DIR}/bake)
endforeach()

# Inputs for test.sh, which bakes them with two compilers' builds.
add_executable(write_scenes write_scenes.c)
target_link_libraries(write_scenes PRIVATE ls_test_scenes ls_options PkgConfig::CMOCKA)
