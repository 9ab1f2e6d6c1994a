#!/usr/bin/env bash
# kajo beside other ray tracers: seconds of processor time on the same scenes, in alternating rounds.
#
#   scenes/bench/compare.sh [--kajo FILE] [--rounds N] [--work DIR]
#                           [--embree DIR --meshes DIR [--only MESH,...] [--ray-rounds N]]
#
# Whitted scenes: POV-Ray 3.7 and Tachyon (Debian: apt-get install povray tachyon time). Their scene files are
# made here from the spheres that kajo renders. Tachyon bends no rays, so it renders the sphereflake only.
# What is not installed is left out, with a word.
#
# Ray casting: Embree 4 (PyPI: embreex, whose library exports Embree's C interface). It needs a harness for
# it, a directory that holds `run.sh MESH_DIR WORK_DIR MESH...`, and `meshes`, a directory with files of the
# KMSH format. The harness prints comma-separated rows: mesh, library (embree4...), quality (medium, high,
# or with +robust), figure (primary, primary8, bounce, shadow, build), threads, figure by wall clock, by processor time
# and thread, unit, rays (for build: MB of the tree), and more. `--only` names meshes, separated by commas.
# With `--ray-rounds` both take turns so many times on each mesh, and the best of each figure counts: where two
# processors share a core, other work on one of them slows the other down by a third, by processor time too.
set -euo pipefail

kajo=kajo rounds=5 work=$(mktemp -d) embree='' meshes='' only='' ray_rounds=1
while [ $# -gt 0 ]; do
  case $1 in
    --kajo) kajo=$2 ;;
    --rounds) rounds=$2 ;;
    --work) work=$2 ;;
    --embree) embree=$2 ;;
    --meshes) meshes=$2 ;;
    --only) only=$2 ;;
    --ray-rounds) ray_rounds=$2 ;;
    *) sed -n '2,20s/^# \{0,1\}//p' "$0"; exit 2 ;;
  esac
  shift 2
done
kajo=$(command -v "$kajo") || { echo "no kajo; name it with --kajo FILE" >&2; exit 2; }
kajo=$(realpath "$kajo")
mkdir -p "$work"
rows=$work/rows.csv
: > "$rows"

has() { command -v "$1" > /dev/null || { echo "left out: $1 is not installed" >&2; return 1; }; }

# Appends "scene,program,anti-aliasing,threads,processor seconds of rendering,wall seconds".
row() { echo "$1,$2,$3,$4,$5,$6" >> "$rows"; }

# The time that POV-Ray's own log gives for tracing: "Trace Time: 0 hours ... (1.234 seconds)" and
# "using 2 thread(s) with 2.345 CPU-seconds total".
povray_row() { # scene, label, threads, options
  local scene=$1 aa=$2 threads=$3; shift 3
  povray "+I$work/$scene.pov" "+O$work/$scene-povray.png" +W1024 +H768 -D "+WT$threads" "$@" > "$work/log" 2>&1 ||
    { tail -n 3 "$work/log" >&2; return 1; }
  local wall cpu
  wall=$(sed -n '/^ *Trace Time/{s/.*(\([0-9.]*\) sec.*/\1/p;q}' "$work/log")
  cpu=$(sed -n '/^ *Trace Time/,$s/.*with \([0-9.]*\) CPU-seconds.*/\1/p' "$work/log" | head -n 1)
  row "$scene" povray "$aa" "$threads" "$cpu" "$wall"
}

# Tachyon's log gives wall time only; its processor time is that of the process, reading the scene included.
tachyon_row() { # threads
  /usr/bin/time -f 'PROCESS %U %S' tachyon "$work/flake.dat" -o "$work/flake-tachyon.tga" -format TARGA \
    -numthreads "$1" -fullshade > "$work/log" 2>&1 || { tail -n 3 "$work/log" >&2; return 1; }
  local wall cpu
  wall=$(sed -n 's/.*Ray Tracing Time: *\([0-9.]*\).*/\1/p' "$work/log")
  cpu=$(awk '/^PROCESS/ {print $2 + $3}' "$work/log")
  row flake tachyon none "$1" "$cpu" "$wall"
}

kajo_row() { # scene, anti-aliasing, threads
  "$kajo" bench whitted --scene "$1" --aa "$2" --threads "$3" --passes 1 --json > "$work/log"
  local line
  line=$(sed 's/.*"renders"://' "$work/log")
  row "$1" kajo "$2" "$3" "$(sed 's/.*"cpu_s":{"median":\([0-9.e-]*\).*/\1/' <<< "$line")" \
    "$(sed 's/.*"wall_s":{"median":\([0-9.e-]*\).*/\1/' <<< "$line")"
}

"$kajo" bench whitted --peers "$work" > /dev/null
pov=$(has povray && echo yes || true)
tachyon=$(has tachyon && [ -x /usr/bin/time ] && echo yes || true)
# POV-Ray refuses to start without its configuration.
export HOME=$work
mkdir -p "$work/.povray/3.7" && touch "$work/.povray/3.7/povray.conf"

for _ in $(seq "$rounds"); do # everything once a round, so that what else the machine does hits all alike
  for threads in 1 2; do
    for scene in flake marbles; do
      kajo_row "$scene" none "$threads"
      kajo_row "$scene" 2x2 "$threads"
      if [ "$pov" ]; then
        povray_row "$scene" none "$threads" -A
        povray_row "$scene" 2x2 "$threads" +A0.0 +AM1 +R2
      fi
    done
    if [ "$tachyon" ]; then tachyon_row "$threads"; fi
  done
