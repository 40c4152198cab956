# The world's files: Debian's assimp-testmodels through the programs, against the list of outcomes; one mesh in every
# format; the catalogue of messages.
pkg_check_modules(STB REQUIRED IMPORTED_TARGET stb)
add_executable(contact_sheet corpus/contact_sheet.c)
target_link_libraries(contact_sheet PRIVATE ls_options PkgConfig::STB m)

# What the test of them sees, first of all.
add_test(NAME test_corpus_script COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/corpus/test_run.sh)

# A sanitized program takes several times as long, and as much address space as it likes.
set(corpus_limits --seconds 10 --address-space 4194304)
if(LS_SANITIZE)
    set(corpus_limits --seconds 60)
endif()
add_test(NAME test_corpus COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/corpus/run.sh
    ${corpus_limits} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
if(LS_BUILD_RUNTIME AND NOT LS_SANITIZE)
    add_test(NAME test_corpus_pictures COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/corpus/run.sh
        ${corpus_limits} --pictures sample ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
    set_tests_properties(test_corpus_pictures PROPERTIES LABELS gpu)
endif()

add_library(ls_test_mesh_writers STATIC mesh_writers.c)
target_link_libraries(ls_test_mesh_writers PUBLIC ls_test_scenes PRIVATE ls_options PkgConfig::CMOCKA)
ls_add_test(NAME test_formats SOURCES test_formats.c LIBRARIES ls_test_mesh_writers)

add_test(NAME test_messages COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_messages.sh ${PROJECT_SOURCE_DIR})
