#!/usr/bin/env bash
# Merges the parts that shard.sh has written:
#   merge.sh PARTS N INDEX
# Refuses to merge if one of the N parts is missing or unfinished.
set -euo pipefail
if [ $# -ne 3 ]; then sed -n '2,4s/^# \{0,1\}//p' "$0" >&2; exit 2; fi
parts=$1 n=$2 index=$3
files=()
for i in $(seq "$n"); do
    if [ ! -s "$parts/$i.json" ]; then
        echo "part $i of $n is not complete: run shard.sh FOLDER $i/$n $parts again" >&2
        exit 2
    fi
    files+=("$parts/$i.canonform")
done
canonform index merge "${files[@]}" -o "$index"
incomplete=$(grep -L '"failed":\[\]' "$parts"/*.json || true)
if [ -n "$incomplete" ]; then
    echo "shapes that could not be described are listed as \"failed\" in" $incomplete >&2
fi
