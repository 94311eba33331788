#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the benchmarks of a commit and of this tree, runs them alternately and prints the changes of the times.
#
#   sh tests/bench/compare.sh COMMIT [PROGRAM [options of the program]]
#   sh tests/bench/compare.sh HEAD~1 camera_bench --benchmark_filter=exact
#
# PROGRAM is trace_bench by default. ROUNDS=5 runs alternate, so that other users of the machine slow both builds. The commit is
# built in build/compare/; BUILD_DIR=... replaces build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
. "$root/cmake/build.sh"

[ $# -ge 1 ] || { echo "usage: sh tests/bench/compare.sh COMMIT [PROGRAM [options]]" >&2; exit 2; }
commit=$(git -C "$root" rev-parse --short --verify "$1^{commit}")
shift
program=${1:-trace_bench}
[ $# -eq 0 ] || shift
rounds=${ROUNDS:-5}
options="-DPETZVAL_BUILD_BENCHMARKS=ON -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=OFF"

need $library_packages libbenchmark-dev git
build $options
new=$BUILD_DIR/tests/bench
old_tree=$BUILD_DIR/compare/$commit
if [ ! -x "$old_tree/build/tests/bench/$program" ]; then
  mkdir -p "$old_tree"
  git -C "$root" archive "$commit" | tar -x -C "$old_tree"
  (root=$old_tree BUILD_DIR=$old_tree/build && build $options)
fi
old=$old_tree/build/tests/bench

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
echo
round=1
while [ "$round" -le "$rounds" ]; do
  echo "== Round $round of $rounds"
  for side in old new; do
    eval "programs=\$$side"
    "$programs/$program" "$@" --benchmark_out="$results/$side$round.json" --benchmark_out_format=json >"$results/log" ||
      { cat "$results/log" >&2; exit 1; }
  done
  round=$((round + 1))
done
"$new/compare_rounds" "$commit" "$results" "$rounds"
