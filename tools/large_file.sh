#!/usr/bin/env bash
# A file above 4 GiB, all the way: the bunny's shafts at N = 11 are baked, checked in full and traced, and the hits compared
# bit for bit with those of a small file (N = 2) of the same grid and with brute force; docs/benchmarks.md, "Large input".
# After a release build, with 10 GB of disk and of memory free: tools/large_file.sh [FOLDER]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=build/release/bin
folder=$(mktemp -d -p "${1:-.}")
trap 'rm -rf "$folder"' EXIT

# Runs a program and prints its time and peak memory, files that it maps included.
measure()
{
    python3 - "$@" <<'PYTHON'
import resource, subprocess, sys, time
begin = time.monotonic()
subprocess.run(sys.argv[1:], check=True)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
print("  %s: %.1f s, peak %.0f MB" % (sys.argv[1].split("/")[-1], time.monotonic() - begin, peak * 1e-6))
PYTHON
}

measure "$bin/lsbake" scenes/bunny.ply --grid 64 --patches 2 --quiet -o "$folder/small.lspace"
measure "$bin/lsbake" scenes/bunny.ply --grid 64 --patches 11 -o "$folder/large.lspace"
(($(stat -c %s "$folder/large.lspace") > 4 << 30))
measure "$bin/lsinfo" check --full "$folder/large.lspace"
"$bin/lsinfo" "$folder/large.lspace" | grep SHAFTS

# From a sphere around the model to points of its box.
"$bin/lsinfo" --json "$folder/small.lspace" >"$folder/small.json"
python3 - "$folder" <<'PYTHON'
import json, random, struct, sys
summary = json.load(open(sys.argv[1] + "/small.json"))
random.seed(1)
rays = open(sys.argv[1] + "/rays.bin", "wb")
lower, upper = summary["lower"], summary["upper"]
for _ in range(200000):
    target = [random.uniform(a, b) for a, b in zip(lower, upper)]
    way = [random.gauss(0, 1) for _ in range(3)]
    size = sum(x * x for x in way) ** 0.5 / max(b - a for a, b in zip(lower, upper))
    rays.write(struct.pack("<8f", *[t - 2 * w / size for t, w in zip(target, way)], 0.0, *way, float("inf")))
PYTHON
head -c $((32 * 5000)) "$folder/rays.bin" >"$folder/few.bin"
for file in small large; do
    measure "$bin/lstrace" "$folder/$file.lspace" --rays "$folder/rays.bin" -o "$folder/$file.hits"
    "$bin/lstrace" "$folder/$file.lspace" --rays "$folder/few.bin" -o "$folder/$file.few" --quiet
done
"$bin/lstrace" "$folder/small.lspace" --rays "$folder/few.bin" -o "$folder/brute.few" --method brute --quiet
cmp "$folder/small.hits" "$folder/large.hits"
cmp "$folder/brute.few" "$folder/large.few"
echo "equal hits: 200000 rays as in the small file, 5000 of them as by brute force"
