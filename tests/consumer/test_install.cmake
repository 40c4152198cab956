# Installs the build, moves the installation, and builds and runs users of it. install.cmake says with what.
cmake_minimum_required(VERSION 3.25)

set(prefix ${SCRATCH_DIR}/moved)

# run(COMMAND ...): must end with 0; what it printed is in `printed`.
function(run)
    execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE text ERROR_VARIABLE errors RESULT_VARIABLE code)
    if(NOT code EQUAL 0)
        list(JOIN ARGN " " command)
        message(FATAL_ERROR "${command}\nends with ${code}:\n${text}${errors}")
    endif()
    set(printed "${text}" PARENT_SCOPE)
endfunction()

# build(FOLDER ARGS...): configures the consumer with ARGS and builds it in FOLDER.
function(build FOLDER)
    run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/tests/consumer -B ${FOLDER}
        -G ${GENERATOR} -D CMAKE_MAKE_PROGRAM=${MAKE_PROGRAM} -D CMAKE_BUILD_TYPE=${CONFIG}
        -D CMAKE_C_COMPILER=${C_COMPILER} "-DCMAKE_C_FLAGS=${C_FLAGS}"
        -D CMAKE_CXX_COMPILER=${CXX_COMPILER} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
        -D RUNTIME=${RUNTIME} ${ARGN})
    run(${CMAKE_COMMAND} --build ${FOLDER})
endfunction()

# Neither the loader nor anything else but the C library, own libraries and what the sanitizers bring.
function(check_needed PROGRAM)
    run(${READELF} --dynamic --wide ${PROGRAM})
    string(REGEX MATCHALL "NEEDED[^\n]*" needed "${printed}")
    if(NOT needed)
        message(FATAL_ERROR "${PROGRAM} needs no library at all?\n${printed}")
    endif()
    list(FILTER needed EXCLUDE REGEX "\\[(libc\\.so|libls_[a-z_]+\\.so|ld-linux|lib[a-z]san\\.so)")
    if(needed AND NOT C_FLAGS MATCHES "-fsanitize")
        message(FATAL_ERROR "${PROGRAM} needs more than the C library: ${needed}")
    elseif("${needed}" MATCHES "vulkan")
        message(FATAL_ERROR "${PROGRAM} needs the Vulkan loader: ${needed}")
    endif()
endfunction()

# check_users(FOLDER): the programs that were built there.
function(check_users FOLDER)
    run(${FOLDER}/consumer_read ${SCRATCH_DIR}/scene.lspace)
    if(NOT printed MATCHES "^[1-9][0-9]* triangles\n$")
        message(FATAL_ERROR "${FOLDER}/consumer_read prints ${printed}")
    endif()
    check_needed(${FOLDER}/consumer_read)
    if(RUNTIME)
        run(${FOLDER}/consumer_trace)
        check_needed(${FOLDER}/consumer_trace)
    endif()
endfunction()

file(REMOVE_RECURSE ${SCRATCH_DIR})
file(MAKE_DIRECTORY ${SCRATCH_DIR})
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --config ${CONFIG} --prefix ${SCRATCH_DIR}/installed)
file(RENAME ${SCRATCH_DIR}/installed ${prefix})

