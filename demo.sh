#!/usr/bin/env bash
# From a fresh Debian 12 to a picture: installs what is missing, builds, bakes the bundled scene, renders it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source tools/setup.sh

if (($# > 0)); then
    echo "usage: ./demo.sh (it takes no options)" >&2
    exit 1
fi

SCENE=out/cornell-bunny.lspace
PICTURE=out/cornell-bunny.png
BAKE_REPORT=out/bake.json
VIEW_REPORT=out/view.json

# The value of a key of a report, without quotes.
read_report()
{
    sed -n "s/^[[:space:]]*\"$2\":[[:space:]]*//p" "$1" | sed 's/,$//; s/^"//; s/"$//'
}

install_packages "${BUILD_PACKAGES[@]}"

echo "build: release preset, the log is build/release-build.log"
build_preset release lsbake lsview
programs=build/release/bin

# The report of the bake that wrote the file is kept: one that finds it up to date has nothing to say.
mkdir -p out
echo "bake: scenes/cornell.gltf and scenes/bunny.ply"
"$programs/lsbake" scenes/cornell.gltf scenes/bunny.ply -o "$SCENE" --report json > "$BAKE_REPORT.new"
baked=""
if [[ "$(read_report "$BAKE_REPORT.new" up_to_date)" == true ]]; then
    baked=" (up to date; this was an earlier run)"
    rm "$BAKE_REPORT.new"
else
    mv "$BAKE_REPORT.new" "$BAKE_REPORT"
fi

echo "render: 640x360"
"$programs/lsview" --headless "$SCENE" -o "$PICTURE" --size 640x360 --report json > "$VIEW_REPORT"

device=$(read_report "$VIEW_REPORT" device)
if [[ "$(read_report "$VIEW_REPORT" device_is_cpu)" == true ]]; then
    device="$device (no GPU here: Vulkan in software, by lavapipe)"
fi
bake_seconds=unknown
if [[ -e "$BAKE_REPORT" ]]; then
    bake_seconds=$(printf '%.2f s' "$(read_report "$BAKE_REPORT" seconds)")
fi

echo
echo "picture: $PWD/$PICTURE"
echo
{
    echo "device|$device"
    echo "bake time|$bake_seconds$baked"
    echo "file size|$(stat -c %s "$SCENE" | awk '{ printf "%.1f MB", $1 / 1e6 }')"
    echo "start-up time|$(printf '%.3f s to the first frame' "$(read_report "$VIEW_REPORT" startup_seconds)")"
    awk -v rays="$(read_report "$VIEW_REPORT" rays_per_second)" \
        -v samples="$(read_report "$VIEW_REPORT" samples_per_second)" \
        -v count="$(read_report "$VIEW_REPORT" samples_per_pixel)" \
        -v seconds="$(read_report "$VIEW_REPORT" render_seconds)" 'BEGIN {
            printf "rays|%.2f Mrays/s\n", rays / 1e6
            printf "samples|%.2f M samples/s, %d a pixel in %.1f s\n", samples / 1e6, count, seconds
        }'
} | awk -F '|' '{ printf "  %-14s %s\n", $1, $2 }'
