#!/usr/bin/env bash
# Indexes a folder in N parts, several at a time, and merges them:
#   parallel.sh FOLDER N INDEX [OPTION OF `canonform index build`]...
# Uses GNU parallel if it is installed, else xargs. JOBS parts run at a time (default: one for every two cores), with
# THREADS threads each (default: 2). With GNU parallel and HOSTS, a list such as node1,node2 of machines that see the same
# folders, parts run there through SSH. Parts stay in INDEX.parts; run the same command again after an interruption.
set -euo pipefail
if [ $# -lt 3 ]; then sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; fi
here=$(cd "$(dirname "$0")" && pwd)
folder=$1 n=$2 index=$3
shift 3
threads=${THREADS:-2}
jobs=${JOBS:-$(( ($(nproc) + threads - 1) / threads ))}
parts=$index.parts
task=("$here/shard.sh" "$folder" "{}/$n" "$parts" --threads "$threads" "$@")
if parallel --version 2>/dev/null | grep -q '^GNU parallel'; then
    # A part that fails, for example because its machine was lost, is tried again.
    hosts=()
    if [ -n "${HOSTS:-}" ]; then hosts=(--sshlogin "$HOSTS" --workdir . --env PATH); fi
    seq "$n" | parallel --quote --jobs "$jobs" --retries 3 "${hosts[@]}" "${task[@]}"
else
    seq "$n" | xargs -P "$jobs" -I '{}' "${task[@]}"
fi
exec "$here/merge.sh" "$parts" "$n" "$index"
