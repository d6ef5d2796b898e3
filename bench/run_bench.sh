#!/usr/bin/env bash
# Runs the benchmarks and keeps the result: bench/run_bench.sh [NAME] [options of Google Benchmark]
#   NAME   of the result, bench/results/NAME.json; default: the processor's model
#   BUILD  folder of a Release build; default: build/release
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname "$here")
build=${BUILD:-$root/build/release}
program=$build/bin/bramah_bench
if [[ ! -x $program ]]; then
  echo "no $program: build the target bramah_bench first (cmake --build $build --target bramah_bench)" >&2
  exit 1
fi

name=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1 | tr -cs '[:alnum:]\n' '_' | tr '[:upper:]' '[:lower:]' | sed 's/_$//')
if [[ $# -gt 0 && $1 != -* ]]; then
  name=$1
  shift
fi
commit=$(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)
if [[ $commit != unknown && -n $(git -C "$root" status --porcelain -- engine components bench tests/support) ]]; then
  commit+="-modified"
fi

mkdir -p "$here/results"
result=$here/results/$name.json
# Rounds of all works in turn, so that a busy minute of the machine does not fall on one of them.
"$program" --benchmark_min_time=0.05 --benchmark_repetitions=5 --benchmark_enable_random_interleaving=true \
  --benchmark_report_aggregates_only=true --benchmark_context=commit="$commit" \
  --benchmark_out="$result" --benchmark_out_format=json "$@"
# Kept: of every work the median and the variation, and what was skipped; not who measured where and when.
awk '
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
' "$result" > "$result.kept"
mv "$result.kept" "$result"
echo "kept in $result"
