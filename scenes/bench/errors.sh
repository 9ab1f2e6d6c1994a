#!/usr/bin/env bash
# The squared error of path tracing, or of another integrator, by what a scene is lit by: the scenes in errors/ and cornell_box.txt.
#
#   scenes/bench/errors.sh [--kajo FILE] [--before FILE] [--integrator NAME] [--samples N] [--size N] [--runs N] [SCENE[:INTEGRATOR[,KEY=VALUE]...]]...
#
# A scene with a colon behind it is rendered by that integrator, such as bulb:path,caustics=scattering. Without scenes all are, each by what
# finds its light. The error is that of one picture, from the differences between pictures that differ in the seed only. With --before another build of
# kajo renders the same, and the last column is how many times as large the error is now.
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
    -*) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 2 ;;
    *) scenes+=("$1"); shift; continue ;;
  esac
  shift 2
done
# Scenes whose light paths from the camera meet by chance, so that few bright samples decide their error, and what finds it.
found_by=(
  caustic:bidirectional
  caustic_in_mirror:vcm
  ceiling:bidirectional
  clear_bulb:path,caustics=manifold
  dispersion:vcm,spectral=on
  rough_bulb:sppm
)
if [ ${#scenes[@]} -eq 0 ]; then
  for scene in "$here"/errors/*.txt "$here/cornell_box.txt"; do
    listed=()
    name=$(basename "$scene" .txt)
    for way in "${found_by[@]}"; do
      [ "${way%%:*}" != "$name" ] || listed+=("$scene${way#"$name"}")
    done
    scenes+=("${listed[@]:-$scene}")
  done
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

error() { # program, scene, integrator with its settings
  local way settings=()
  IFS=, read -r -a way <<< "$3"
  for setting in "${way[@]:1}"; do settings+=("--${setting%%=*}" "${setting#*=}"); done
  for seed in $(seq "$runs"); do
    "$1" render "$2" -o "$work/$seed.exr" --integrator "${way[0]}" "${settings[@]}" --size "$size" "$size" --samples sobol "$samples" \
      --threads 1 --seed "$seed" > "$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  done
  for seed in $(seq 2 "$runs"); do
    "$1" diff "$work/$((seed - 1)).exr" "$work/$seed.exr" | awk '$1 == "MSE" { print $2 / 2 }'
  done | awk '{ sum += $1 } END { print sum / NR }'
}

for scene in "${scenes[@]}"; do
  file=${scene%%:*} way=$integrator
  name=$(basename "$file" .txt)
  if [ "$file" != "$scene" ]; then way=${scene#*:} name=$name:$way; fi
  [ -f "$file" ] || file=$here/errors/$file.txt
  mse=$(error "$kajo" "$file" "$way")
  if [ "$before" ]; then
    error "$before" "$file" "$way" | awk -v name="$name" -v mse="$mse" '{ printf "%-36s %10.3e %10.3e %8.3f\n", name, $1, mse, mse / $1 }'
  else
    printf '%-36s %10.3e\n' "$name" "$mse"
  fi
done
