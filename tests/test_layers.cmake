# The one arrow: format includes nobody; bake and runtime include format's public headers and never each other;
# shaders include ls_layout.h; nobody includes tests. Looks at every #include of C, C++ and GLSL, relative
# paths too. Usage: cmake -D SOURCE_DIR=... -D SCRATCH_DIR=... -P test_layers.cmake
cmake_minimum_required(VERSION 3.25)

set(folders format bake runtime shaders tests)

# Whether a file of `folder` may include `target`, a path from the top.
function(is_allowed folder target result)
    set(${result} FALSE PARENT_SCOPE)
    if(target MATCHES "^${folder}/" OR folder STREQUAL "tests")
        set(${result} TRUE PARENT_SCOPE)
    elseif(folder STREQUAL "shaders")
        if(target STREQUAL "format/include/ls_layout.h")
            set(${result} TRUE PARENT_SCOPE)
        endif()
    elseif(folder STREQUAL "bake" AND target MATCHES "^format/include/")
        set(${result} TRUE PARENT_SCOPE)
    elseif(folder STREQUAL "runtime" AND target MATCHES "^(format/include|shaders)/")
        set(${result} TRUE PARENT_SCOPE)
    endif()
endfunction()

# Lists includes against the arrow below `root`, each as "file -> target", and counts the files looked at.
function(find_violations root result count)
    set(violations "")
    set(files "")
    foreach(folder IN LISTS folders)
        file(GLOB_RECURSE found RELATIVE ${root} ${root}/${folder}/*.c ${root}/${folder}/*.h
            ${root}/${folder}/*.cpp ${root}/${folder}/*.hpp ${root}/${folder}/*.glsl)
        list(APPEND files ${found})
    endforeach()
    # File names are unique in the repository, so a name tells the file.
    foreach(path IN LISTS files)
        get_filename_component(name ${path} NAME)
        if(DEFINED place_${name})
            list(APPEND violations "${path} -> has the name of ${place_${name}}")
        endif()
        set(place_${name} ${path})
        if(path MATCHES "\\.(cpp|hpp)$" AND NOT path MATCHES "^(bake/import|tests)/")
            list(APPEND violations "${path} -> C++ outside bake/import")
        endif()
    endforeach()
    foreach(path IN LISTS files)
        string(REGEX MATCH "^[^/]+" folder ${path})
        get_filename_component(directory ${root}/${path} DIRECTORY)
        file(STRINGS ${root}/${path} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
        foreach(line IN LISTS lines)
            string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*).*" "\\1" included "${line}")
            get_filename_component(name ${included} NAME)
            get_filename_component(beside ${directory}/${included} ABSOLUTE)
            if(EXISTS ${beside})
                file(RELATIVE_PATH target ${root} ${beside})
            elseif(DEFINED place_${name})
                set(target ${place_${name}})
            else()
                continue() # a system's or a generated header
            endif()
            is_allowed(${folder} ${target} allowed)
            if(NOT allowed)
                list(APPEND violations "${path} -> ${target}")
            endif()
        endforeach()
    endforeach()
    list(LENGTH files file_count)
    set(${result} "${violations}" PARENT_SCOPE)
    set(${count} ${file_count} PARENT_SCOPE)
endfunction()

# What the search must find: a small tree that breaks every rule, and keeps some.
function(test_planted_violations)
    set(root ${SCRATCH_DIR}/planted)
    file(REMOVE_RECURSE ${root})
    file(WRITE ${root}/format/include/ls_layout.h "")
    file(WRITE ${root}/format/include/ls_base.h "#include <stdint.h>\n#include \"ls_layout.h\"\n")
    file(WRITE ${root}/format/hash.h "#include \"ls_base.h\"\n")
    file(WRITE ${root}/format/up.c "#include \"mesh.h\"\n")
    file(WRITE ${root}/bake/mesh.h "#include \"ls_base.h\"\n#include \"../format/hash.h\"\n")
    file(WRITE ${root}/bake/side.c "  #  include <context.h>\n")
    file(WRITE ${root}/runtime/context.h "#include \"../format/include/ls_base.h\"\n")
    file(WRITE ${root}/runtime/cmd/deep.c "#include \"../../bake/mesh.h\"\n#include \"trace.glsl\"\n")
    file(WRITE ${root}/runtime/test.c "#include \"fixture.h\"\n")
    file(WRITE ${root}/runtime/more.cpp "")
    file(WRITE ${root}/shaders/trace.glsl "#include \"ls_layout.h\"\n#include \"ls_base.h\"\n")
    file(WRITE ${root}/tests/fixture.h "#include \"../format/hash.h\"\n#include \"mesh.h\"\n")
    file(WRITE ${root}/tests/mesh.h "")
    set(expected
        "bake/mesh.h -> format/hash.h"
        "bake/side.c -> runtime/context.h"
        "format/up.c -> tests/mesh.h"
        "runtime/cmd/deep.c -> bake/mesh.h"
        "runtime/more.cpp -> C++ outside bake/import"
        "runtime/test.c -> tests/fixture.h"
        "shaders/trace.glsl -> format/include/ls_base.h"
        "tests/mesh.h -> has the name of bake/mesh.h")
    find_violations(${root} found count)
    list(SORT found)
    file(REMOVE_RECURSE ${root})
    if(NOT "${found}" STREQUAL "${expected}")
        list(JOIN found "\n  " found)
        message(FATAL_ERROR "the planted violations were not found as expected, but:\n  ${found}")
    endif()
endfunction()

test_planted_violations()
find_violations(${SOURCE_DIR} violations count)
if(violations)
    list(JOIN violations "\n  " violations)
    message(FATAL_ERROR "includes against the arrow:\n  ${violations}")
endif()
if(count LESS 20)
    message(FATAL_ERROR "only ${count} files found below ${SOURCE_DIR}")
endif()
message(STATUS "${count} files, no include against the arrow")
