#!/usr/bin/env bash
# Indexes a folder with a Slurm array of N jobs, and merges the parts in a job after them:
#   slurm.sh FOLDER N INDEX [OPTION OF `canonform index build`]...
# The folders must be seen by all nodes. Set partition, account, cores, memory and time in array.sbatch. AT_ONCE bounds how
# many jobs run at a time (default: 64). If jobs fail, run the same command again: complete parts take seconds.
set -euo pipefail
if [ $# -lt 3 ]; then sed -n '2,5s/^# \{0,1\}//p' "$0" >&2; exit 2; fi
here=$(cd "$(dirname "$0")" && pwd)
folder=$1 n=$2 index=$3
shift 3
parts=$index.parts
mkdir -p "$parts"
array=$(sbatch --parsable --array="1-$n%${AT_ONCE:-64}" --output="$parts/%a.log" \
    "$here/array.sbatch" "$here" "$folder" "$n" "$parts" "$@")
merge=$(sbatch --parsable --dependency="afterok:${array%%;*}" --job-name=canonform-merge --output="$parts/merge.log" \
    "$here/merge.sh" "$parts" "$n" "$index")
echo "array ${array%%;*}, then merge ${merge%%;*}"
