# shellcheck shell=bash disable=SC2034
# setup.sh - what demo.sh and test.sh share: packages, and builds that keep quiet unless they fail.
# Sourced by bash with `set -euo pipefail`, from the project's top folder.

BUILD_PACKAGES=(
    gcc g++ cmake ninja-build pkg-config glslang-tools spirv-tools spirv-cross
    libvulkan-dev mesa-vulkan-drivers
    libtinygltf-dev libxxhash-dev libcjson-dev libstb-dev libtinyexr-dev
    libcmocka-dev libembree-dev
)
TEST_PACKAGES=(clang libclang-rt-dev libomp-dev assimp-testmodels libcgal-demo)

# Installs those of the packages named that are missing, and says which.
install_packages()
{
    local package missing=()
    if ! command -v dpkg-query > /dev/null; then
        echo "set-up: this is no Debian; going on without installing. Needed, by Debian's names: $*"
        return
    fi
    for package in "$@"; do
        if [[ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2> /dev/null)" != installed ]]; then
            missing+=("$package")
        fi
    done
    if ((${#missing[@]} == 0)); then
        echo "set-up: all packages are here"
        return
    fi
    echo "set-up: installing ${missing[*]}"
    local as_root=()
    if ((EUID != 0)); then
        if ! command -v sudo > /dev/null; then
            echo "set-up: no root and no sudo; install these packages as root and start again" >&2
            exit 1
        fi
        as_root=(sudo)
    fi
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq)
    run_logged set-up "${apt[@]}" update
    run_logged set-up "${apt[@]}" install --yes --no-install-recommends "${missing[@]}"
}

# run_logged NAME COMMAND...: keeps the output in build/NAME.log and shows its end if the command fails.
run_logged()
{
    local log=build/$1.log
    shift
    mkdir -p build
    if ! "$@" > "$log" 2>&1 < /dev/null; then
        tail -n 40 "$log" >&2
        echo "failed: $* (all of its output: $log)" >&2
        return 1
    fi
}

# build_preset PRESET [TARGET...]: configures, then builds the targets, or everything.
build_preset()
{
    local preset=$1
    shift
    local targets=()
    if (($# > 0)); then
        targets=(--target "$@")
    fi
    run_logged "$preset-configure" cmake --preset "$preset" &&
        run_logged "$preset-build" cmake --build --preset "$preset" "${targets[@]}"
}
