#!/usr/bin/env bash
# test_messages.sh ROOT - the catalogue of messages is whole: every number of format/include/ls_messages.h is raised
# somewhere, described in docs/errors.md and provoked by a test, and nothing is raised without a number. All lacks are
# printed in one run. Tries itself first on a small tree with one lack of every kind.
set -euo pipefail
export LC_ALL=C

if (($# != 1)); then
    echo "usage: test_messages.sh ROOT" >&2
    exit 1
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# What heads a list's rows in docs/errors.md, and the last two digits of its numbers if it has a block in each hundred.
section_of()
{
    case "$1" in
        USAGE) echo "Usage" ;;
        FILES) echo "Files" ;;
        PLY) echo "PLY 01 19" ;;
        OBJ) echo "OBJ 20 39" ;;
        OFF) echo "OFF 40 54" ;;
        STL) echo "STL 55 69" ;;
        GLTF) echo "glTF 70 89" ;;
        SCENE | INPUT) echo "The 90 99" ;;
        OUTPUT) echo "Outputs" ;;
        LSPACE) echo ".lspace" ;;
        DEVICE) echo "Devices" ;;
        MEMORY) echo "Memory" ;;
        *) echo "?" ;;
    esac
}

# Sources below folders, each as one line: path, tab, text without comments of lines. A number that a table or a macro
# passes on is found as well as one that is raised directly.
join_sources()
{
    local file
    find "$@" -type f \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) ! -name ls_messages.h ! -name ls_base.h |
        sort | while read -r file; do
            printf '%s\t' "$file"
            sed 's#//.*##' "$file" | tr '\n\t' '  '
            echo
        done
}

# matches PATTERN: of the joined sources, "path match" a line.
matches()
{
    local path text
    while IFS=$'\t' read -r path text; do
        grep -oE "$1" <<< "$text" | sed "s#^#$path #" || true
    done < "$scratch/sources.txt"
}

