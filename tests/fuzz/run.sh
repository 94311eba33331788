#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Fuzzes petzval with libFuzzer under ASan and UBSan and prints a table of the runs. Installs missing packages on Debian 12.
#
#   sh tests/fuzz/run.sh --runs N [--targets zemax,trace] [--jobs J]
#
# Runs N inputs for each target, J targets at once (by default 1). The limits for an input are 512 MB and 10 s; sanitizers make
# the code ten or more times as slow. The exit status is 1 if an input crashes, violates a rule or exceeds a limit. Such inputs are
# kept in BUILD_DIR/found/TARGET, and BUILD_DIR/tests/fuzz/fuzz_replay TARGET FILE runs one of them again. Inputs that reach new
# code are kept in BUILD_DIR/corpus/TARGET for the next run.
#
# BUILD_DIR=... replaces build/fuzz/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
BUILD_DIR=${BUILD_DIR:-$root/build/fuzz}
. "$root/cmake/build.sh"

runs= targets= jobs=1
while [ $# -gt 1 ]; do
  case $1 in
    --runs) runs=$2 ;;
    --targets) targets=$2 ;;
    --jobs) jobs=$2 ;;
    *) break ;;
  esac
  shift 2
done
if [ $# -gt 0 ] || [ -z "$runs" ]; then
  echo "usage: sh tests/fuzz/run.sh --runs N [--targets A,B] [--jobs J]" >&2
  exit 2
fi

for number in "$runs" "$jobs"; do
  case $number in
    *[!0-9]* | 0*) echo "tests/fuzz/run.sh: --runs or --jobs = $number; must be a whole number of 1 or more" >&2; exit 2 ;;
  esac
done

need $library_packages libcli11-dev libtinyobjloader-dev clang-14 libclang-rt-14-dev
target=fuzz build -DCMAKE_CXX_COMPILER=clang++-14 -DBUILD_SHARED_LIBS=OFF -DPETZVAL_BUILD_FUZZERS=ON \
  -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=OFF
programs=$BUILD_DIR/tests/fuzz
"$programs/fuzz_replay" --write-seeds "$BUILD_DIR/seeds"

# Freed memory that ASan holds must not count as memory of the library.
export ASAN_OPTIONS=quarantine_size_mb=8
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
trap 'exit 130' INT TERM

# fuzz NAME PROGRAM LARGEST: runs a target; its log is in $logs.
fuzz() {
  mkdir -p "$BUILD_DIR/corpus/$1" "$BUILD_DIR/found/$1"
  status=0
  "$programs/fuzz_$2" "$BUILD_DIR/corpus/$1" "$BUILD_DIR/seeds/$1" -runs="$runs" -max_len="$3" -rss_limit_mb=512 \
    -timeout=10 -entropic_scale_per_exec_time=1 -artifact_prefix="$BUILD_DIR/found/$1/" -print_final_stats=1 \
    >"$logs/$1" 2>&1 || status=$?
  echo "$status" >"$logs/$1.status"
}

# Shows the number of inputs of the running targets if standard error is a terminal.
progress() {
  [ -t 2 ] || return 0
  line=
  for log in "$logs"/*; do
    case $log in *.status | "$logs/*") continue ;; esac
    [ -e "$log.status" ] || line="$line ${log##*/} $(grep -o '^#[0-9]*' "$log" | tail -n 1)"
  done
  printf '\r\033[K%.110s' "$line" >&2
}

# stat NAME LOG: a number from the final statistics of libFuzzer.
stat() { sed -n "s/^stat::$1: *//p" "$2" | tail -n 1; }

"$programs/fuzz_replay" --list >"$logs/list"
if [ -n "$targets" ]; then
  : >"$logs/wanted"
  for name in $(echo "$targets" | tr , ' '); do
    grep "^$name " "$logs/list" >>"$logs/wanted" || { echo "tests/fuzz/run.sh: --targets = $name; must be among:" $(cut -d ' ' -f 1 "$logs/list") >&2; exit 2; }
  done
  mv "$logs/wanted" "$logs/list"
fi
mv "$logs/list" "$logs.list"
trap 'rm -rf "$logs" "$logs.list"' EXIT

echo "== Fuzzing at $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo "an unknown commit"), $(date -u +%F)"
running() { started=0; for log in "$logs"/*; do case $log in *.status | "$logs/*") ;; *) [ -e "$log.status" ] || started=$((started + 1)) ;; esac; done; echo "$started"; }
while read -r name program largest; do
  while [ "$(running)" -ge "$jobs" ]; do sleep 1; progress; done
  : >"$logs/$name"
  fuzz "$name" "$program" "$largest" &
done <"$logs.list"
while [ "$(running)" -gt 0 ]; do sleep 1; progress; done
wait
[ ! -t 2 ] || printf '\r\033[K' >&2

failed=0
echo "| target | executions | a second | edges | features | slowest, ms | memory, MB |"
echo "|---|---|---|---|---|---|---|"
while read -r name program largest; do
  log=$logs/$name
  covered=$(grep -o 'cov: [0-9]* ft: [0-9]*' "$log" | tail -n 1)
  set -- $covered - - - -
  echo "| $name | $(stat number_of_executed_units "$log") | $(stat average_exec_per_sec "$log") | $2 | $4 | $(stat slowest_ms "$log") | $(stat peak_rss_mb "$log") |"
  if [ "$(cat "$log.status")" -ne 0 ]; then
    failed=1
    grep -E '^violated rule|ERROR|SUMMARY|runtime error|what\(\)|Test unit written' "$log" | sed "s/^/    /"
  fi
done <"$logs.list"
[ $failed -eq 0 ] || echo "Inputs that failed are in $BUILD_DIR/found"
exit $failed
