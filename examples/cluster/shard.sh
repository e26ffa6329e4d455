#!/usr/bin/env bash
# Describes one part of a folder:
#   shard.sh FOLDER I/N PARTS [OPTION OF `canonform index build`]...
# Writes PARTS/I.canonform, and the report of the build to PARTS/I.json. A shape that cannot be described is in the report
# and does not stop the others. Run the same command again after an interruption: it continues.
set -euo pipefail
if [ $# -lt 3 ]; then sed -n '2,5s/^# \{0,1\}//p' "$0" >&2; exit 2; fi
folder=$1 shard=$2 parts=$3
shift 3
name=${shard%/*}
mkdir -p "$parts"
rm -f "$parts/$name.json"
report=$(mktemp "$parts/.$name.XXXXXX")
trap 'rm -f "$report"' EXIT
# Exit code 1 or 2 with a report: the part is complete, but some shapes lost surface or could not be described.
code=0
canonform index build "$folder" --shard "$shard" -o "$parts/$name.canonform" --json --quiet "$@" > "$report" || code=$?
if [ ! -s "$report" ]; then exit "$code"; fi
mv "$report" "$parts/$name.json"
