# ls_add_shader(NAME SOURCE [DEFINE]...): GLSL to validated SPIR-V to a C array.
#
# Compiles SOURCE (stage by its ending, *.comp.glsl) with the macros DEFINE and makes the interface library ls_shader_NAME.
# Who links it can include "NAME_spv.h", which defines `static const uint32_t NAME_spv[]`; include
# it in one file. #include in shaders finds shaders/ and format/include/; what was included is
# tracked.
find_program(LS_GLSLANG glslangValidator REQUIRED DOC "GLSL compiler (package glslang-tools)")
find_program(LS_SPIRV_VAL spirv-val REQUIRED DOC "SPIR-V validator (package spirv-tools)")

set(LS_SHADER_EMBED ${CMAKE_CURRENT_LIST_DIR}/embed_spirv.cmake)

function(ls_add_shader NAME SOURCE)
    get_filename_component(SOURCE ${SOURCE} ABSOLUTE)
    if(NOT SOURCE MATCHES "\\.(comp|vert|frag)\\.glsl$")
        message(FATAL_ERROR "${SOURCE}: a shader's name ends in .STAGE.glsl")
    endif()
    set(stage ${CMAKE_MATCH_1})
    list(TRANSFORM ARGN PREPEND -D OUTPUT_VARIABLE defines)
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/spirv)
    set(spirv ${folder}/${NAME}.spv)
    set(header ${folder}/${NAME}_spv.h)
    file(MAKE_DIRECTORY ${folder})
    file(RELATIVE_PATH shown ${PROJECT_SOURCE_DIR} ${SOURCE})

    add_custom_command(OUTPUT ${spirv}
        COMMAND ${LS_GLSLANG} -V --quiet --target-env vulkan1.2 -S ${stage}
            ${defines} -I${PROJECT_SOURCE_DIR}/shaders -I${PROJECT_SOURCE_DIR}/format/include
            --depfile ${spirv}.d -o ${spirv} ${SOURCE}
        COMMAND ${LS_SPIRV_VAL} --target-env vulkan1.2 ${spirv}
        DEPENDS ${SOURCE} DEPFILE ${spirv}.d
        COMMENT "Compiling ${shown}" VERBATIM)
    add_custom_command(OUTPUT ${header}
        COMMAND ${CMAKE_COMMAND} -DSPIRV=${spirv} -DHEADER=${header} -DNAME=${NAME}_spv
            -DSOURCE=${shown} -P ${LS_SHADER_EMBED}
        DEPENDS ${spirv} ${LS_SHADER_EMBED}
        COMMENT "Embedding ${shown}" VERBATIM)

    add_library(ls_shader_${NAME} INTERFACE ${header})
    target_include_directories(ls_shader_${NAME} INTERFACE ${folder})
endfunction()
