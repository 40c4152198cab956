#!/usr/bin/env bash
# bare_root.sh - tries the README's two commands on a machine that has nothing: a Debian 12 root file system made by
# debootstrap, without anything that this machine has installed or set.
#
# Needs root, debootstrap and some 8 GB below the folder. Packages come from the mirrors that this machine's own apt
# uses. What is tried is the last commit; changes that are not committed are left out. All mounts, and whatever the
# commands leave running, end with the script, however it ends: it runs in name spaces of its own.
set -euo pipefail
called_from=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage()
{
    echo "usage: tools/bare_root.sh [--demo-only | --test-only] [--keep] [FOLDER]"
    echo "  --demo-only   run ./demo.sh alone"
    echo "  --test-only   run ./test.sh alone"
    echo "  --keep        leave the root file system behind"
    echo "  FOLDER        where to make it; must not be there yet (default: build/bare_root/root)"
    echo "logs: build/bare_root/*.log"
}

suite=bookworm
logs=$PWD/build/bare_root
root=$logs/root
commands=(demo test)
keep=false
folders=0
arguments=("$@")
for argument in "$@"; do
    case "$argument" in
        --demo-only) commands=(demo) ;;
        --test-only) commands=(test) ;;
        --keep) keep=true ;;
        --help)
            usage
            exit 0
            ;;
        -*)
            usage >&2
            exit 1
            ;;
        *)
            root=$(cd "$called_from" && realpath -m -- "$argument")
            folders=$((folders + 1))
            ;;
    esac
done
if ((folders > 1)); then
    usage >&2
    exit 1
fi

fail()
{
    echo "bare_root: $*" >&2
    exit 1
}

((EUID == 0)) || fail "not root; mounting and chroot need it: sudo tools/bare_root.sh"
for program in debootstrap unshare chroot git apt-get; do
    command -v "$program" > /dev/null || fail "no $program; install it (apt install debootstrap util-linux git)"
done
if [[ -z "${LS_BARE_ROOT-}" ]]; then
    [[ ! -e "$root" ]] || fail "$root is there already; remove it, or name another folder"
    export LS_BARE_ROOT=$root
    exec unshare --mount --pid --fork --kill-child --mount-proc --propagation private \
        "tools/bare_root.sh" "${arguments[@]}"
fi

root=$LS_BARE_ROOT

# Never below a mount, whatever became of it.
remove_root()
{
    if $keep; then
        echo "kept: $root"
    else
        umount "$root/dev/shm" "$root/proc" 2> /dev/null || true
        rm -rf --one-file-system "$root"
    fi
}

# The suites of Debian 12 that this machine installs from, as lines of sources.list.
list_sources()
{
    # The words in $() are apt's.
    # shellcheck disable=SC2016
    apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
        grep -E "^deb [^ ]+ $suite(-updates|-security)? main$" | sort -u
}

# run_command NAME: ./NAME.sh as the README has it, in the root, with an environment that says nothing.
run_command()
{
    local started=$SECONDS code=0
    local clean=(env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
    chroot "$root" "${clean[@]}" bash -c "cd /root/linespace && ./$1.sh" \
        > "$logs/$1.log" 2>&1 < /dev/null || code=$?
    local took=$((SECONDS - started))
    echo "./$1.sh: exit code $code, $((took / 60)) min $((took % 60)) s, log $logs/$1.log"
    tail -n 12 "$logs/$1.log" | sed 's/^/  | /'
    return "$code"
}

mkdir -p "$logs"
trap remove_root EXIT
trap 'exit 130' INT TERM HUP

sources=$(list_sources) || fail "apt's sources name no mirror of Debian 12 ($suite main)"
mirror=$(sed -n "s/^deb \([^ ]*\) $suite main$/\1/p" <<< "$sources" | head -n 1)
[[ -n "$mirror" ]] || fail "apt's sources name no mirror of Debian 12 ($suite main)"

echo "debootstrap: $suite, minbase, in $root"
debootstrap --variant=minbase "$suite" "$root" "$mirror" > "$logs/debootstrap.log" 2>&1 < /dev/null ||
    fail "debootstrap failed; see $logs/debootstrap.log"
echo "$sources" > "$root/etc/apt/sources.list"

[[ -z "$(git status --porcelain)" ]] || echo "note: changes that are not committed are left out"
echo "tree: $(git log -1 --format='%h %s')"
mkdir "$root/root/linespace"
git archive HEAD | tar -x -C "$root/root/linespace"

mount -t proc proc "$root/proc"
mkdir -p "$root/dev/shm"
mount -t tmpfs -o mode=1777 tmpfs "$root/dev/shm"

passed=0
failed=0
for command in "${commands[@]}"; do
    if run_command "$command"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
    fi
done
if [[ -e "$root/root/linespace/out" ]]; then
    rm -rf "$logs/out"
    cp -r "$root/root/linespace/out" "$logs/out"
fi
echo "$passed passed, $failed failed"
((failed == 0))
