# ls_add_bake(TARGET OUTPUT FILE SOURCES SCENE... [OPTIONS OPTION...])
#
# A target, part of "all", that has lsbake make FILE from the SCENEs whenever one of them or of the files they name (MTL,
# buffers, images, --material) is newer; if the bytes are still the same lsbake leaves FILE as it is. Relative
# names are below the current source folder, FILE's below the binary folder. A word in SOURCES that begins with "-" is an
# option of the scene before it, its value behind "="; a file named there is not looked for below the source folder.
#
#     ls_add_bake(scene OUTPUT scene.lspace SOURCES box.gltf dragon.ply --size=1.2 --at=0,-1,0 OPTIONS --grid=64)
cmake_policy(PUSH)
cmake_policy(VERSION 3.20...3.25) # CMP0116: depfiles

function(ls_add_bake TARGET)
    cmake_parse_arguments(PARSE_ARGV 1 BAKE "" "OUTPUT" "SOURCES;OPTIONS")
    if(NOT BAKE_OUTPUT OR NOT BAKE_SOURCES OR BAKE_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "ls_add_bake(TARGET OUTPUT FILE SOURCES SCENE... [OPTIONS OPTION...]), not ${ARGV}")
    endif()
    cmake_path(ABSOLUTE_PATH BAKE_OUTPUT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
    set(words "")
    set(scenes "")
    foreach(word IN LISTS BAKE_SOURCES)
        if(NOT word MATCHES "^-")
            cmake_path(ABSOLUTE_PATH word)
            list(APPEND scenes ${word})
        endif()
        list(APPEND words ${word})
    endforeach()
    if(TARGET lsbake) # built in the same tree
        set(baker lsbake)
    else()
        set(baker ${linespace_LSBAKE})
    endif()
    add_custom_command(OUTPUT ${BAKE_OUTPUT}
        COMMAND ${baker} ${words} ${BAKE_OPTIONS} --output=${BAKE_OUTPUT} --depfile=${BAKE_OUTPUT}.d --quiet
        DEPENDS ${scenes} ${baker}
        DEPFILE ${BAKE_OUTPUT}.d
        COMMENT "Baking ${TARGET}"
        VERBATIM)
    add_custom_target(${TARGET} ALL DEPENDS ${BAKE_OUTPUT})
endfunction()

cmake_policy(POP)
