# The file format: reading, writing, checking, layouts, and the rules between folders.
add_library(ls_file_fixture STATIC file_fixture.c)
target_link_libraries(ls_file_fixture PUBLIC ls::format_write PkgConfig::CMOCKA PRIVATE ls_options)
target_compile_definitions(ls_file_fixture PRIVATE LS_BINARY_DIR="${PROJECT_BINARY_DIR}")

ls_add_test(NAME test_check SOURCES test_check.c LIBRARIES ls_file_fixture)
ls_add_test(NAME test_file SOURCES test_file.c LIBRARIES ls_file_fixture)
ls_add_test(NAME test_write SOURCES test_write.c LIBRARIES ls_file_fixture)
foreach(call open64 posix_fallocate64 ftruncate64 pwrite64 fsync rename)
    target_link_options(test_write PRIVATE -Wl,--wrap=${call})
endforeach()
