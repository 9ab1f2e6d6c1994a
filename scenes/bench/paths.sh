#!/usr/bin/env bash
# kajo's path tracer beside others: time and error on cornell_box.txt.
#
#   scenes/bench/paths.sh [--kajo FILE] [--sampler NAME] [--samples N] [--threads N] [--runs N] [--spectral yes] [--peer COMMAND]...
#
# A peer is a command that renders the same box with the same number of samples and threads, and prints rows of
# comma-separated fields: scene, program, variant, samples, threads, seconds by wall clock, of processor time, two rates,
# mse, and the mean of red, green and blue. The mse is that of one picture, from the differences between pictures that differ in the seed
# only; kajo's too. Peers run between kajo's own runs, so that what else the machine does hits all alike.
#
# "error x s" is the mse times processor seconds: what an error costs, however many samples are taken. The last columns are how many times as
# many samples a second kajo takes, and how many times as cheap its error is.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
kajo=kajo sampler=sobol samples=64 threads=1 runs=4 spectral='' peers=()
while [ $# -gt 0 ]; do
  case $1 in
    --kajo) kajo=$2 ;;
    --sampler) sampler=$2 ;;
    --samples) samples=$2 ;;
    --threads) threads=$2 ;;
    --runs) runs=$2 ;;
    --spectral) spectral=$2 ;;
    --peer) peers+=("$2") ;;
    *) sed -n '2,14s/^# \{0,1\}//p' "$0"; exit 2 ;;
  esac
  shift 2
done
kajo=$(command -v "$kajo") || { echo "no kajo; name it with --kajo FILE" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Renders with a seed; appends "wall,processor" to the times.
own() { # seed, options
  local seed=$1; shift
  local TIMEFORMAT='%R %U %S'
  { time "$kajo" render "$here/cornell_box.txt" -o "$work/$seed.exr" --samples "$sampler" "$samples" \
      --threads "$threads" --seed "$seed" "$@" > "$work/log" 2>&1; } 2> "$work/time" || { cat "$work/log" >&2; exit 1; }
  awk '{ print $1 "," $2 + $3 }' "$work/time" >> "$work/times"
}

options=()
if [ "$spectral" ]; then options+=(--spectral on); fi
: > "$work/times"
: > "$work/rows"
own 0 "${options[@]}"
for peer in "${peers[@]}"; do
  bash -c "$peer" 2> "$work/log" | awk -F, 'NF >= 13' > "$work/printed" || true
  [ -s "$work/printed" ] || { echo "no row from: $peer" >&2; tail -n 3 "$work/log" >&2; continue; }
  cat "$work/printed" >> "$work/rows"
  own 0 "${options[@]}"
done
for seed in $(seq "$((runs - 1))"); do own "$seed" "${options[@]}"; done

mse=$(for seed in $(seq "$((runs - 1))"); do
  "$kajo" diff "$work/$((seed - 1)).exr" "$work/$seed.exr" | awk '$1 == "MSE" { print $2 / 2 }'
done | awk '{ sum += $1 } END { print sum / NR }')
median() { # field
  cut -d, -f "$1" "$work/times" | sort -g | awk '{ a[NR] = $1 } END { print a[int((NR + 1) / 2)] }'
}
{
  echo "own,kajo,$sampler${spectral:+ spectral},$samples,$threads,$(median 1),$(median 2),,,$mse,,,"
  cat "$work/rows"
} | awk -F, '
  BEGIN { printf "%-18s%-30s%9s%9s%13s%12s%12s%9s%9s\n", "program", "variant", "wall s", "proc. s", "M samples/s", "mse", "error x s", "samples", "error" }
  {
    rate = 65536 * $4 / 1e6 * $5 / $7
    cost = $10 * $7
    if ($1 == "own") { own_rate = rate; own_cost = cost }
    printf "%-18s%-30s%9.2f%9.2f%13.3f%12.3g%12.3g%8.2fx%8.2fx\n", $2, $3, $6, $7, rate, $10, cost, own_rate / rate, cost / own_cost
  }'
