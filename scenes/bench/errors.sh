#!/usr/bin/env bash
# The squared error of path tracing by what a scene is lit by: the scenes in errors/ and cornell_box.txt.
#
#   scenes/bench/errors.sh [--kajo FILE] [--before FILE] [--integrator NAME] [--samples N] [--size N] [--runs N] [SCENE]...
#
# The error is that of one picture, from the differences between pictures that differ in the seed only. With --before another build of kajo
# renders the same, and the last column is how many times as large the error is now.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
kajo=kajo before='' integrator=path samples=64 size=64 runs=8 scenes=()
while [ $# -gt 0 ]; do
  case $1 in
    --kajo) kajo=$2 ;;
    --before) before=$2 ;;
    --integrator) integrator=$2 ;;
    --samples) samples=$2 ;;
    --size) size=$2 ;;
    --runs) runs=$2 ;;
    -*) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 2 ;;
    *) scenes+=("$1"); shift; continue ;;
  esac
  shift 2
done
[ ${#scenes[@]} -gt 0 ] || scenes=("$here"/errors/*.txt "$here/cornell_box.txt")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

error() { # program, scene
  for seed in $(seq "$runs"); do
    "$1" render "$2" -o "$work/$seed.exr" --integrator "$integrator" --size "$size" "$size" --samples sobol "$samples" \
      --threads 1 --seed "$seed" > "$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  done
  for seed in $(seq 2 "$runs"); do
    "$1" diff "$work/$((seed - 1)).exr" "$work/$seed.exr" | awk '$1 == "MSE" { print $2 / 2 }'
  done | awk '{ sum += $1 } END { print sum / NR }'
}

for scene in "${scenes[@]}"; do
  mse=$(error "$kajo" "$scene")
  if [ "$before" ]; then
    error "$before" "$scene" | awk -v name="$(basename "$scene" .txt)" -v mse="$mse" \
      '{ printf "%-20s %10.3e %10.3e %8.3f\n", name, $1, mse, mse / $1 }'
  else
    printf '%-20s %10.3e\n' "$(basename "$scene" .txt)" "$mse"
  fi
done