done

# Medians, and how many times as long as kajo the others took by processor time.
sort "$rows" | awk -F, '
  function median(list,   a, n, i, j, x) {
    n = split(list, a, " ")
    for (i = 2; i <= n; i++) for (j = i; j > 1 && a[j] + 0 < a[j - 1] + 0; j--) { x = a[j]; a[j] = a[j - 1]; a[j - 1] = x }
    return a[int((n + 2) / 2)]
  }
  { key = $1 "," $2 "," $3 "," $4; cpu[key] = cpu[key] " " $5; wall[key] = wall[key] " " $6; if (!(key in seen)) { seen[key] = 1; order[++n] = key } }
  END {
    printf "%-9s%-9s%-6s%8s%12s%10s%12s\n", "scene", "program", "aa", "threads", "processor s", "wall s", "times kajo"
    for (i = 1; i <= n; i++) {
      split(order[i], k, ",")
      own = median(cpu[k[1] ",kajo," k[3] "," k[4]])
      printf "%-9s%-9s%-6s%8d%12.3f%10.3f%12.2f\n", k[1], k[2], k[3], k[4], median(cpu[order[i]]), median(wall[order[i]]), median(cpu[order[i]]) / own
    }
  }'

# One value of a JSON line.
value() { # name, line
  sed "s/.*\"$1\":\([0-9.e+-]*\).*/\1/" <<< "$2"
}

# Rows as the harness prints them, of one thread; for a medium build also of two, by wall clock.
kajo_rates() { # mesh file, quality
  local line cpu name two
  line=$("$kajo" bench rays "$1" --threads 1 --quality "$2" --json)
  cpu=${line##*\"mrays_cpu\":} cpu=${cpu%%\}*}
  name=$(basename "$1" .kmsh)
  for figure in primary bounce shadow primary_packet; do
    echo "$name,kajo,$2,${figure/primary_packet/primary8},1,,$(value "$figure" "$cpu"),Mray/s,"
  done
  echo "$name,kajo,$2,build,1,,$(value build_cpu_s "$line"),s,$(awk "BEGIN { print $(value bytes "$line") / 1e6 }")"
  if [ "$2" = medium ]; then
    two=$("$kajo" bench rays "$1" --threads 2 --passes 1 --quality "$2" --json)
    echo "$name,kajo,$2,build,2,$(value build_wall_s "$two"),,s,"
  fi
}

if [ -n "$embree" ] && [ -n "$meshes" ]; then
  rates=$work/rates.csv
  : > "$rates"
  for mesh in "$meshes"/*.kmsh; do
    name=$(basename "$mesh" .kmsh)
    if [ -z "$only" ] || [[ ",$only," == *",$name,"* ]]; then
      for _ in $(seq "$ray_rounds"); do
        "$embree/run.sh" "$meshes" "$work/embree" "$name" >> "$rates"
        kajo_rates "$mesh" medium >> "$rates"
        kajo_rates "$mesh" high >> "$rates"
      done
    fi
  done
  echo
  echo "kajo's rays a second over Embree's (kajo is always watertight; so is medium+robust), and its build time and bytes"
  echo "over Embree's, one thread, by processor time; build2: build time on two threads by wall clock:"
  awk -F, '
    # The better of two figures, one of which may not be known yet: the larger rate, the shorter time.
    function better(old, new, figure) {
      if (old == "") return new
      return (figure ~ /build/) == (new + 0 < old + 0) ? new : old
    }
    $2 != "kajo" && $2 !~ /^embree4/ { next }
    $4 == "build" && $5 == 2 { figure = "build2"; value = $6 }
    $5 == 1 { figure = $4; value = $7 }
    $5 != 1 && figure != "build2" { next }
    $2 == "kajo" { own[$1, $3, figure] = better(own[$1, $3, figure], value, figure) }
    $2 == "kajo" && figure == "build" { own[$1, $3, "MB"] = $9 }
    $2 != "kajo" { other[$1, $3, figure] = better(other[$1, $3, figure], value, figure) }
    $2 != "kajo" && figure == "build" { other[$1, $3, "MB"] = $9 }
    $2 != "kajo" && !($1 in seen) { seen[$1]; names[++n] = $1 }
    { figure = "" }
    END {
      columns = split("primary bounce shadow primary8 build build2 MB", figures, " ")
      kinds = split("medium medium+robust high", qualities, " ")
      for (q = 1; q <= kinds; q++) {
        quality = qualities[q]; base = quality; sub(/[+]robust/, "", base)
        printf "%-14s", quality
        for (f = 1; f <= columns; f++) printf "%10s", figures[f]
        print ""
        split("", sum); split("", count)
        for (i = 1; i <= n; i++) {
          printf "%-14s", names[i]
          for (f = 1; f <= columns; f++) {
            a = own[names[i], base, figures[f]]; b = other[names[i], quality, figures[f]]
            if (a > 0 && b > 0) { printf "%10.2f", a / b; sum[f] += log(a / b); count[f]++ } else printf "%10s", "-"
          }
          print ""
        }
        printf "%-14s", "geometric mean"
        for (f = 1; f <= columns; f++) if (count[f]) printf "%10.2f", exp(sum[f] / count[f]); else printf "%10s", "-"
        print "\n"
      }
    }' "$rates"
else
  echo "Embree left out: give --embree DIR and --meshes DIR" >&2
fi
