#!/usr/bin/env bash
# The measurements that the cost model is fitted to (docs/cost-model.md): a line of comma-separated values for each of many
# bakes of a model in the Cornell box. After a release build, or with a folder of the programs in LS_BIN:
#
#     tools/cost_table.sh MODEL "GRID..." "SETTING..." >TABLE.csv
#
# A setting is N (--patches N), auto:N:PRICE (--patches auto:N --byte-price PRICE), or memory:S (--memory S), or default; +T behind
# it sets --divide-above T. Of a grid "-" no --grid is given. Bakes run ahead of the traces, whose times are
# the device's own. Example:
#
#     tools/cost_table.sh scenes/bunny.ply "48 64 96" "2 3 auto:5:0.001 auto:5:0.001+16"
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if (($# != 3)); then
    sed -n '2,/^set/s/^# \{0,1\}//p' tools/cost_table.sh | sed '$d' >&2
    exit 1
fi
bin=${LS_BIN:-build/release/bin}
model=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

bake_all() {
    local grid=$1 settings=$2 setting
    for setting in $settings; do
        local what=${setting%+*}
        local options=(--patches "$what")
        [[ $what != auto* ]] || options=(--patches "${what%:*}" --byte-price "${what##*:}")
        [[ $what != default ]] || options=()
        [[ $what != memory* ]] || options=(--memory "${what##*:}")
        [[ $setting != *+* ]] || options+=(--divide-above "${setting##*+}")
        [[ $grid == - ]] || options+=(--grid "$grid")
        "$bin/lsbake" scenes/cornell.gltf "$model" --size 1.2 --at 0,-1,0 "${options[@]}" -o "$folder/$setting.lspace" \
            --report json >"$folder/$setting.json"
    done
}

trace_all() {
    local grid=$1 settings=$2 setting
    for setting in $settings; do
        "$bin/lsbench" "$folder/$setting.lspace" --check 0 --repeat "${LS_REPEAT:-21}" >"$folder/trace.txt"
        python3 - "$model" "$grid" "$setting" "$folder/$setting.json" "$folder/trace.txt" <<'PYTHON'
import json, os, sys
model, grid, setting = sys.argv[1:4]
report = json.load(open(sys.argv[4]))
grid = report["most_grid"]
traced = {words[0]: words[1:] for words in map(str.split, open(sys.argv[5])) if words[0] in ("camera", "shadow", "diffuse")}
values = [os.path.splitext(os.path.basename(model))[0], grid, setting, report["file_bytes"]]
values += ["%.4f" % report[name] for name in ("steps_per_line", "lookups_per_line", "tests_per_line")]
for ray in ("camera", "shadow", "diffuse"):
    words = traced[ray]  # count, hits, %, Mrays/s, median, min, max, cells, shafts, tests
    values += [words[4], words[7], words[8], words[9]]
print(",".join(map(str, values)), flush=True)
PYTHON
        rm "$folder/$setting.lspace"
    done
}

echo model,grid,setting,bytes,steps,lookups,tests,camera_ms,camera_cells,camera_shafts,camera_tests,shadow_ms,shadow_cells,shadow_shafts,shadow_tests,diffuse_ms,diffuse_cells,diffuse_shafts,diffuse_tests
for grid in $2; do
    bake_all "$grid" "$3"
    trace_all "$grid" "$3"
done