# find_lacks ROOT: prints every lack.
find_lacks()
{
    cd "$1"
    local header=format/include/ls_messages.h
    join_sources bake format runtime > "$scratch/sources.txt"

    # "LIST NAME NUMBER" a line.
    awk '/^#define LS_MESSAGES_/ { list = $2; sub(/^LS_MESSAGES_/, "", list); sub(/\(.*/, "", list) }
        list != "" {
            rest = $0
            while (match(rest, /X\([A-Z0-9_]+, *[0-9]+\)/)) {
                entry = substr(rest, RSTART + 2, RLENGTH - 3)
                sub(/, */, " ", entry)
                print list, entry
                rest = substr(rest, RSTART + RLENGTH)
            }
        }
        !/\\$/ { list = "" }' "$header" > "$scratch/entries.txt"
    # "NUMBER SECTION" for each row, the section by the first word of its heading.
    awk '/^## / { section = $2; sub(/:$/, "", section) }
        /^\| *[0-9]+ *\|/ { gsub(/\|/, " "); print $1, section }' docs/errors.md > "$scratch/rows.txt"
    # Texts of tests in which a number counts: scripts, and what the world's files end with.
    find tests -maxdepth 1 -name '*.sh' ! -name test_messages.sh -exec cat {} + > "$scratch/all_scripts.txt"
    cat "$scratch/all_scripts.txt" tests/corpus/outcomes.txt 2> /dev/null | grep -v '^ *#' > "$scratch/scripts.txt" || true
    find tests -type f \( -name '*.c' -o -name '*.cpp' -o -name '*.h' \) -exec cat {} + |
        grep -oE 'LS_MESSAGE_[A-Z0-9_]+' | sort -u > "$scratch/tested.txt" || true
    grep -oE 'LS_MESSAGE_[A-Z0-9_]+' "$scratch/sources.txt" | sort -u > "$scratch/raised.txt" || true

    awk '{ print $3 }' "$scratch/entries.txt" | sort | uniq -d | sed 's/$/: two messages have this number/'

    local list name number section first last block
    while read -r list name number; do
        if [[ ! "$number" =~ ^[1-9][0-9]{3}$ ]] ||
            ! grep -qE "X\([A-Z_]+, ${number%??}, " format/include/ls_base.h; then
            echo "$number $name: number / 100 is no LsResult"
        fi
        read -r section first last <<< "$(section_of "$list")"
        block=$((10#${number: -2}))
        if [[ "$section" == "?" ]]; then
            echo "$number $name: in a list that this test does not know, $list"
        elif [[ -n "$first" && "$number" == 3* ]] && ((block < 10#$first || block > 10#$last)); then
            echo "$number $name: not in the block of $list, 3x$first to 3x$last"
        fi
        grep -qx "LS_MESSAGE_$name" "$scratch/raised.txt" ||
            echo "$number $name: is raised nowhere in bake, format, runtime"
        case $(grep -c "^$number " "$scratch/rows.txt") in
            0) echo "$number $name: docs/errors.md has no row" ;;
            1)
                grep -qxF -- "$number $section" "$scratch/rows.txt" ||
                    echo "$number $name: its row is not in the section \"$section\" of docs/errors.md"
                grep -qE "^\| $number \| [^|]*[^| ] \| [^|]*[^| ] \|$" docs/errors.md ||
                    echo "$number $name: its row in docs/errors.md has not three cells"
                ;;
            *) echo "$number $name: docs/errors.md has several rows" ;;
        esac
        grep -qx "LS_MESSAGE_$name" "$scratch/tested.txt" ||
            grep -qE "(^|[^0-9])$number([^0-9]|\$)" "$scratch/scripts.txt" ||
            echo "$number $name: no test names it"
    done < "$scratch/entries.txt"

    while read -r number section; do
        grep -q " $number\$" "$scratch/entries.txt" || echo "$number: docs/errors.md has a row, but there is no message"
    done < "$scratch/rows.txt"

    # Errors are not raised as warnings, nor warnings as errors.
    local path match
    while read -r path match; do
        name=${match##*LS_MESSAGE_}
        number=$(awk -v name="$name" '$2 == name { print $3 }' "$scratch/entries.txt")
        if [[ "$match" == ls_input_warn* && "$number" != 38* ]]; then
            echo "$path: LS_MESSAGE_$name is a warning's message, but not one of the 38xx"
        elif [[ "$match" != ls_input_warn* && "$number" == 38* ]]; then
            echo "$path: LS_MESSAGE_$name is one of the 38xx, but is raised as an error"
        fi
    done < <(matches '(ls_error_set *\([^,;]*,|Failure *[{(]|ls_input_warn *\([^,;]*,[^,;]*,) *LS_MESSAGE_[A-Z0-9_]+')

    # Results are compared and returned, never raised: a raise takes a message.
    matches '[(,{?:] *LS_ERROR_[A-Z0-9_]+' | sort -u | while read -r path match; do
        echo "$path: LS_ERROR_${match##*LS_ERROR_} is passed on where a message's number belongs"
    done
}

# ---- A tree with one lack of every kind, and things that look like lacks ------------------------------

test_planted_lacks()
{
    local root=$scratch/planted
    mkdir -p "$root"/{format/include,bake,runtime,docs,tests/corpus}
    cat > "$root/format/include/ls_base.h" << 'END'
X(OK, 0, "no error")
X(ERROR_FILE_MISSING, 20, "not there")
X(ERROR_INPUT_FORMAT, 30, "malformed")
X(ERROR_INPUT_WARNING, 38, "a warning")
END
    cat > "$root/format/include/ls_messages.h" << 'END'
#define LS_MESSAGES_FILES(X) X(GOOD, 2001) X(TWICE, 2002) X(TWICE_TOO, 2002)
#define LS_MESSAGES_PLY(X)  \
    X(NO_RESULT, 9901)      \
    X(OTHER_BLOCK, 3021)    \
    X(NOT_RAISED, 3001)     \
    X(NO_ROW, 3002)         \
    X(TWO_ROWS, 3003)       \
    X(OTHER_SECTION, 3004)  \
    X(NOT_TESTED, 3005)     \
    X(BY_SCRIPT, 3006)      \
    X(BY_CORPUS, 3007)      \
    X(SHORT_ROW, 3008)      \
    X(AS_ERROR, 3801)       \
    X(WARNING, 3802)        \
    X(AS_WARNING, 3009)
#define LS_MESSAGES_SOME(X) X(STRANGE, 3090)
END
    cat > "$root/docs/errors.md" << 'END'
## Files: 2xxx
| 2001 | a | b |
| 2002 | a | b |
| 3004 | a | b |
## PLY: 3x01 to 3x19
| 9901 | a | b |
| 3021 | a | b |
| 3001 | a | b |
| 3003 | a | b |
| 3003 | a | b |
| 3005 | a | b |
| 3006 | a | b |
| 3007 | a | b |
| 3008 | a |
| 3801 | a | b |
| 3802 | a | b |
| 3009 | a | b |
| 3010 | a | b |
## The scene as a whole
| 3090 | a | b |
END
    cat > "$root/bake/good.c" << 'END'
// LS_MESSAGE_NOT_RAISED is only spoken of; so is ls_error_set(error, LS_ERROR_INPUT_FORMAT)
int a = LS_MESSAGE_NO_RESULT + LS_MESSAGE_OTHER_BLOCK + LS_MESSAGE_NO_ROW + LS_MESSAGE_TWO_ROWS;
int b = LS_MESSAGE_OTHER_SECTION + LS_MESSAGE_NOT_TESTED + LS_MESSAGE_BY_SCRIPT + LS_MESSAGE_BY_CORPUS;
int c = LS_MESSAGE_SHORT_ROW + LS_MESSAGE_STRANGE;
int d = result == LS_ERROR_INPUT_FORMAT || LS_ERROR_FILE_MISSING != result;
    ls_error_set(error, LS_MESSAGE_GOOD, "text");
    ls_input_warn(input, error, LS_MESSAGE_WARNING, "text");
    return LS_ERROR_INPUT_FORMAT;
END
    cat > "$root/bake/wrong.cpp" << 'END'
    ls_error_set(error, LS_MESSAGE_AS_ERROR, "text");
    ls_input_warn(input, error,
                  LS_MESSAGE_AS_WARNING, "text");
    throw Failure{LS_ERROR_FILE_MISSING, "text"};
END
    cat > "$root/runtime/wrong_too.c" << 'END'
    ls_error_set(error, LS_MESSAGE_TWICE, LS_MESSAGE_TWICE_TOO);
    return ls_error_set(error,
                        is_here ? LS_ERROR_INPUT_FORMAT : LS_MESSAGE_GOOD, "text");
END
    {
        printf 'LS_MESSAGE_%s;\n' GOOD TWICE TWICE_TOO NO_RESULT OTHER_BLOCK NOT_RAISED NO_ROW TWO_ROWS \
            OTHER_SECTION SHORT_ROW AS_ERROR WARNING AS_WARNING STRANGE
    } > "$root/tests/test_some.c"
    printf '# 3005\ncheck 2 3006 lsbake 30050\n' > "$root/tests/test_bad_input.sh"
    printf 'a.ply ok 1 12 3007x2\n' > "$root/tests/corpus/outcomes.txt"
    cat > "$scratch/expected.txt" << 'END'
2002: two messages have this number
9901 NO_RESULT: number / 100 is no LsResult
3021 OTHER_BLOCK: not in the block of PLY, 3x01 to 3x19
3001 NOT_RAISED: is raised nowhere in bake, format, runtime
3002 NO_ROW: docs/errors.md has no row
3003 TWO_ROWS: docs/errors.md has several rows
3004 OTHER_SECTION: its row is not in the section "PLY" of docs/errors.md
3005 NOT_TESTED: no test names it
3008 SHORT_ROW: its row in docs/errors.md has not three cells
3090 STRANGE: in a list that this test does not know, SOME
3090 STRANGE: its row is not in the section "?" of docs/errors.md
3010: docs/errors.md has a row, but there is no message
bake/wrong.cpp: LS_MESSAGE_AS_ERROR is one of the 38xx, but is raised as an error
bake/wrong.cpp: LS_MESSAGE_AS_WARNING is a warning's message, but not one of the 38xx
bake/wrong.cpp: LS_ERROR_FILE_MISSING is passed on where a message's number belongs
runtime/wrong_too.c: LS_ERROR_INPUT_FORMAT is passed on where a message's number belongs
END
    (find_lacks "$root") > "$scratch/lacks.txt"
    if ! diff "$scratch/expected.txt" "$scratch/lacks.txt"; then
        echo "the planted lacks (<) were not found as expected (>)"
        exit 1
    fi
}

test_planted_lacks
root=$(cd "$1" && pwd)
(find_lacks "$root") > "$scratch/lacks.txt"
count=$(wc -l < "$scratch/entries.txt")
cat "$scratch/lacks.txt"
echo "$count messages, $(wc -l < "$scratch/lacks.txt") lacks"
((count >= 10)) && [[ ! -s "$scratch/lacks.txt" ]]
