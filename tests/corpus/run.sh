#!/usr/bin/env bash
# run.sh - the world's files through the programs: every mesh file of Debian's package assimp-testmodels is baked, and
# what comes of it is compared with the list beside this script, outcomes.txt. README.md here says how to read it.
#
# A file must bake, and the result pass the full check (and give a picture, if asked for), or end with one error of the
# catalogue. A crash, a run beyond the time limit, a number that docs/errors.md lacks, an exit code that is not the
# number's, a line of another kind and anything left at the output's name are failures.
set -uo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
catalogue=$here/../../docs/errors.md
outcomes=$here/outcomes.txt
models=/usr/share/assimp/models

usage()
{
    echo "usage: tests/corpus/run.sh [options] PROGRAMS"
    echo "  PROGRAMS                 folder of lsbake, lsinfo, lsview and contact_sheet"
    echo "  --write                  write outcomes.txt as the programs have it, for a person to read and commit"
    echo "  --pictures all | sample  also render them, or ten of them"
    echo "  --size WxH, --samples N  of the pictures (default 32x18, 1)"
    echo "  --keep FOLDER            leave the baked files, the pictures, a sheet of them (sheet.png) and all messages"
    echo "                           (messages.txt) in FOLDER"
    echo "  --seconds N              limit of a bake's time on the processor (default 10)"
    echo "  --address-space KIB      limit of a bake's memory (default: none)"
    echo "  --models FOLDER, --outcomes FILE, --catalogue FILE   others than the package's, the list here, docs/errors.md"
}

# Of every format; with and without textures, colours, cameras, several meshes, holes.
sample=(
    OBJ/cube_with_vertexcolors.obj OBJ/spider.obj OFF/Wuson.off PLY/cube_uv.ply PLY/float-color.ply STL/Spider_binary.stl
    STL/sphereWithHole.stl glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb
    glTF2/BoxTextured-glTF-Binary/BoxTextured.glb glTF2/cameras/Cameras.gltf
)

write=false
pictures=none
size=32x18
samples=1
keep=""
seconds=10
address_space=unlimited
programs=""
while (($# > 0)); do
    case "$1" in
        --write) write=true ;;
        --help)
            usage
            exit 0
            ;;
        --pictures | --size | --samples | --keep | --seconds | --address-space | --models | --outcomes | \
            --catalogue)
            if (($# < 2)); then
                usage >&2
                exit 1
            fi
            case "$1" in
                --pictures) pictures=$2 ;;
                --size) size=$2 ;;
                --samples) samples=$2 ;;
                --keep) keep=$2 ;;
                --seconds) seconds=$2 ;;
                --address-space) address_space=$2 ;;
                --models) models=$2 ;;
                --outcomes) outcomes=$2 ;;
                --catalogue) catalogue=$2 ;;
            esac
            shift
            ;;
        *)
            if [[ "$1" == -* || -n "$programs" ]]; then
                usage >&2
                exit 1
            fi
            programs=$1
            ;;
    esac
    shift
done
if [[ -z "$programs" || ! "$pictures" =~ ^(none|sample|all)$ ]]; then
    usage >&2
    exit 1
fi
programs=$(cd "$programs" && pwd) || exit 1
if [[ ! -d "$models" ]]; then
    echo "corpus: $models is not there; install the package assimp-testmodels" >&2
    exit 1
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
if [[ -n "$keep" ]]; then
    mkdir -p "$keep" || exit 1
    work=$(cd "$keep" && pwd)
else
    work=$scratch
fi
messages=$work/messages.txt
found=$scratch/found.txt
picture_list=$scratch/pictures.txt
: > "$messages"
: > "$found"
: > "$picture_list"
export LC_ALL=C

wrong=0
complain()
{
    wrong=$((wrong + 1))
    echo "WRONG: $1: $2"
    if [[ -s "${3-}" ]]; then
        head -n 20 "$3" | cut -c 1-400 | sed 's/^/  | /'
    fi
}

is_listed()
{
    grep -q "^| $1 |" "$catalogue"
}

# The exit code that a number stands for, as format/base.c has it.
exit_code_of()
{
    case "$1" in
        1*) echo 1 ;;
        2* | 3*) echo 2 ;;
        4*) echo 3 ;;
        5*) echo 4 ;;
        6*) echo 5 ;;
        *) echo 6 ;;
    esac
}

# count_of REPORT KEY: a whole number of the bake's own report.
count_of()
{
    sed -nE "s/^\t\"$2\":\t([0-9]+),?$/\1/p" "$1" | head -n 1
}

# The numbers of a report's warnings, one a line.
warnings_of()
{
    sed -nE 's/^\t+"number":\t([0-9]{4}),?$/\1/p' "$1" | sort
}

