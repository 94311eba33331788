#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds core, blur and their tests for other platforms with Debian's cross compilers, and runs the tests if an emulator (qemu-user,
# wine) is installed.
#
#   sh tests/platforms/run.sh [aarch64] [windows] [-- arguments of the test programs, such as --gtest_filter='*Bits*']
#
# PLATFORMS_DIR=... replaces build/platforms/. Downloads the sources of yaml-cpp once.
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
root=$(dirname "$(dirname "$here")")
. "$root/cmake/build.sh"
work=${PLATFORMS_DIR:-$root/build/platforms}

platforms=
while [ $# -gt 0 ]; do
  case $1 in
    aarch64 | windows) platforms="$platforms $1" ;;
    --) shift; break ;;
    *) echo "tests/platforms/run.sh: platform = $1; must be aarch64, windows or --" >&2; exit 2 ;;
  esac
  shift
done
platforms=${platforms:-aarch64 windows}

# Shared by all platforms: headers with their CMake packages, and sources.
prepare() {
  need $library_packages googletest
  [ -e "$work/prepared" ] && return
  rm -rf "$work/host"
  mkdir -p "$work/host/lists/partial" "$work/host/sources" "$work/host/prefix"
  for package in libglm-dev nlohmann-json3-dev libeigen3-dev; do
    dpkg -L "$package"
  done | grep -E '^/usr/(include/(glm|nlohmann|eigen3)|share/(cmake|eigen3))/' |
    while read -r file; do [ -d "$file" ] || echo "${file#/usr/}"; done | tar -C /usr -c -T - | tar -C "$work/host/prefix" -x

  echo "== Fetching the sources of yaml-cpp"
  for suite in bookworm bookworm-updates; do
    echo "deb-src http://deb.debian.org/debian $suite main"
  done >"$work/host/sources/debian.list"
  apt="-o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts=$work/host/sources -o Dir::State::Lists=$work/host/lists"
  apt-get $apt -qq update
  (cd "$work/host" && apt-get $apt -qq source --download-only yaml-cpp)
  mkdir "$work/host/yaml-cpp"
  tar -C "$work/host/yaml-cpp" --strip-components=1 -xf "$work"/host/yaml-cpp_*.orig.tar.*
  touch "$work/prepared"
}

# library PLATFORM NAME SOURCE OPTION...: builds a static library that core or the tests link.
library() {
  platform=$1 name=$2 source=$3
  shift 3
  [ -e "$work/$platform/prefix/$name" ] && return
  cmake -S "$source" -B "$work/$platform/$name" -G Ninja --toolchain "$here/$platform.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON "-DCMAKE_INSTALL_PREFIX=$work/$platform/prefix" "$@"
  cmake --build "$work/$platform/$name" --target install
  touch "$work/$platform/prefix/$name"
}

for platform in $platforms; do
  case $platform in
    aarch64) need g++-aarch64-linux-gnu; emulator='qemu-aarch64 -L /usr/aarch64-linux-gnu' ;;
    windows) need g++-mingw-w64-x86-64-posix; emulator=wine ;;
  esac
  prepare
  echo "== Building for $platform"
  library "$platform" yaml-cpp "$work/host/yaml-cpp" -DYAML_CPP_BUILD_TESTS=OFF -DYAML_CPP_BUILD_TOOLS=OFF -DYAML_BUILD_SHARED_LIBS=OFF
  library "$platform" googletest /usr/src/googletest -DBUILD_GMOCK=OFF
  cmake -S "$root" -B "$work/$platform/petzval" -G Ninja --toolchain "$here/$platform.cmake" -DCMAKE_BUILD_TYPE=Release \
    "-DCMAKE_PREFIX_PATH=$work/$platform/prefix;$work/host/prefix" \
    "-DCMAKE_FIND_ROOT_PATH=$work/$platform/prefix;$work/host/prefix" \
    -DBUILD_SHARED_LIBS=OFF -DPETZVAL_WITH_CERES=OFF -DPETZVAL_WITH_OPENEXR=OFF -DPETZVAL_BUILD_EXAMPLES=OFF
  NINJA_STATUS="[%f/%t, %es] " cmake --build "$work/$platform/petzval"
  if ! command -v "${emulator%% *}" >/dev/null; then
    echo "== ${emulator%% *} is not installed: the tests for $platform are built, but not run"
    continue
  fi
  echo "== Testing for $platform"
  # Runs whole programs, because an emulator starts more slowly than most tests run.
  failed=
  for program in "$work/$platform/petzval"/tests/*/*_tests "$work/$platform/petzval"/tests/*/*_tests.exe; do
    [ -x "$program" ] || continue
    echo "== ${program##*/}"
    (cd "$(dirname "$program")" && WINEDEBUG=-all $emulator "$program" --gtest_brief=1 "$@") || failed="$failed ${program##*/}"
  done
  if [ $# -eq 0 ]; then
    ctest --test-dir "$work/$platform/petzval" -j "$(nproc)" --no-tests=error --output-on-failure -R '^fuzz' ||
      failed="$failed fuzz_replay"
  fi
  if [ -n "$failed" ]; then
    echo "tests/platforms/run.sh: failed on $platform:$failed" >&2
    exit 1
  fi
done
