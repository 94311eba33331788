#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Compares the installations of two commits: the binary interface of the libraries and the list of files.
#
#   sh tests/abi.sh OLD [NEW]      commits, tags or branches; NEW is HEAD by default
#
# Prints the changes. The exit status is 0 if programs linked with OLD run with NEW, and 1 if they may fail: then the version
# must get a new MINOR (lib/README.md, Versions).
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/build.sh"
[ $# -ge 1 ] || { echo "usage: sh tests/abi.sh OLD [NEW]" >&2; exit 2; }

need $library_packages git abigail-tools
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# installed SIDE COMMIT: installs a commit with debug information to $work/SIDE/usr.
installed() {
  commit=$(git -C "$root" rev-parse --verify --quiet "$2^{commit}") || { echo "tests/abi.sh: OLD or NEW = $2; must be a commit" >&2; exit 2; }
  mkdir -p "$work/$1/source"
  git -C "$root" archive "$commit" | tar -x -C "$work/$1/source"
  (root=$work/$1/source BUILD_DIR=$work/$1/build
    build -DCMAKE_BUILD_TYPE=Debug -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=OFF)
  cmake --install "$work/$1/build" --prefix "$work/$1/usr" >"$work/$1/log"
  (cd "$work/$1/usr" && find . -type f -o -type l) | sort >"$work/$1/files"
}
# Private data behind the pointer of a class may change.
printf '[suppress_type]\n  name_regexp = ::Data$\n' >"$work/private"

installed old "$1"
installed new "${2:-HEAD}"

c_changes="offset changed|data member deletion|data member changes?:$|enumerator (deletion|change)|parameter [0-9]+ .*(changed|removed|added)|return type changed"

changed=0
echo "== Installed files, old and new"
removed=$(comm -23 "$work/old/files" "$work/new/files")
diff "$work/old/files" "$work/new/files" || true
[ -z "$removed" ] || changed=1
for library in "$work"/old/usr/lib/*/libpetzval-*.so "$work"/old/usr/lib/libpetzval-*.so; do
  [ -e "$library" ] || continue
  name=${library#"$work/old/"}
  echo "== $(basename "$library")"
  [ -e "$work/new/$name" ] || { changed=1; continue; }
  status=0
  abidiff --headers-dir1 "$work/old/usr/include" --headers-dir2 "$work/new/usr/include" --drop-private-types \
    --suppressions "$work/private" "$library" "$work/new/$name" >"$work/report" || status=$?
  cat "$work/report"
  # Bits of the status (manual of abidiff): 1 and 2: failure, 4: change, 8: change that breaks programs.
  [ $((status & 3)) -eq 0 ] || exit 2
  [ $((status & 8)) -eq 0 ] || changed=1
  # In the C interface only new functions, and new members at the end of structs with a size, are allowed.
  case $name in
    *libpetzval-c.so*) ! grep -E "$c_changes" "$work/report" >/dev/null || changed=1 ;;
  esac
done
exit $changed
