#!/usr/bin/env bash
# test_interrupt.sh PROGRAMS SCENES SLOW_DISK - a bake that is interrupted at any moment leaves what was there before,
# or all of the new file, and nothing beside it. SLOW_DISK: the library of slow_disk.c.
#
# Bakes are ended at moments spread over their whole time, by Ctrl-C, a request to end, a hang-up and by force. Where
# the file system can only write under a temporary name, force leaves that: which shows that some moments
# lie within the writing, and that what is left is noticed.
set -uo pipefail

if (($# != 3)); then
    echo "usage: test_interrupt.sh PROGRAMS SCENES SLOW_DISK" >&2
    exit 1
fi
lsbake=$1/lsbake
bunny=$2/bunny.ply
slow_disk=$3
moments=6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
mkdir out
wrong=0
declare -A ended=()

bake=(env LD_PRELOAD="$slow_disk" "$lsbake" "$bunny" --grid 16 --patches 2 -o out/scene.lspace --depfile out/scene.d
    --quiet)

complain()
{
    echo "WRONG: $*"
    ls -lA out
    wrong=$((wrong + 1))
}

# The folder holds an old or a whole new scene, perhaps its depfile, and nothing else; true if so.
is_clean()
{
    local name
    for name in $(ls -A out); do
        case $name in
            scene.lspace) cmp -s out/scene.lspace old.lspace || cmp -s out/scene.lspace whole.lspace || return 1 ;;
            scene.d) cmp -s out/scene.d whole.d || return 1 ;;
            *) return 1 ;;
        esac
    done
    [[ -e out/scene.lspace || $1 == without ]]
}

# Bakes once, undisturbed, into an empty folder, and sets whole_time to what it takes in seconds now: other work on the
# machine changes that.
measure()
{
    local before
    rm -rf out/{*,.??*}
    before=$(date +%s.%N)
    "${bake[@]}" || exit 1
    whole_time=$(awk "BEGIN { print $(date +%s.%N) - $before }")
}

# interrupt SIGNAL CODE: a bake ended at each moment, in turn with and without an older file. Counts those in which the
# folder is not as it should be in `dirty`, and those that the signal has ended.
interrupt()
{
    local signal=$1 expected=$2 moment seconds code before
    dirty=0
    measure
    for ((moment = 0; moment < moments; moment++)); do
        rm -rf out/{*,.??*}
        before=without
        if ((moment % 2)); then
            before=with
            cp old.lspace out/scene.lspace
        fi
        seconds=$(awk "BEGIN { print $whole_time * ($moment + 0.5) / ($moments - 1) }")
        { timeout --preserve-status -s "$signal" "$seconds" "${bake[@]}"; } 2> stderr.txt # the shell speaks of KILL
        code=$?
        ((code == 0 || code == expected)) || complain "SIG$signal after $seconds s: exit code $code"
        ((code != expected)) || ended[$signal]=$((${ended[$signal]:-0} + 1))
        is_clean "$before" || dirty=$((dirty + 1))
    done
}

echo "an older bake" > old.lspace
measure
cp out/scene.lspace whole.lspace
cp out/scene.d whole.d

for named in "" 1; do
    if [[ -n $named ]]; then
        export LS_NAMED_FILES=1
    fi
    for signal in INT:130 TERM:143 HUP:129 KILL:137; do
        interrupt "${signal%:*}" "${signal#*:}"
        [[ -n $named && $signal == KILL* ]] || ((dirty == 0)) ||
            complain "$dirty of $moments bakes ended by SIG${signal%:*} left something"
    done
done
# On a busy machine all moments may come too early or too late once.
for ((round = 0; round < 10 && dirty == 0; round++)); do
    interrupt KILL 137
done
((dirty > 0)) || complain "no bake was killed while it wrote: the moments miss that"
for signal in INT TERM HUP KILL; do
    echo "SIG$signal: ${ended[$signal]:-0} bakes ended"
    ((${ended[$signal]:-0} > 0)) || complain "SIG$signal ended no bake"
done

# What is ignored stays so, as under nohup.
rm -rf out/{*,.??*}
(
    trap '' HUP
    exec "${bake[@]}"
) &
sleep "$(awk "BEGIN { print $whole_time / 3 }")"
kill -HUP $! || echo "the bake was over before the hang-up"
wait $! || complain "an ignored hang-up ended the bake"
cmp -s out/scene.lspace whole.lspace || complain "an ignored hang-up left another file"

echo "$wrong wrong"
((wrong == 0))
