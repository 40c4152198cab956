ls_add_test(NAME test_import SOURCES test_import.c LIBRARIES ls_import)
