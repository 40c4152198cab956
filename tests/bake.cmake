# The baker against the slow oracles of tests/reference.
add_library(ls_test_oracles STATIC reference/polytope.c)
target_link_libraries(ls_test_oracles PRIVATE ls_options m)
target_include_directories(ls_test_oracles PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
