#!/bin/sh
# SLURM: one task a pack, on any node that sees this folder.
#
#   sbatch --array=0-4 slurm.sh
#
# Names of the packs, one a line, in the order of the array's indices:
#SBATCH --job-name=glint-bake
#SBATCH --cpus-per-task=4
#SBATCH --mem=4G
#SBATCH --time=00:30:00
set -eu

names="brushed
paint
plate
procedural
studio"

index=${SLURM_ARRAY_TASK_ID:?run this with sbatch --array=0-4}
name=$(printf '%s\n' "$names" | sed -n "$((index + 1))p")
[ -n "$name" ] || { echo "no pack has the index $index" >&2; exit 2; }

# Tasks share the folder of packs: each writes its own pack and its own record, whole or not at all.
exec "${GLINT_BAKE:-glint-bake}" build glint.toml --only "$name" --threads "${SLURM_CPUS_PER_TASK:-1}" --progress never