# bake FILE: leaves the outcome in `outcome`, and the output, if there is one, in `baked`.
bake()
{
    local file=$1 folder code numbers number
    folder=$scratch/out
    rm -rf "$folder"
    mkdir "$folder"
    baked=$folder/scene.lspace
    (
        ulimit -v "$address_space"
        # Of the processor's time, since others may have it too; and far more of the clock's, for one that waits.
        ulimit -S -t "$seconds"
        cd "$scratch" && exec timeout --kill-after=5 $((20 * seconds)) "$programs/lsbake" "$models/$file" \
            -o "$baked" --threads 1 --report json > report.json 2> lines.txt < /dev/null
    )
    code=$?
    { echo "$file: exit code $code"; sed 's/^/    /' "$scratch/lines.txt"; } >> "$messages"
    if ((code == 124 || code == 137 || code == 152)); then
        outcome="hang"
        complain "$file" "not done after $seconds s" "$scratch/lines.txt"
        return 1
    elif ((code > 6)); then
        outcome="crash $code"
        complain "$file" "ends with $code" "$scratch/lines.txt"
        return 1
    fi

    # Of very many warnings the last ones are in the report alone.
    if grep -qvE '^lsbake: (error [0-9]{4}: .|warning 38[0-9]{2}: .|and [0-9]+ more warnings )' \
        "$scratch/lines.txt"; then
        complain "$file" "a line that is no message with a number" "$scratch/lines.txt"
    fi
    numbers=$({
        sed -nE 's/^lsbake: (error|warning) ([0-9]{4}): .*/\2/p' "$scratch/lines.txt"
        warnings_of "$scratch/report.json"
    } | sort -u)
    for number in $numbers; do
        is_listed "$number" || complain "$file" "docs/errors.md does not list $number" "$scratch/lines.txt"
    done
    # The name of the scene, or of a library of materials beside it; a buffer beside it has a name of its own.
    if grep -E '^lsbake: (error|warning)' "$scratch/lines.txt" | grep -vE '^[^"]*\.(mtl|MTL): ' |
        grep -qvF "$(basename "$file")"; then
        complain "$file" "a message does not name the file" "$scratch/lines.txt"
    fi

    if ((code != 0)); then
        number=$(sed -nE 's/^lsbake: error ([0-9]{4}): .*/\1/p' "$scratch/lines.txt")
        outcome="error ${number:-without a number}"
        if [[ ! "$number" =~ ^[0-9]{4}$ ]]; then
            complain "$file" "not one line with an error's number" "$scratch/lines.txt"
        elif ((code != $(exit_code_of "$number"))); then
            complain "$file" "exit code $code with error $number" "$scratch/lines.txt"
        fi
        if [[ -n $(ls -A "$folder") ]]; then
            complain "$file" "the error left something behind: $(ls -A "$folder")"
        fi
        if [[ -s "$scratch/report.json" ]]; then
            complain "$file" "a report in spite of an error" "$scratch/report.json"
        fi
        return 1
    fi

    if grep -q '^lsbake: error' "$scratch/lines.txt"; then
        complain "$file" "an error, and exit code 0" "$scratch/lines.txt"
    fi
    local objects triangles warnings
    objects=$(count_of "$scratch/report.json" objects)
    triangles=$(count_of "$scratch/report.json" triangles)
    if [[ "$(sed -nE 's/^lsbake: warning ([0-9]{4}): .*/\1/p' "$scratch/lines.txt" | sort)" != \
        "$(warnings_of "$scratch/report.json")" ]] && ! grep -q ' more warnings ' "$scratch/lines.txt"; then
        complain "$file" "the report has other warnings than standard error" "$scratch/lines.txt"
    fi
    # As 3870 or, when there are several, 3870x5.
    warnings=$(warnings_of "$scratch/report.json" | uniq -c |
        awk '{ print ($1 > 1 ? $2 "x" $1 : $2) }' | paste -sd ,)
    outcome="ok ${objects:-?} ${triangles:-?} ${warnings:--}"
    if [[ -z "$objects" || -z "$triangles" || "$triangles" == 0 ]]; then
        complain "$file" "the report counts no object or no triangle" "$scratch/report.json"
    fi
    if [[ "$(ls -A "$folder")" != scene.lspace ]]; then
        complain "$file" "beside the output: $(ls -A "$folder")"
    fi
    return 0
}

check()
{
    "$programs/lsinfo" check --full "$baked" > "$scratch/check.txt" 2>&1 < /dev/null ||
        complain "$1" "the baked file fails its check" "$scratch/check.txt"
}

is_wanted()
{
    [[ "$pictures" == all || ("$pictures" == sample && " ${sample[*]} " == *" $1 "*) ]]
}

