#!/usr/bin/env bash
# Installs what is missing, builds, and runs the tests. The last line counts what passed and what failed; a test
# that was skipped or could not run counts as failed.
#
# Without options: all tests of the release build, the bytes of gcc's and clang's bakes compared, and clang's build and
# the sanitizers over everything that needs no GPU. --full adds clang and the sanitizers over what does, and pictures of all
# of the world's files (tests/corpus).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source tools/setup.sh

full=false
case "${1-}" in
    "") ;;
    --full) full=true ;;
    *)
        echo "usage: ./test.sh [--full]" >&2
        exit 1
        ;;
esac

passed=0
failed=0

count_result()
{
    if [[ "$1" == passed ]]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $2"
    fi
}

# run_tests PRESET [CTEST OPTION...]: counts by ctest's own record of each test.
run_tests()
{
    local preset=$1
    shift
    local record=build/$preset-tests.xml
    rm -f "$record"
    # ctest keeps the first 1024 bytes of what a passed test prints, unless told otherwise.
    ctest --preset "$preset" --output-junit "$PWD/$record" --test-output-size-passed 10000000 \
        --test-output-size-failed 10000000 "$@" || true
    if [[ ! -e "$record" ]] || ! grep -q '<testcase ' "$record"; then
        count_result failed "$preset: no test ran"
        return
    fi
    local name status
    while IFS='|' read -r name status; do
        if [[ "$status" == run ]]; then
            count_result passed "$preset: $name"
        else
            count_result failed "$preset: $name ($status)"
        fi
    done < <(sed -n 's/.*<testcase name="\([^"]*\)".* status="\([^"]*\)".*/\1|\2/p' "$record")
    # A case that a program skips leaves the program's own result untouched.
    while read -r name; do
        count_result failed "$preset: $name (skipped)"
    done < <(sed -n 's/.*\[ *SKIPPED *\] \([^ ]\{1,\}\)$/\1/p' "$record" | sort -u)
}

# build_and_test PRESET [CTEST OPTION...]
build_and_test()
{
    echo "== $1"
    if build_preset "$1"; then
        run_tests "$@"
    else
        count_result failed "$1: build"
    fi
}

# print_lines PRESET TEST PATTERN: what a test printed, of the lines that match.
print_lines()
{
    sed -n "/<testcase name=\"$2\"/,/<\/testcase>/p" "build/$1-tests.xml" | grep -E -- "$3" |
        sed 's/^<system-out>//; s/<\/system-out>$//; s/&lt;/</g; s/&gt;/>/g; s/&quot;/"/g; s/&amp;/\&/g' ||
        echo "$2 printed no line of its summary"
}

# What the release build's tests counted.
print_summary()
{
    echo "== exactness: GPU, brute force, references and Embree on the same rays (tests/test_exact.c)"
    print_lines release test_exact '^(<system-out>)?mesh .*\|' | sed -n 1p
    print_lines release test_exact '^[a-z]+ +[0-9].*\|'
    print_lines release test_exact 'excepted'
    echo "== shaft test: what it says against the exact polytope test (tests/test_shafts.c)"
    print_lines release test_shafts 'wrong no$|surplus [0-9]'
    echo "== the world's files by format (tests/corpus)"
    print_lines release test_corpus '^(<system-out>)?corpus'
    echo "== flipped bits of a file (tests/test_file.c)"
    print_lines release test_file 'bit flips caught'
}

# compare_bake NAME INPUT... [LSBAKE OPTION...]: bakes with gcc's and clang's build.
compare_bake()
{
    local name=$1 preset
    shift
    for preset in release clang; do
        run_logged "bytes/$preset-$name" "build/$preset/bin/lsbake" "$@" --force \
            -o "build/bytes/$preset-$name.lspace" || return
    done
    cmp "build/bytes/release-$name.lspace" "build/bytes/clang-$name.lspace" &&
        run_logged "bytes/check-$name" build/clang/bin/lsinfo check --full "build/bytes/release-$name.lspace"
}

# The bundled scene, and the tests' meshes alone and as instances at several settings.
compare_bytes()
{
    rm -rf build/bytes
    mkdir -p build/bytes
    local scene scenes name grid patches same=0 differing=0
    compare_bake cornell scenes/cornell.gltf scenes/bunny.ply || return
    compare_bake shafts scenes/cornell.gltf scenes/bunny.ply --scene-shafts 9 || return
    scenes=$(build/release/bin/write_scenes build/bytes) || return
    for scene in $scenes; do
        for grid in 5 9 24; do
            patches=$((grid % 4 + 1))
            name=$(basename "$scene" | tr . -)-$grid-$patches
            if compare_bake "$name" "$scene" --grid "$grid" --patches "$patches"; then
                same=$((same + 1))
            else
                echo "$name: gcc's and clang's builds differ"
                differing=$((differing + 1))
            fi
            rm -f "build/bytes/"*"-$name.lspace"
        done
    done
    echo "gcc and clang bake the same bytes of $same scenes and the bundled one, with scene shafts too, others of $differing; clang's" \
        "reader takes gcc's files"
    ((same > 0 && differing == 0))
}

install_packages "${BUILD_PACKAGES[@]}" "${TEST_PACKAGES[@]}"

build_and_test release --parallel 2

# Tests that trace on lavapipe carry the label "gpu": they take minutes, sanitized above all.
without_gpu=(--label-exclude gpu)
if $full; then
    without_gpu=()
fi

build_and_test clang --parallel 2 "${without_gpu[@]}"
echo "== bytes"
if compare_bytes; then
    count_result passed bytes
else
    count_result failed "bytes: clang's the same as gcc's"
fi

if $full; then
    echo "== pictures of the world's files"
    if tests/corpus/run.sh --pictures all build/release/bin; then
        count_result passed "corpus pictures"
    else
        count_result failed "corpus pictures"
    fi
fi

build_and_test sanitize --parallel 2 "${without_gpu[@]}"
build_and_test tsan --parallel 2 --label-exclude gpu

print_summary
echo "$passed passed, $failed failed"
((failed == 0))
