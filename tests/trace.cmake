# The runtime library and the batch tracer.

# A device, a file on it, rays to hits: for every test that traces.
add_library(ls_test_gpu STATIC gpu.c)
target_include_directories(ls_test_gpu PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(ls_test_gpu PUBLIC ls_app PRIVATE ls_options PkgConfig::CMOCKA)

ls_add_test(NAME test_runtime SOURCES test_runtime.c runtime_fixture.c small_scenes.c
    LIBRARIES ls_test_gpu ls_format_write)
ls_add_test(NAME test_devices SOURCES test_devices.c runtime_fixture.c fake_vulkan.c small_scenes.c
    LIBRARIES ls_test_gpu ls_format_write)
ls_add_test(NAME test_lstrace SOURCES test_lstrace.c small_scenes.c
    LIBRARIES ls_format_write ARGS $<TARGET_FILE:lstrace>)
add_dependencies(test_lstrace lstrace)

# The benchmark in the bundled box: its rays by every method, in both numbers of passes, and by Embree, all with as many
# hits; answers like brute force's.
add_test(NAME test_lsbench COMMAND ${PROJECT_SOURCE_DIR}/tests/test_lsbench.sh
    $<TARGET_FILE:lsbake> $<TARGET_FILE:lsbench> ${PROJECT_SOURCE_DIR}/scenes)
