# The baker and the slow second opinions on it.
find_package(OpenMP REQUIRED COMPONENTS C)

# Written from the specification alone: the tracer that tests every triangle, the judge of answers, the exact polytope test.
add_library(ls_test_reference STATIC reference/polytope.c reference/ref_layout.c reference/ref_trace.c
    reference/ref_judge.c)
target_include_directories(ls_test_reference PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(ls_test_reference PUBLIC ls_format PRIVATE ls_options OpenMP::OpenMP_C m)
# Debug builds test every triangle too.
set_source_files_properties(reference/ref_layout.c reference/ref_trace.c reference/ref_judge.c PROPERTIES
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
target_compile_definitions(test_shafts PRIVATE $<TARGET_PROPERTY:ls_bake,LS_VARIANTS>)

ls_add_test(NAME test_shaft_cost SOURCES test_shaft_cost.c LIBRARIES ls_test_scenes ls_test_reference)
target_include_directories(test_shaft_cost PRIVATE ${PROJECT_SOURCE_DIR}/bake)

ls_add_test(NAME test_voxels SOURCES test_voxels.c
    LIBRARIES ls_test_scenes ls_test_reference)

ls_add_test(NAME test_scene_shafts SOURCES test_scene_shafts.c LIBRARIES ls_test_scenes ls_file_fixture)

ls_add_test(NAME test_distances SOURCES test_distances.c LIBRARIES ls_bake)
target_include_directories(test_distances PRIVATE ${PROJECT_SOURCE_DIR}/bake)

ls_add_test(NAME test_choose SOURCES test_choose.c hard_meshes.c LIBRARIES ls_test_scenes)
target_include_directories(test_choose PRIVATE ${PROJECT_SOURCE_DIR}/bake)

ls_add_test(NAME test_crowding SOURCES test_crowding.c hard_meshes.c LIBRARIES ls_test_scenes)

# What the bake does with its inputs before the mesh stage is private to it too.
foreach(test test_compose test_material_file test_place)
    ls_add_test(NAME ${test} SOURCES ${test}.c compose_fixture.c LIBRARIES ls_bake ls_import)
    target_include_directories(${test} PRIVATE ${PROJECT_SOURCE_DIR}/bake)
endforeach()

# The files that a bake reads, their hash, and the depfile that lists them.
ls_add_test(NAME test_source SOURCES test_source.c LIBRARIES ls_bake ls_import)
target_include_directories(test_source PRIVATE ${PROJECT_SOURCE_DIR}/bake)

# Inputs for test.sh, which bakes them with two compilers' builds.
add_executable(write_hard_meshes write_hard_meshes.c hard_meshes.c)
target_link_libraries(write_hard_meshes PRIVATE ls_test_scenes ls_options PkgConfig::CMOCKA m)

add_executable(write_scenes write_scenes.c)
target_link_libraries(write_scenes PRIVATE ls_test_scenes ls_options PkgConfig::CMOCKA)

# The mesh stage, whose parts are private to the baker, and a second opinion that shares no code with it.
add_library(ls_test_topology STATIC reference/ref_topology.c)
target_include_directories(ls_test_topology PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(ls_test_topology PRIVATE ls_options)
ls_add_test(NAME test_mesh SOURCES test_mesh.c LIBRARIES ls_bake)
target_include_directories(test_mesh PRIVATE ${PROJECT_SOURCE_DIR}/bake)
ls_add_test(NAME test_report SOURCES test_report.c ${PROJECT_SOURCE_DIR}/bake/cmd/bake_warnings.c
        ${PROJECT_SOURCE_DIR}/bake/cmd/report.c
    LIBRARIES ls_bake PkgConfig::CJSON)
target_include_directories(test_report PRIVATE ${PROJECT_SOURCE_DIR}/bake/cmd)
ls_add_test(NAME test_progress SOURCES test_progress.c ${PROJECT_SOURCE_DIR}/bake/cmd/bar.c LIBRARIES ls_bake)
target_include_directories(test_progress PRIVATE ${PROJECT_SOURCE_DIR}/bake/cmd)
ls_add_test(NAME test_topology SOURCES test_topology.c LIBRARIES ls_bake ls_test_topology)
target_include_directories(test_topology PRIVATE ${PROJECT_SOURCE_DIR}/bake)

# CGAL's meshes, unpacked from Debian's package into the build folder.
ls_add_test(NAME test_cgal SOURCES test_cgal.c LIBRARIES ls_bake ls_test_topology
    ARGS ${PROJECT_BINARY_DIR}/cgal/data/meshes)
target_include_directories(test_cgal PRIVATE ${PROJECT_SOURCE_DIR}/bake)
set(LS_CGAL_DATA /usr/share/doc/libcgal-demo/data.tar.gz CACHE FILEPATH "Debian's libcgal-demo: meshes for test_cgal")
add_test(NAME unpack_cgal COMMAND ${CMAKE_COMMAND} -DARCHIVE=${LS_CGAL_DATA} -DFOLDER=${PROJECT_BINARY_DIR}/cgal
    -P ${CMAKE_CURRENT_SOURCE_DIR}/unpack.cmake)
set_tests_properties(unpack_cgal PROPERTIES FIXTURES_SETUP cgal)
set_tests_properties(test_cgal PROPERTIES FIXTURES_REQUIRED cgal)
