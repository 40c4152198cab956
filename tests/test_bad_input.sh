#!/usr/bin/env bash
# test_bad_input.sh GROUP PROGRAMS SCENES - what the built programs do with bad input and bad places.
#
# GROUP: "bake" for lsbake and lsinfo, "runtime" for lstrace and lsview. PROGRAMS: folder of the programs. SCENES:
# folder of the bundled scenes. Every case must end with its documented exit code and, after warnings if there are
# any, one line on standard error that has the message's number and names the file or the thing, print nothing else,
# and leave the folder "out" as it was.
set -uo pipefail

group=$1
programs=$2
scenes=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
mkdir out a_folder
standard_output=stdout.txt
count=0
wrong=0

# Everything below out/ with its bytes.
list_out()
{
    find out -mindepth 1 \( -type f -exec cksum {} + -o -print \) | sort
}

# check NUMBER WORD COMMAND... : NUMBER is the message's, of four digits, which tells the exit code, or the exit code
# alone; WORD is what the line must name.
check()
{
    local expected=$1 word=$2 number="" before after result
    shift 2
    if ((expected >= 1000)); then
        number=$expected
        expected=$((number < 2000 ? 1 : number < 4000 ? 2 : number / 1000 - 1))
    fi
    before=$(list_out)
    : > stdout.txt
    "$programs/$1" "${@:2}" > "$standard_output" 2> stderr.txt < /dev/null
    result=$?
    after=$(list_out)
    local complaints=()
    ((result == expected)) || complaints+=("exit code $result instead of $expected")
    [[ $(grep -cv "^$1: warning [0-9]*: " stderr.txt) == 1 && $(tail -c 1 stderr.txt | od -An -c) == *'\n'* ]] ||
        complaints+=("standard error is not one line")
    [[ -z $number ]] || grep -qF "error $number: " stderr.txt || complaints+=("standard error has not the number $number")
    [[ "$*" != *--strict* ]] || ! grep -qF "warning $number: " stderr.txt || complaints+=("told as a warning and as an error")
    grep -qF -- "$word" stderr.txt || complaints+=("standard error does not name \"$word\"")
    [[ ! -s stdout.txt ]] || complaints+=("something on standard output")
    [[ "$before" == "$after" ]] || complaints+=("out/ has changed")
    count=$((count + 1))
    if ((${#complaints[@]} > 0)); then
        wrong=$((wrong + 1))
        printf 'WRONG: %s\n' "$*"
        printf '  %s\n' "${complaints[@]}"
        sed 's/^/  | /' stderr.txt
        ls -A out
        rm -rf out/.??*
    fi
}

# check_full KIB NUMBER WORD COMMAND... : as check, with no room for files of more than KIB.
check_full()
{
    local room=$1 before
    shift
    before=$(ulimit -S -f)
    ulimit -S -f "$room"
    check "$@"
    ulimit -S -f "$before"
}

# check_unheard [NUMBER] COMMAND... : as check, with a standard output that takes nothing.
check_unheard()
{
    local standard_output=/dev/full expected=3
    if [[ $1 =~ ^[0-9]+$ ]]; then
        expected=$1
        shift
    fi
    check "$expected" "standard output" "$@"
}

# ---- Inputs -----------------------------------------------------------------------------------------

ply_header()
{
    printf 'ply\nformat %s 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' "$1"
    printf 'element face 1\nproperty list uchar int vertex_indices\nend_header\n'
}

# A triangle whose first coordinate is the four bytes given.
binary_triangle()
{
    ply_header binary_little_endian
    # shellcheck disable=SC2059
    printf "$1"'\0\0\0\0\0\0\0\0'
    printf '\0\0\200\077\0\0\0\0\0\0\0\0'
    printf '\0\0\0\0\0\0\200\077\0\0\0\0'
    printf '\003\0\0\0\0\001\0\0\0\002\0\0\0'
}

ascii_triangle()
{
    ply_header ascii
    printf '%s\n' "$@"
}

gltf()
{
    printf '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0%s}],' "$1"
    printf '"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],'
    printf '"buffers":[{"byteLength":42,"uri":"triangle.bin"}],"bufferViews":[{"buffer":0,"byteLength":42}],'
    printf '"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},'
    printf '{"bufferView":0,"byteOffset":36,"componentType":5123,"count":3,"type":"SCALAR"}]}'
}

{
    printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0'
    printf '\0\0\001\0\011\0'
} > triangle.bin
ascii_triangle '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' > good.ply
: > empty.ply
: > empty.lspace
for ending in ply obj gltf glb xyz lspace; do
    { printf '\211PNG\r\n\032\n'; head -c 20000 "$scenes/bunny.ply" | tail -c 10000; } > "foreign.$ending"
done

# ---- Usage ------------------------------------------------------------------------------------------

# check_usage PROGRAM [UNKNOWN NOTHING UNHEARD]: the numbers for an unknown option, no argument, no standard output.
check_usage()
{
    check "${2:-1}" "--frobnicate" "$1" --frobnicate
    check "${2:-1}" "Z" "$1" -Z
    check "${3:-1}" "help" "$1"
    check_unheard "${4:-3}" "$1" --help
    check_unheard "${4:-3}" "$1" --version
}

# Programs that read an .lspace file, given as the last word but for those in $tail.
check_lspace()
{
    local program=$1
    shift
    check 2001 missing.lspace "$program" "$@" missing.lspace "${tail[@]}"
    check 2201 empty.lspace "$program" "$@" empty.lspace "${tail[@]}"
    check 2301 a_folder "$program" "$@" a_folder "${tail[@]}"
    check 5001 foreign.lspace "$program" "$@" foreign.lspace "${tail[@]}"
    check 5001 good.ply "$program" "$@" good.ply "${tail[@]}"
    local size kept
    size=$(stat -c %s good.lspace)
    for kept in 1 100 256 300 4095 4096 8192 $((size / 2)) $((size - 1)); do
        head -c "$kept" good.lspace > cut.lspace
        check 4 cut.lspace "$program" "$@" cut.lspace "${tail[@]}"
    done
    { cat good.lspace; printf 'x'; } > longer.lspace
    check 4 longer.lspace "$program" "$@" longer.lspace "${tail[@]}"
    # A byte of the header, which its hash covers; and another version.
    for place in 130 300; do
        cp good.lspace damaged.lspace
        printf '\125' | dd of=damaged.lspace bs=1 seek="$place" conv=notrunc status=none
        check 4 damaged.lspace "$program" "$@" damaged.lspace "${tail[@]}"
    done
    cp good.lspace newer.lspace
    printf '\011' | dd of=newer.lspace bs=1 seek=16 conv=notrunc status=none
    check 4 newer.lspace "$program" "$@" newer.lspace "${tail[@]}"
}

# ---- Group bake -------------------------------------------------------------------------------------

# check_scene SCENE [NUMBER]: bad scenes; an older output, where there is one, stays what it was.
check_scene()
{
    check "${2:-2}" "$1" lsbake "$1" -o out/scene.lspace
    check "${2:-2}" "$1" lsbake good.ply "$1" -o out/older.lspace
}

# check_options NUMBER OPTIONS... : of one scene, each naming its first word.
check_options()
{
    local number=$1 option
    shift
    for option in "$@"; do
        # shellcheck disable=SC2086
        check "$number" "${option%% *}" lsbake good.ply -o out/scene.lspace $option
    done
}

check_bake()
{
    check_usage lsbake 1001 1005 4004
    check 1006 "-o" lsbake good.ply
    check 1002 "-o" lsbake good.ply -o
    check 1002 "-o" lsbake good.ply -o ""
    check 1005 "scene" lsbake -o out/scene.lspace
    check_options 1003 "--grid 0" "--grid 4097" "--grid x" "--grid -1" "--grid 3.5" "--patches 0" "--patches 17" \
        "--patches auto:0" "--patches auto:9" "--patches auto4" "--patches automatic" "--byte-price 0" "--byte-price -1" "--byte-price x" \
        "--scene-shafts 0" "--scene-shafts 33" "--scene-shafts auto" "--divide-above 2" "--divide-above 1000001" "--divide-above none" \
        "--threads 0" "--threads 99999999999999999999" "--scale 0" "--scale -1" "--scale 1e31" "--scale x" "--scale 0x10" \
        "--scale nan" "--scale inf" "--scale 1,5" "--size 0" "--size 1m" "--turn 361" "--at 0" "--at 0,1" "--at 0,1,2,3" \
        "--at 0,,2" "--at 1e31,0,0" "--at a,b,c" "--at 0,1,nan" "--max-memory 0" "--max-memory 4T" "--max-memory 1.5G" \
        "--max-memory -1" "--max-memory G" "--max-memory 4GB" "--max-memory 99999999999999999999" \
        "--max-memory 99999999999G" "--max-triangles 0" "--max-triangles 1e6" "--max-triangles -5" "--scene -1" "--scene x"
    check_options 1004 "--report xml" "--up w" "--up yz" "--normals smooth" "--normals 181" "--normals -1"
    check_options 1002 "--grid" "--at" "--material" "--max-memory" "--report"
    check 1002 "--material" lsbake good.ply -o out/scene.lspace --material ""
    check 1004 "--up" lsbake good.ply -o out/scene.lspace --up ""
    check_options 1009 "--scene 0"
    # Options of an input stand behind one.
    local option
    for option in --flip "--up z" "--scale 2" "--size 1" "--turn 5" "--at 0,0,0" "--scene 0" "--material {}"; do
        # shellcheck disable=SC2086
        check 1008 "${option%% *}" lsbake $option good.ply -o out/scene.lspace
    done

    echo "an older bake" > out/older.lspace
    mkdir a_folder.ply
    for scene in missing.ply missing.gltf good.ply/inside.ply; do
        check_scene "$scene" 2001
    done
    check_scene empty.ply 2201
    check_scene a_folder 2301
    check_scene a_folder.ply 2301
    check_scene foreign.ply 3001
    check_scene foreign.obj 3023
    check_scene foreign.gltf 3070
    check_scene foreign.glb 3071
    check_scene foreign.xyz 3590

    head -c 700000 "$scenes/bunny.ply" > cut.ply
    check_scene cut.ply 3005
    head -c 150 "$scenes/bunny.ply" > cut_header.ply
    check_scene cut_header.ply 3002
    head -c 2000 "$scenes/cornell.gltf" > cut.gltf
    check_scene cut.gltf 3070
    printf 'glTF\002\0\0\0\377\0\0\0' > cut.glb
    check_scene cut.glb 3071

    ascii_triangle '0 0 0' '1 0 0' '0 1 0' '3 0 1 3' > index.ply
    check_scene index.ply 3101
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' > index.obj
    check_scene index.obj 3120
    gltf '' > index.gltf
    check_scene index.gltf 3172

    binary_triangle '\0\0\300\177' > nan.ply
    check_scene nan.ply 3290
    binary_triangle '\0\0\200\377' > infinite.ply
    check_scene infinite.ply 3290
    printf 'v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > nan.obj
    check_scene nan.obj 3290
    ascii_triangle '0 nan 0' '1 0 0' '0 1 0' '3 0 1 2' > nan_text.ply
    check_scene nan_text.ply 3290
    binary_triangle '\0\0\0\0' > finite.ply
    "$programs/lsbake" finite.ply -o finite.lspace --quiet || wrong=$((wrong + 1))

    # Nothing to hit, in files of every kind. Several inputs may hold such a one as long as one has triangles.
    printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n' > points.ply
    printf 'v 0 0 0\n' > points.obj
    printf '{"asset":{"version":"2.0"},"scenes":[{}]}' > nothing.gltf
    printf '{"asset":{"version":"2.0"}}' > no_scene.gltf
    ascii_triangle '0 0 0' '1 0 0' '0 1 0' '3 0 1 1' > no_area.ply
    for scene in points.ply points.obj nothing.gltf no_scene.gltf; do
        check 3390 "triangle" lsbake "$scene" -o out/scene.lspace
        check 3390 "triangle" lsbake "$scene" -o out/older.lspace
    done
    check 3391 "triangle" lsbake no_area.ply -o out/scene.lspace
    check 3391 "triangle" lsbake no_area.ply -o out/older.lspace

    ascii_triangle '1e30 0 0' '1e30 1 0' '1e30 0 1' '3 0 1 2' > far.ply
    check_scene far.ply 3490
    printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0\0\0\001\0\002\0' > triangle.bin
    gltf ',"scale":[1,1,1e-9]' > flat.gltf
    check 3691 "transform" lsbake flat.gltf -o out/scene.lspace
    gltf ',"scale":[0,0,0]' > zero.gltf
    check 3690 "transform" lsbake zero.gltf -o out/scene.lspace
    gltf ',"translation":[0,0' > broken.gltf
    check_scene broken.gltf 3070
    gltf '' > lonely.gltf
    mv triangle.bin elsewhere.bin
    check_scene lonely.gltf 3075

    # Placement and materials.
    check 3090 points.ply lsbake points.ply --at 0,0,0 -o out/scene.lspace
    check 3090 nothing.gltf lsbake good.ply nothing.gltf --size 2 -o out/older.lspace
    check 3495 far.ply lsbake far.ply --scale 1e30 -o out/scene.lspace
    printf '{"ior": 1.5, "gloss": 1}' > key.json
    printf '{"materials": {"gold": {}}}' > name.json
    printf '{"ior": "glass"}' > value.json
    printf '{"ior": 1.5' > broken.json
    check 3091 broken.json lsbake good.ply --material broken.json -o out/scene.lspace
    check 3091 "--material" lsbake good.ply --material '{"ior": 1.5' -o out/older.lspace
    check 3092 gloss lsbake good.ply --material key.json -o out/scene.lspace
    check 3093 ior lsbake good.ply --material value.json -o out/scene.lspace
    check 3094 gold lsbake good.ply --material name.json -o out/scene.lspace
    check 2001 missing.json lsbake good.ply --material missing.json -o out/scene.lspace
    check 2201 empty.ply lsbake good.ply --material empty.ply -o out/scene.lspace
    check 2301 a_folder lsbake good.ply --material a_folder -o out/scene.lspace

    # Limits.
    check 3790 bunny.ply lsbake "$scenes/bunny.ply" --max-triangles 69665 -o out/scene.lspace
    check 3790 good.ply lsbake good.ply good.ply --max-triangles 1 -o out/older.lspace
    check 3791 bunny.ply lsbake "$scenes/bunny.ply" --max-memory 1M -o out/scene.lspace
    check 3791 shafts lsbake "$scenes/bunny.ply" --patches 16 --max-memory 1G -o out/older.lspace
    # What no stage can tell beforehand; sanitizers of memory cannot live with a limit of the process.
    if [[ ! ${LS_SANITIZE:-} =~ address|thread ]]; then
        check 7001 "--max-memory" lsbake "$scenes/bunny.ply" --grid 400 --threads 1 --max-memory 30M -o out/scene.lspace
        check 7001 "--max-memory" lsbake "$scenes/bunny.ply" --grid 400 --threads 1 --max-memory 30M -o out/older.lspace
    fi
    "$programs/lsbake" good.ply --max-memory 64M --max-triangles 1 -o good_limit.lspace --quiet || wrong=$((wrong + 1))

    # Warnings: shown, all of them in the report, errors if asked for.
    check 3807 points.ply lsbake good.ply points.ply --strict -o out/scene.lspace
    check 3807 points.ply lsbake good.ply points.ply --strict -o out/older.lspace
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 0\nf 1//1 2//1 3//1\n' > odd_normals.obj # found by the mesh stage
    check 3895 odd_normals.obj lsbake odd_normals.obj --strict -o out/older.lspace
    "$programs/lsbake" good.ply points.ply -o warned.lspace --report json > stdout.txt 2> stderr.txt || wrong=$((wrong + 1))
    [[ $(grep -c '^lsbake: warning 3807: points.ply: ' stderr.txt) == 1 && $(wc -l < stderr.txt) == 1 ]] || wrong=$((wrong + 1))
    [[ $(head -c 1 stdout.txt) == '{' && $(grep -c '"number":.*3807' stdout.txt) == 1 ]] || wrong=$((wrong + 1))
    "$programs/lsbake" good.ply points.ply -o warned.lspace --quiet > stdout.txt 2> stderr.txt || wrong=$((wrong + 1))
    [[ ! -s stdout.txt && ! -s stderr.txt ]] || wrong=$((wrong + 1))
    local names
    names=$(printf ',"TEST_%s"' {1..25})
    printf '{"asset":{"version":"2.0"},"scenes":[{}],"extensionsUsed":[%s]}' "${names#,}" > warnings.gltf
    "$programs/lsbake" good.ply warnings.gltf -o warned.lspace --report json > stdout.txt 2> stderr.txt || wrong=$((wrong + 1))
    [[ $(grep -c '^lsbake: warning 3870: ' stderr.txt) == 20 && $(grep -c 'and 5 more' stderr.txt) == 1 ]] || wrong=$((wrong + 1))
    [[ $(grep -c '"number":.*3870' stdout.txt) == 25 ]] || wrong=$((wrong + 1))
    count=$((count + 4))

    # Bad places for the output.
    check 4002 a_folder lsbake good.ply -o a_folder
    check 4001 nowhere lsbake good.ply -o nowhere/scene.lspace
    check 4001 good.ply lsbake good.ply -o good.ply/scene.lspace
    # Before any scene is read.
    check 4001 nowhere lsbake cut.ply -o nowhere/scene.lspace
    check 4002 a_folder lsbake cut.ply -o a_folder
    check 4002 out/new/ lsbake cut.ply -o out/new/
    check 4003 /dev/null lsbake cut.ply -o /dev/null
    # Outputs that are inputs, by their own name and by others.
    cp good.ply out/scene.ply
    ln -s scene.ply out/link.ply
    ln out/scene.ply out/second_name.ply
    for output in scene.ply ./scene.ply link.ply second_name.ply; do
        check 1007 "out/$output" lsbake out/scene.ply -o "out/$output"
        check 1007 "out/$output" lsbake good.ply out/scene.ply --force -o "out/$output"
    done
    cp key.json out
    check 1007 out/key.json lsbake good.ply --material out/key.json -o out/key.json
    # Files that a scene names are inputs too.
    printf 'mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > out/named.obj
    printf 'newmtl red\nmap_Kd red.ppm\n' > out/red.mtl
    printf 'P6 1 1 255 abc' > out/red.ppm
    check 1007 out/red.mtl lsbake out/named.obj -o out/red.mtl
    check 1007 out/red.ppm lsbake out/named.obj --force -o out/red.ppm
    check 1007 out/red.ppm lsbake out/named.obj -o out/new.lspace --depfile out/red.ppm
    # Depfiles are outputs too.
    check 1007 out/link.ply lsbake out/scene.ply -o out/new.lspace --depfile out/link.ply
    check 1007 out/new.lspace lsbake good.ply -o out/new.lspace --depfile out/new.lspace
    check 4002 a_folder lsbake good.ply -o out/new.lspace --depfile a_folder
    check 4001 nowhere/new.d lsbake good.ply -o out/new.lspace --depfile nowhere/new.d
    # More room than the thread sanitizer takes for itself, less than the bunny.
    for output in out/full.lspace out/older.lspace; do
        check_full 3000 4101 "$output" lsbake "$scenes/bunny.ply" --grid 8 --patches 1 -o "$output"
    done
    [[ -z $(find a_folder nowhere -mindepth 1 2> /dev/null) ]] || wrong=$((wrong + 1))

    check_option_forms
    "$programs/lsbake" good.ply -o good.lspace --quiet || wrong=$((wrong + 1))
    check_unheard 4004 lsbake good.ply -o good.lspace
    check_unheard 4004 lsbake good.ply -o good.lspace --force
    check_unheard 4004 lsbake good.ply -o good.lspace --force --report json
    check_usage lsinfo 1060 1061 4004
    check_unheard 4004 lsinfo good.lspace
    check_unheard 4004 lsinfo --json good.lspace
    check_unheard 4004 lsinfo check good.lspace
    check 1060 "--frobnicate" lsinfo check --frobnicate good.lspace
    local tail=()
    check_lspace lsinfo
    check_lspace lsinfo --json
    check_lspace lsinfo check
    check_lspace lsinfo check --full
    # A byte of a chunk, which only the full check hashes.
    cp good.lspace damaged.lspace
    printf '\125' | dd of=damaged.lspace bs=1 seek=4200 conv=notrunc status=none
    check 4 damaged.lspace lsinfo check --full damaged.lspace
}

# A value behind "=" and the last of two are what they seem to be; what takes none refuses one.
check_option_forms()
{
    local words
    "$programs/lsbake" "$scenes/bunny.ply" --grid 8 --at -1,0,2 -o forms.lspace --quiet
    for words in "--grid=8 --at=-1,0,2" "--grid 9 --grid=8 --at 1,1,1 --at -1,0,2"; do
        count=$((count + 1))
        # shellcheck disable=SC2086
        "$programs/lsbake" "$scenes/bunny.ply" $words --output=other.lspace --quiet && cmp forms.lspace other.lspace ||
            wrong=$((wrong + 1))
    done
    check 1002 "--flip" lsbake good.ply --flip=1 -o out/new.lspace
    check 1003 "'=8'" lsbake good.ply --grid==8 -o out/new.lspace
    check 1002 "--output" lsbake good.ply --output=
    check 1001 "--grids=8" lsbake good.ply --grids=8 -o out/new.lspace
    check 1001 "-o=x" lsbake good.ply -o=x
}

# The shafts of a file are all emptied, which breaks no rule, only hashes and answers.
check_wrong_answers()
{
    local at type offset bytes result
    "$programs/lsbake" "$scenes/cornell.gltf" "$scenes/bunny.ply" --size 1 --at 0,-1,0 --grid 16 --patches 2 -o hollow.lspace --quiet
    for ((at = 256; at < 4096; at += 64)); do
        type=$(dd if=hollow.lspace bs=1 skip=$at count=4 status=none)
        [[ $type != SHFT ]] || break
    done
    read -r offset bytes < <(od -An -j $((at + 8)) -N 16 -t u8 hollow.lspace)
    head -c "$bytes" /dev/zero | dd of=hollow.lspace bs=64K seek="$offset" oflag=seek_bytes conv=notrunc status=none
    "$programs/lsbench" hollow.lspace --size 64x36 --repeat 1 > stdout.txt 2> stderr.txt
    result=$?
    count=$((count + 1))
    if ((result != 5)) || ! grep -qx "lsbench: error 6601: hollow.lspace: [1-9][0-9]* answers differ .*" stderr.txt; then
        echo "WRONG: lsbench on a file without shafts ends with $result"
        cat stdout.txt stderr.txt
        wrong=$((wrong + 1))
    fi
}

# ---- Group runtime ----------------------------------------------------------------------------------

check_runtime()
{
    "$programs/lsbake" "$scenes/cornell.gltf" -o good.lspace --quiet || wrong=$((wrong + 1))
    printf '\0\0\0\0\0\0\0\0\0\0\100\100\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\277\0\0\200\177' > rays.bin
    for _ in {1..9}; do cat rays.bin rays.bin > more.bin && mv more.bin rays.bin; done # 512 rays: 16 KiB
    { cat rays.bin; printf 'odd'; } > odd.bin
    : > empty.bin
    echo "older hits" > out/older.bin
    echo "an older picture" > out/older.png

    check_usage lstrace 1020 1022 4004
    local tail=(--rays rays.bin -o out/hits.bin)
    check_lspace lstrace
    check 1022 "--rays" lstrace good.lspace -o out/hits.bin
    check 1022 "-o" lstrace good.lspace --rays rays.bin
    check 1021 "guess" lstrace good.lspace --rays rays.bin -o out/hits.bin --method guess
    check 1021 "--repeat" lstrace good.lspace --rays rays.bin -o out/hits.bin --repeat 0
    check 2001 missing.bin lstrace good.lspace --rays missing.bin -o out/hits.bin
    check 2301 a_folder lstrace good.lspace --rays a_folder -o out/hits.bin
    check 3099 odd.bin lstrace good.lspace --rays odd.bin -o out/hits.bin
    check 3099 odd.bin lstrace good.lspace --rays odd.bin -o out/older.bin
    check 4002 a_folder lstrace good.lspace --rays rays.bin -o a_folder
    check 4001 nowhere lstrace good.lspace --rays rays.bin -o nowhere/hits.bin
    check 4001 nowhere lstrace missing.lspace --rays rays.bin -o nowhere/hits.bin
    check 4002 a_folder lstrace good.lspace --rays odd.bin -o a_folder
    cp good.lspace rays.bin out
    ln -s rays.bin out/link.bin
    check 1023 out/good.lspace lstrace out/good.lspace --rays rays.bin -o out/good.lspace
    check 1023 out/link.bin lstrace good.lspace --rays out/rays.bin -o out/link.bin
    check_unheard 4101 lstrace good.lspace --rays rays.bin -o -
    check_unheard 4004 lstrace good.lspace --rays rays.bin -o hits.bin
    check_full 4 3 out/hits.bin lstrace good.lspace --rays rays.bin -o out/hits.bin --quiet
    check_full 4 3 out/older.bin lstrace good.lspace --rays rays.bin -o out/older.bin --quiet

    check_usage lsbench 1070 1072 4004
    tail=()
    check_lspace lsbench
    local value
    for value in "--size 640" "--size 0x10" "--repeat 0" "--repeat x" "--check -1" "--method brute" "--passes 3" \
        "--embree 0"; do
        # shellcheck disable=SC2086
        check 1071 "${value%% *}" lsbench good.lspace $value
    done
    check_unheard 4004 lsbench good.lspace --size 16x9 --repeat 1
    check_wrong_answers

    check_usage lsview 1040 1042 4004
    tail=(-o out/picture.png)
    check_lspace lsview --headless
    check 1042 "-o" lsview --headless good.lspace
    check 1044 "--headless" lsview good.lspace -o out/picture.png
    local option
    for option in "--size 640" "--size 0x10" "--size axb" "--samples 0" "--samples x" "--depth 0" "--seed -1" \
        "--report xml"; do
        # shellcheck disable=SC2086
        check 1041 "${option##* }" lsview --headless good.lspace -o out/picture.png $option
    done
    check 4002 a_folder lsview --headless good.lspace -o a_folder
    check 4001 nowhere lsview --headless good.lspace -o nowhere/picture.png
    check 3 out/new/ lsview --headless good.lspace -o out/new/
    check 4002 a_folder lsview --headless missing.lspace -o out/picture.png --exr a_folder
    check 3 /dev/null lsview --headless missing.lspace -o /dev/null
    check 3 /dev/null lsview --headless missing.lspace -o out/picture.png --exr /dev/null
    check 1043 out/good.lspace lsview --headless out/good.lspace -o out/good.lspace
    check 1043 out/good.lspace lsview --headless out/good.lspace -o out/picture.png --exr out/good.lspace
    ln -s older.png out/link.png
    check 1043 "--exr" lsview --headless good.lspace -o out/picture.png --exr out/picture.png
    check 1043 "--exr" lsview --headless good.lspace -o out/older.png --exr out/link.png
    check_unheard 4004 lsview --headless good.lspace -o picture.png --size 16x9 --samples 1
    check_unheard 4004 lsview --headless good.lspace -o picture.png --size 16x9 --samples 1 --report json
    local small=(--size 160x90 --samples 1 --quiet)
    check_full 4 3 out/picture.png lsview --headless good.lspace -o out/picture.png "${small[@]}"
    check_full 4 3 out/older.png lsview --headless good.lspace -o out/older.png "${small[@]}"
    check_full 4 3 out/picture.exr lsview --headless good.lspace -o out/picture.png --exr out/picture.exr "${small[@]}"

    # No Vulkan driver at all, by both of the loader's names for it.
    export VK_DRIVER_FILES=/nonexistent.json VK_ICD_FILENAMES=/nonexistent.json
    check 5 "mesa-vulkan-drivers" lstrace good.lspace --rays rays.bin -o out/hits.bin
    check 5 "mesa-vulkan-drivers" lsview --headless good.lspace -o out/picture.png
    unset VK_DRIVER_FILES VK_ICD_FILENAMES
    check 5 "no such card" lstrace good.lspace --rays rays.bin -o out/hits.bin --device "no such card"
    check 5 "no such card" lsview --headless good.lspace -o out/picture.png --device "no such card"
}

"check_$group"
echo "$count cases, $wrong wrong"
((count > 0 && wrong == 0))