# render FILE PICTURE [OPTION...]
render()
{
    local file=$1 picture=$2
    shift 2
    rm -f "$picture"
    if ! "$programs/lsview" --headless "$baked" -o "$picture" --size "$size" --samples "$samples" --quiet "$@" \
        > "$scratch/view.txt" 2>&1 < /dev/null || [[ ! -s "$picture" || -s "$scratch/view.txt" ]]; then
        complain "$file" "lsview makes no picture, or has something to say" "$scratch/view.txt"
        return 1
    fi
}

# is_flat PICTURE: all pixels are equal.
is_flat()
{
    printf '%s\tpicture\n' "$1" > "$scratch/one.txt"
    [[ "$("$programs/contact_sheet" "$scratch/one.txt" 2>&1)" != *varied ]]
}

# draw FILE: a picture of the baked file, noted in the list of pictures. White things in a white sky without shadows
# are not to be seen; then their outline must be, black where a path ends at the first surface.
draw()
{
    local file=$1 picture=$work/${1//\//-}.png
    render "$file" "$picture" || return
    printf '%s\t%s\n' "$picture" "$file" >> "$picture_list"
    if is_flat "$picture"; then
        outcome+=" white"
        render "$file" "$scratch/outline.png" --depth 1 || return
        if is_flat "$scratch/outline.png"; then
            outcome=${outcome/% white/ empty}
        fi
    fi
}

# ---- Every file ---------------------------------------------------------------------------------

mapfile -t files < <(cd "$models" && find . -type f | sed 's/^\.\///' |
    grep -iE '\.(obj|ply|off|stl|gltf|glb)$' | sort)
if [[ "$pictures" == sample ]] && ! $write; then
    files=("${sample[@]}")
fi
for file in "${files[@]}"; do
    if [[ ! -e "$models/$file" ]]; then
        complain "$file" "is not in $models"
        continue
    fi
    if bake "$file"; then
        check "$file"
        if is_wanted "$file"; then
            draw "$file"
        fi
        if [[ -n "$keep" ]]; then
            cp "$baked" "$work/${file//\//-}.lspace"
        fi
    fi
    echo "$file $outcome" >> "$found"
done

if [[ -n "$keep" && -s "$picture_list" ]]; then
    "$programs/contact_sheet" "$picture_list" "$work/sheet.png" > "$scratch/sheet.txt" 2>&1 ||
        complain "sheet.png" "contact_sheet fails" "$scratch/sheet.txt"
fi

# ---- Against the list -----------------------------------------------------------------------------

sort -o "$found" "$found"
if $write; then
    if [[ "$pictures" != all ]]; then
        echo "note: without --pictures all, no file is marked as one whose picture is white"
    fi
    cp "$found" "$outcomes"
    echo "written: $outcomes; read every line of it before it is committed"
else
    # Only the files looked at, and "white" or "empty" only of those that were rendered.
    while read -r file rest; do
        expected=$(sed -n "s#^$file ##p" "$outcomes")
        if ! grep -qF "$(printf '\t%s' "$file")" "$picture_list"; then
            expected=${expected% white}
            expected=${expected% empty}
        fi
        if [[ -z "$expected" ]]; then
            complain "$file" "is not in outcomes.txt; now: $rest"
        elif [[ "$rest" != "$expected" ]]; then
            complain "$file" "was: $expected; now: $rest"
        fi
    done < "$found"
    if [[ "$pictures" != sample ]]; then
        while read -r file rest; do
            grep -q "^$file " "$found" || complain "$file" "is in outcomes.txt, but not in the models"
        done < "$outcomes"
    fi
fi

# ---- By format ------------------------------------------------------------------------------------

# Refused and warnings as "number x files".
awk '
function ending(path) { sub(/.*\./, "", path); return tolower(path) }
function count(table, format, number) { table[format, number]++ }
{
    format = ending($1)
    files[format]++
    total++
    if ($2 == "ok")
    {
        baked[format]++
        parts = split($5, list, ",")
        for (i = 1; i <= parts; i++)
            if (list[i] != "-")
                count(warned, format, substr(list[i], 1, 4))
    }
    else
        count(refused, format, $3)
}
function text(table, format,    number, order, i, n, result)
{
    n = 0
    for (number = 1000; number < 10000; number++)
        if ((format, number "") in table)
            result = result (result == "" ? "" : ", ") number " x " table[format, number ""]
    return result == "" ? "-" : result
}
END {
    row = "corpus %-6s | %5s | %5s | %7s | %-44s | %s\n"
    printf row, "format", "files", "baked", "refused", "refused by number", "warnings by number"
    split("obj ply off stl gltf glb", formats, " ")
    for (i = 1; i <= 6; i++)
    {
        f = formats[i]
        if (files[f] > 0)
            printf row, f, files[f], baked[f] + 0, files[f] - baked[f], text(refused, f), text(warned, f)
    }
}' "$found"
count=$(wc -l < "$found")
pictures_drawn=$(wc -l < "$picture_list")
echo "corpus: $count files, $pictures_drawn pictures, $wrong wrong"
((count > 0 && wrong == 0))
