# The path tracer, its sampling and its reference.
include(${PROJECT_SOURCE_DIR}/cmake/ls_shaders.cmake)
ls_add_shader(sampling_probe sampling_probe.comp.glsl)
find_library(LS_EMBREE embree3 REQUIRED DOC "Ray tracing library (package libembree-dev)")

ls_add_test(NAME test_sampling SOURCES test_sampling.c reference/ref_sampling.c
    LIBRARIES ls_test_gpu ls_shader_sampling_probe)

pkg_check_modules(STB REQUIRED IMPORTED_TARGET stb)
ls_add_test(NAME test_view
    SOURCES test_view.c box_scene.c reference/ref_path.c reference/ref_sampling.c
    LIBRARIES ls_test_gpu ls_render ls_bake ls_format_write PkgConfig::STB ${LS_TINYEXR} ${LS_EMBREE})
add_dependencies(test_view lsview)
