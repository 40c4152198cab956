#!/usr/bin/env bash
# Installs what is missing, builds, and runs the tests. The last line counts what passed and what failed; a test
# that was skipped or could not run counts as failed.
#
# Without options: all tests of the release build, the bytes of a gcc and a clang bake compared, and the
# sanitizers over everything that needs no GPU. --full adds the sanitizers over what does.
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
    ctest --preset "$preset" --output-junit "$PWD/$record" "$@" || true
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
    done < <(sed -n 's/.*\[ *SKIPPED *\] \([a-z0-9_]\{1,\}\)$/\1/p' "$record")
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

# Bakes the bundled scene with the build of a preset.
bake_scene()
{
    mkdir -p build/bytes
    run_logged "bake-$1" "build/$1/bin/lsbake" scenes/cornell.gltf scenes/bunny.ply --force \
        -o "build/bytes/$1.lspace"
}

install_packages "${BUILD_PACKAGES[@]}" "${TEST_PACKAGES[@]}"

build_and_test release

echo "== clang"
if build_preset clang && bake_scene release && bake_scene clang &&
    cmp build/bytes/release.lspace build/bytes/clang.lspace &&
    build/clang/bin/lsinfo check --full build/bytes/release.lspace; then
    echo "gcc and clang bake the same bytes, and clang's reader takes gcc's file"
    count_result passed bytes
else
    count_result failed "clang: the same bytes as gcc's"
fi

# Tests that trace on lavapipe carry the label "gpu": sanitized, they take minutes.
without_gpu=(--label-exclude gpu)
if $full; then
    without_gpu=()
fi
build_and_test asan "${without_gpu[@]}"
build_and_test ubsan "${without_gpu[@]}"
build_and_test tsan --label-exclude gpu

echo "$passed passed, $failed failed"
((failed == 0))
