#!/usr/bin/env bash
# kajo beside POV-Ray 3.7 on solids: set operations, tori, an isosurface, a blob, a lathe, a height field.
#
#   scenes/bench/solids.sh [--kajo FILE] [--rounds N] [--work DIR]
#
# Needs povray (Debian: apt-get install povray) and python3. `solids.py` says what the scenes are and writes them for both. One ray a pixel, one
# thread, 640 x 480. The seconds are processor time in user mode of the whole process, reading the scene and writing the picture included; programs
# take turns, and medians are shown. FLIP compares the pictures, which both write without a curve.
# The last lines compare kajo's own: 1,000 leaves of set operations with the same in a group, tori with spheres.
set -euo pipefail

kajo=kajo rounds=5 work=$(mktemp -d)
while [ $# -gt 0 ]; do
  case $1 in
    --kajo) kajo=$2 ;;
    --rounds) rounds=$2 ;;
    --work) work=$2 ;;
    *) sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 2 ;;
  esac
  shift 2
done
kajo=$(command -v "$kajo") || { echo "no kajo; name it with --kajo FILE" >&2; exit 2; }
kajo=$(realpath "$kajo")
command -v povray > /dev/null || { echo "povray is not installed" >&2; exit 2; }
python3 "$(dirname "${BASH_SOURCE[0]}")/solids.py" "$work"
cd "$work"
# POV-Ray refuses to start without its configuration.
export HOME=$PWD
mkdir -p .povray/3.7 && touch .povray/3.7/povray.conf
: > rows

timed() { # scene, program, command...
  local scene=$1 program=$2 TIMEFORMAT='%U'
  shift 2
  { time "$@" > log 2>&1; } 2> time || { tail -n 3 log >&2; exit 1; }
  echo "$scene,$program,$(cat time)" >> rows
}

for _ in $(seq "$rounds"); do # everything once a round, so that what else the machine does hits all alike
  for file in *.txt; do
    scene=${file%.txt}
    timed "$scene" kajo "$kajo" render "$file" -o "$scene-kajo.png" --threads 1
    if [ -f "$scene.pov" ]; then
      timed "$scene" povray povray "+I$scene.pov" "+O$scene-povray.png" +W640 +H480 -D -A +WT1 File_Gamma=1.0
    fi
  done
done

for file in *.pov; do
  scene=${file%.pov}
  echo "$scene,flip,$("$kajo" diff "$scene-povray.png" "$scene-kajo.png" | awk '/FLIP/ { print $2; exit }')" >> rows
done
sort rows | awk -F, '
  function median(list,   a, n, i, j, x) {
    n = split(list, a, " ")
    for (i = 2; i <= n; i++) for (j = i; j > 1 && a[j] + 0 < a[j - 1] + 0; j--) { x = a[j]; a[j] = a[j - 1]; a[j - 1] = x }
    return a[int((n + 2) / 2)]
  }
  { t[$1, $2] = t[$1, $2] " " $3; scenes[$1] }
  END {
    printf "%-12s%10s%10s%10s%10s\n", "scene", "kajo s", "POV-Ray s", "times", "FLIP"
    split("csg tori isosurface blobs lathe height", order, " ")
    for (i = 1; i in order; i++) {
      own = median(t[order[i], "kajo"]); other = median(t[order[i], "povray"])
      printf "%-12s%10.3f%10.3f%10.2f%10.4f\n", order[i], own, other, other / own, median(t[order[i], "flip"])
    }
    printf "1,000 leaves of set operations over a group of them: %.2f\n", median(t["csg", "kajo"]) / median(t["csg-group", "kajo"])
    printf "tori over spheres: %.2f\n", median(t["tori", "kajo"]) / median(t["spheres", "kajo"])
  }'
