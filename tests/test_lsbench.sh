#!/usr/bin/env bash
# test_lsbench.sh LSBAKE LSBENCH SCENES: the benchmark's rays by every method give the same hits, and the answers of brute
# force where it is asked.
set -euo pipefail
lsbake=$1
lsbench=$2
scenes=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail()
{
    echo "WRONG: $1"
    cat ./*.txt
    exit 1
}

"$lsbake" "$scenes/cornell_blocks.gltf" -o blocks.lspace --quiet
"$lsbench" blocks.lspace --size 64x36 --repeat 3 --check 2304 > blocks.txt || fail "blocks"

# One grid among lists: two passes are possible.
"$lsbake" "$scenes/cornell.gltf" "$scenes/bunny.ply" --size 1.2 --at 0,-1,0 --grid 48 -o bunny.lspace --quiet
"$lsbench" bunny.lspace --size 64x36 --repeat 1 --check 48 --passes 2 --embree 2 > two.txt || fail "two passes"
"$lsbench" bunny.lspace --size 64x36 --repeat 1 --check 0 --passes 1 > one.txt || fail "one pass"
"$lsbench" bunny.lspace --size 64x36 --repeat 1 --check 0 --method grid > grid.txt || fail "grid"
for class in camera shadow diffuse; do
    hits=$(awk -v class=$class '$1 == class { print $3 }' two.txt)
    [[ -n "$hits" ]] || fail "no line of $class"
    for other in one grid; do
        [[ "$hits" == "$(awk -v class=$class '$1 == class { print $3 }' $other.txt)" ]] || fail "$other: $class"
    done
    embree=$(awk -v class=$class '$1 == "embree" && $2 == class { print $5 }' two.txt)
    # Embree is no yardstick of exactness: near edges it may answer otherwise.
    awk -v a="$hits" -v b="$embree" 'BEGIN { exit !(b != "" && (a - b) * (a - b) <= 0.04) }' || fail "embree: $class"
done
