#!/usr/bin/env bash
# Bakes geometry that grids fear at full size and prints what it took; docs/benchmarks.md, "Hard geometry".
# After a release build: tools/hard_geometry.sh [NAME...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=build/release/bin
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
declare -A counts=([stadium]=100000 [span]=100000 [cluster]=1000000 [hub]=100000 [edge]=200000 [flat]=1000000
    [layers]=200000 [equal]=200000 [needles]=1000000)
TIMEFORMAT=%U
printf '%-8s %9s %8s %8s %9s %9s   %s\n' mesh triangles seconds cpu peak file voxels
(($# > 0)) || set -- stadium span cluster hub edge flat layers equal needles
for name in "$@"; do
    "$bin/write_hard_meshes" "$name" "${counts[$name]}" "$folder/in.ply"
    cpu=$({ time "$bin/lsbake" "$folder/in.ply" -o "$folder/out.lspace" --force --report json >"$folder/report.json"; } 2>&1)
    "$bin/lsinfo" check "$folder/out.lspace" >/dev/null
    python3 - "$name" "$folder/report.json" "$cpu" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[2]))
kinds = " ".join("%d %s" % (r["voxels_" + kind], kind) for kind in ("list", "masks", "subgrid", "bvh"))
print("%-8s %9d %8.2f %8s %6.0f MB %6.1f MB   %d cells, %s, %.1f references a triangle" % (sys.argv[1], r["triangles"],
      r["seconds"], sys.argv[3], r["peak_memory_bytes"] * 1e-6, r["file_bytes"] * 1e-6, r["cells"], kinds,
      r["references"] / r["triangles"]))
PYTHON
done
