#!/usr/bin/env bash
# test_run.sh - whether run.sh sees what is wrong: a program of every kind of misbehaviour stands in for lsbake, one that
# does what it should beside them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/models" "$work/programs"
export LC_ALL=C

# The model's name says what its bake does.
cat > "$work/programs/lsbake" << 'END'
#!/usr/bin/env bash
name=$(basename "$1" .ply)
say() { echo "lsbake: $*" >&2; }
report()
{
    local number
    printf '{\n\t"objects":\t1,\n\t"triangles":\t12,\n\t"warnings":\t['
    for number in "$@"; do printf '{\n\t\t\t"number":\t%s,\n\t\t\t"text":\t"x"\n\t\t}, ' "$number"; done
    printf ']\n}\n'
}
bake() { echo baked > "$3"; }
case "$name" in
    good) bake "$@"; report ;;
    good_error) say "error 3001: $name.ply: line 1: wrong; mend it"; exit 2 ;;
    good_warnings)
        for number in 3802 3801 3802; do say "warning $number: $name.ply: a thing is left out"; done
        bake "$@"; report 3802 3801 3802 ;;
    many_warnings)
        say "warning 3801: $name.ply: a thing is left out"; say "and 1 more warnings (all in --report json)"
        bake "$@"; report 3801 3801 ;;
    changed) bake "$@"; report ;;
    crash) kill -SEGV $$ ;;
    hang) while :; do :; done ;;
    left_behind) say "error 3001: $name.ply: x"; bake "$@"; exit 2 ;;
    temporary) bake "$@"; echo > "$3.tmp"; report ;;
    no_number) say "$name.ply: x"; exit 2 ;;
    two_errors) say "error 3001: $name.ply: x"; say "error 3001: $name.ply: y"; exit 2 ;;
    unlisted) say "error 3002: $name.ply: x"; exit 2 ;;
    other_exit) say "error 3001: $name.ply: x"; exit 4 ;;
    unlisted_warning) say "warning 3803: $name.ply: x"; bake "$@"; report 3803 ;;
    silent_warning) bake "$@"; report 3801 ;;
    unnamed) say "error 3001: x"; exit 2 ;;
    chatter) echo "half-edge: complex edge" >&2; bake "$@"; report ;;
    error_and_success) say "error 3001: $name.ply: x"; bake "$@"; report ;;
    broken_file) echo broken > "$3"; report ;;
    no_file) report ;;
esac
END
cat > "$work/programs/lsinfo" << 'END'
#!/usr/bin/env bash
grep -qx baked "$3"
END
chmod +x "$work"/programs/*
printf '| 3001 | a | b |\n| 3801 | a | b |\n| 3802 | a | b |\n' > "$work/errors.md"

sed -nE 's/^    ([a-z_]+)\).*/\1/p' "$work/programs/lsbake" | while read -r name; do
    : > "$work/models/$name.ply"
done
: > "$work/models/notes.txt"
# Files that are as they should be are in the list, and one that is not there.
cat > "$work/outcomes.txt" << 'END'
changed.ply ok 1 13 -
gone.ply ok 1 12 -
good.ply ok 1 12 -
good_error.ply error 3001
good_warnings.ply ok 1 12 3801,3802x2
many_warnings.ply ok 1 12 3801x2
END
# "FILE COMPLAINT" of all that must be seen; the other wrong files are not in the list either.
cat > "$work/expected.txt" << 'END'
broken_file.ply: the baked file fails its check
changed.ply: was: ok 1 13 -; now: ok 1 12 -
chatter.ply: a line that is no message with a number
crash.ply: ends with 139
error_and_success.ply: an error, and exit code 0
gone.ply: is in outcomes.txt, but not in the models
hang.ply: not done after 1 s
left_behind.ply: the error left something behind: scene.lspace
no_file.ply: beside the output:
no_file.ply: the baked file fails its check
no_number.ply: a line that is no message with a number
no_number.ply: not one line with an error's number
other_exit.ply: exit code 4 with error 3001
silent_warning.ply: the report has other warnings than standard error
temporary.ply: beside the output: scene.lspace
two_errors.ply: not one line with an error's number
unlisted.ply: docs/errors.md does not list 3002
unlisted_warning.ply: docs/errors.md does not list 3803
unnamed.ply: a message does not name the file
END

code=0
"$here/run.sh" --models "$work/models" --outcomes "$work/outcomes.txt" --catalogue "$work/errors.md" --seconds 1 \
    "$work/programs" > "$work/output.txt" 2> /dev/null || code=$?
sed -n 's/^WRONG: //p' "$work/output.txt" | grep -v 'is not in outcomes.txt' | sed 's/ *$//' | sort > "$work/seen.txt"
if ! diff "$work/expected.txt" "$work/seen.txt" || ((code != 1)); then
    echo "run.sh ends with $code; what it should have seen (<) and what it has seen (>) differ"
    exit 1
fi
grep -q '^corpus ply    |    20 |    11 |       9 | 3001 x ' "$work/output.txt" ||
    { echo "the table is wrong:"; grep '^corpus' "$work/output.txt"; exit 1; }

# Nothing wrong: what is left when the bad ones are gone.
sed "s/\.ply:.*//" "$work/expected.txt" | sort -u | while read -r name; do
    rm -f "$work/models/$name.ply"
done
sed -i '/^gone\|^changed/d' "$work/outcomes.txt"
"$here/run.sh" --models "$work/models" --outcomes "$work/outcomes.txt" --catalogue "$work/errors.md" --seconds 1 \
    "$work/programs"
