#!/usr/bin/env bash
# Why a scene bakes and traces as fast as it does, in one page: seconds per stage, peak memory, bytes per part, the tests that
# the model expects in a voxel, and what the rays of the benchmark do. After a release build:
#
#     tools/measure.sh MODEL [LSBAKE OPTION...] [-- LSBENCH OPTION...]
#
# MODEL stands in the Cornell box, 1.2 along its longest side. Example:
#
#     tools/measure.sh scenes/bunny.ply --grid 96 --patches auto -- --size 320x180
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if (($# == 0)); then
    sed -n '2,/^set/s/^# \{0,1\}//p' tools/measure.sh >&2
    exit 1
fi
bin=build/release/bin
model=$1
shift
bake=()
while (($# > 0)) && [[ $1 != -- ]]; do
    bake+=("$1")
    shift
done
(($# > 0)) && shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$bin/lsbake" scenes/cornell.gltf "$model" --size 1.2 --at 0,-1,0 "${bake[@]}" --force -o "$folder/box.lspace"
echo
"$bin/lsinfo" "$folder/box.lspace" | sed -n '/^chunk/,/^padding/p'
echo
"$bin/lsbench" "$folder/box.lspace" "$@"