# No file made for users names a folder of this machine.
file(GLOB_RECURSE made ${prefix}/*.cmake ${prefix}/*.pc)
list(LENGTH made made_count)
if(made_count LESS 7)
    message(FATAL_ERROR "only ${made_count} package files: ${made}")
endif()
foreach(file IN LISTS made)
    file(READ ${file} text)
    foreach(place ${SOURCE_DIR} ${BINARY_DIR} ls_options)
        string(FIND "${text}" "${place}" at)
        if(NOT at EQUAL -1)
            message(FATAL_ERROR "${file} names ${place}")
        endif()
    endforeach()
endforeach()

string(REPLACE "," ";" PROGRAMS "${PROGRAMS}")
foreach(program IN LISTS PROGRAMS)
    run(${prefix}/bin/${program} --help)
endforeach()

# The package: the library in C++ bakes what the installed program bakes.
build(${SCRATCH_DIR}/package -D CMAKE_PREFIX_PATH=${prefix})
run(${prefix}/bin/lsbake ${SOURCE_DIR}/scenes/cornell.gltf -o ${SCRATCH_DIR}/scene.lspace)
run(${SCRATCH_DIR}/package/consumer_bake ${SOURCE_DIR}/scenes/cornell.gltf ${SCRATCH_DIR}/again.lspace)
run(${CMAKE_COMMAND} -E compare_files ${SCRATCH_DIR}/scene.lspace ${SCRATCH_DIR}/again.lspace)
check_users(${SCRATCH_DIR}/package)

# ls_add_bake: what a scene names is known, and what has not changed is left alone.
# expect_bakes(FOLDER NAMES): another build bakes just these.
function(expect_bakes FOLDER)
    run(${CMAKE_COMMAND} --build ${FOLDER})
    foreach(name obj gltf)
        if(("${name}" IN_LIST ARGN AND NOT printed MATCHES "Baking scene_${name}")
                OR (NOT "${name}" IN_LIST ARGN AND printed MATCHES "Baking scene_${name}"))
            message(FATAL_ERROR "bakes of ${ARGN} were expected:\n${printed}")
        endif()
    endforeach()
endfunction()

# Before a file is changed: times of files may be no finer than a second.
function(let_time_pass)
    run(${CMAKE_COMMAND} -E sleep 1.1)
endfunction()

# hash(NAME): of a baked file, in `sum`.
function(hash FOLDER NAME)
    file(SHA256 ${FOLDER}/${NAME}.lspace value)
    set(sum ${value} PARENT_SCOPE)
endfunction()

function(check_bakes FOLDER)
    set(scenes ${FOLDER}-scenes)
    file(WRITE ${scenes}/a.obj "mtllib my own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    file(WRITE "${scenes}/my own.mtl" "newmtl red\nKd 1 0 0\n")
    file(WRITE ${scenes}/b.gltf [[{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"b.bin"}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}]}]])
    # Nine floats, (0,0,0), (x,0,0), (0,x,0) of letters that are numbers: 2.05 or so.
    file(WRITE ${scenes}/b.bin "333@333@333@ABC@333@333@333@ABC@333@")
    build(${FOLDER} -D SCENES=${scenes} ${ARGN})
    expect_bakes(${FOLDER})
    hash(${FOLDER} obj)
    set(first ${sum})
    let_time_pass()
    file(TOUCH "${scenes}/my own.mtl")
    expect_bakes(${FOLDER} obj)
    hash(${FOLDER} obj)
    if(NOT sum STREQUAL first)
        message(FATAL_ERROR "a library that is only touched changes the file")
    endif()
    let_time_pass()
    file(WRITE "${scenes}/my own.mtl" "newmtl red\nKd 0 1 0\n")
    expect_bakes(${FOLDER} obj)
    hash(${FOLDER} obj)
    if(sum STREQUAL first)
        message(FATAL_ERROR "another library leaves the file as it was")
    endif()
    hash(${FOLDER} gltf)
    set(first ${sum})
    let_time_pass()
    file(WRITE ${scenes}/b.bin "333@333@333@ABD@333@333@333@ABC@333@")
    expect_bakes(${FOLDER} gltf)
    hash(${FOLDER} gltf)
    if(sum STREQUAL first)
        message(FATAL_ERROR "another buffer leaves the file as it was")
    endif()
    expect_bakes(${FOLDER})
endfunction()

check_bakes(${SCRATCH_DIR}/bakes -D CMAKE_PREFIX_PATH=${prefix})

# pkg-config and the compiler by itself.
set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
separate_arguments(c_flags UNIX_COMMAND "${C_FLAGS}")
file(MAKE_DIRECTORY ${SCRATCH_DIR}/pkgconfig)
set(users read:format)
if(RUNTIME)
    list(APPEND users trace:runtime)
endif()
foreach(user IN LISTS users)
    string(REPLACE ":" ";" user ${user})
    list(GET user 0 program)
    list(GET user 1 package)
    run(${PKG_CONFIG} --cflags --libs linespace-${package})
    separate_arguments(flags UNIX_COMMAND "${printed}")
    run(${C_COMPILER} -std=c17 ${c_flags} ${SOURCE_DIR}/tests/consumer/consumer_${program}.c ${flags}
        -o ${SCRATCH_DIR}/pkgconfig/consumer_${program})
endforeach()
check_users(${SCRATCH_DIR}/pkgconfig)

# A shader on the installed includes alone: batch.glsl is its own.
if(RUNTIME)
    run(${PKG_CONFIG} --variable=shaderdir linespace-runtime)
    string(STRIP "${printed}" shaders)
    file(COPY ${SOURCE_DIR}/shaders/trace.comp.glsl ${SOURCE_DIR}/shaders/batch.glsl DESTINATION ${SCRATCH_DIR})
    run(${GLSLANG} -V --quiet --target-env vulkan1.2 -S comp -I${shaders} -o ${SCRATCH_DIR}/trace.spv
        ${SCRATCH_DIR}/trace.comp.glsl)
endif()

# The sources in another project's tree.
build(${SCRATCH_DIR}/subdirectory -D SUBDIRECTORY=${SOURCE_DIR})
check_users(${SCRATCH_DIR}/subdirectory)
