#!/usr/bin/env bash
# Measures all, keeps the result and makes the page: bench/run_bench.sh [NAME] [options of Google Benchmark]
#   NAME   of the result, bench/results/NAME.*; default: the processor's model
#   BUILD  folder of a Release build; default: build/release
# With options only the micro-benchmarks run, and the page is left as it is.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/program.sh"
bench=$(program bramah_bench)
workload=$(program bramah_workload)
bramah=$(program bramah)
report=$(program bramah_bench_report)

name=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1 | tr -cs '[:alnum:]\n' '_' | tr '[:upper:]' '[:lower:]' | sed 's/_$//')
if [[ $# -gt 0 && $1 != -* ]]; then
  name=$1
  shift
fi
commit=$(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)
if [[ $commit != unknown && -n $(git -C "$root" status --porcelain -- engine components bench/*.cpp tests/support) ]]; then
  commit+="-modified"
fi

mkdir -p "$root/bench/results"
result=$root/bench/results/$name.json
# Rounds of all works in turn, so that a busy minute of the machine does not fall on one of them.
"$bench" --benchmark_min_time=0.02 --benchmark_repetitions=3 --benchmark_enable_random_interleaving=true \
  --benchmark_report_aggregates_only=true --benchmark_context=commit="$commit" \
  --benchmark_out="$result.new" --benchmark_out_format=json "$@"
# Kept: of every work the median and the variation, and what was skipped; not who measured where and when.
# A variation of zeros is no number.
awk '
  { sub(/: -?(nan|inf)/, ": null"); sub(/: -?NaN/, ": null") }
  /^    \{$/ { entry = $0; inside = 1; next }
  inside && /^    \},?$/ {
    inside = 0
    if (entry ~ /"aggregate_name": "(median|cv)"/ || (entry ~ /"error_occurred"/ && !(entry in seen))) {
      printf "%s%s\n    }", separator, entry
      separator = ",\n"
    }
    seen[entry] = 1
    next
  }
  inside { if ($0 !~ /"(family_index|per_family_instance_index|repetition_index|threads)":/) entry = entry "\n" $0; next }
  /^  \]/ { printf "\n" }
  !/^    "(date|host_name|executable)":/
' "$result.new" > "$result"
rm "$result.new"
echo "kept in $result"
[[ $# -eq 0 ]] || exit 0

lines=$root/bench/results/$name.workloads.jsonl
: > "$lines.new"
# run NAME N [TOLERANCE]: a work that fails or takes too long leaves a line that says so.
run() {
  echo "$*"
  timeout 60 "$workload" "$@" >> "$lines.new" && return
  local status=$?
  [[ $status -ne 124 ]] || echo "{\"workload\": \"$1\", \"N\": $2, \"failure\": \"took longer than 60 s\"}" >> "$lines.new"
}
run rungs_four_bar 1
for N in 1 3 10 30 100; do
  run rungs_planar_chain $N
  run rungs_hydraulic_chain $N
done
for N in 1 3 10 30; do run rungs_spatial_chain $N; done
for N in 300 1000; do run rungs_planar_chain $N; done
for N in 100 300; do run rungs_spatial_chain $N; done
for N in 3 10 30; do
  run rungs_four_bar_ladder $N
  run rungs_cylinder_manifold $N
  run rungs_trailers $N
done
for N in 3 10; do run rungs_spring_lattice $N; done
for N in 10 100 1000 10000 100000; do
  run chain_planar $N
  run costs_planar $N
  run costs_spatial $N
  run load_chain $N
done
for N in 10 100 1000 10000; do
  run chain_spatial $N
  run equilibrium_chain $N
done
for tolerance in 1e-4 1e-5 5e-6 3e-6 2e-6 1e-6 1e-7; do
  run four_bar_ladder 40 $tolerance
  run four_bar_ladder 300 $tolerance
done
for tolerance in 1e-5 1e-6 8e-7 5e-7 2e-7 1e-7; do run four_bar_ladder_ida 40 $tolerance; done
run four_bar_ladder 100 1e-6
for method in explicit implicit ida generalized_alpha; do
  for N in 10 100 1000 10000; do run steps_chain_$method $N; done
  for N in 5 50 500 5000; do run steps_ladder_$method $N; done
done
run real_time_four_bar 1
run real_time_excavator 1
mv "$lines.new" "$lines"
"$bramah" compare "$root/scenes/four_bar/overdamped.json" --json --quiet > "$root/bench/results/$name.compare.json"
"$report" "$name"
echo "kept in $lines; see docs/benchmarks.html"
