# SPDX-License-Identifier: Apache-2.0
# Sourced by tests/run.sh, examples/run.sh and tests/bench/run.sh, which set $root to the repository: what a bare Debian 12
# needs to build petzval, and the build. POSIX sh.

library_packages="g++ cmake ninja-build pkg-config libglm-dev nlohmann-json3-dev libeigen3-dev libyaml-cpp-dev libceres-dev libopenexr-dev libpng-dev"
example_packages="libcli11-dev libembree-dev libtinyobjloader-dev libjpeg-dev libsdl2-dev libimgui-dev"
test_packages="libgtest-dev"
full_packages="glslc libvulkan-dev mesa-vulkan-drivers xvfb xauth xdotool libgl1-mesa-dri python3 python3-numpy python3-opencv liblensfun-data-v1 povray libbenchmark-dev"  # for tests and benchmarks
docs_packages="doxygen"  # of the target docs; install them yourself

# Sources are compiled in groups: a third to a half less work from nothing, more after a change of one source.
unity=-DCMAKE_UNITY_BUILD=${UNITY:-ON}

# Objects of earlier builds, where ccache is installed.
cached=
if command -v ccache >/dev/null; then cached="-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache"; fi

BUILD_DIR=${BUILD_DIR:-$root/build}
case $BUILD_DIR in
  /*) ;;
  *) BUILD_DIR=$PWD/$BUILD_DIR ;;
esac

# need PACKAGE...: installs those that are missing. Where none is, it asks for neither root nor network.
need() {
  if ! command -v dpkg-query >/dev/null; then
    echo "Not a Debian system: install the equivalents of $* yourself; going on with what is there." >&2
    return 0
  fi
  missing=
  for package in "$@"; do
    case $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) in
      installed*) ;;
      *) missing="$missing $package" ;;
    esac
  done
  [ -n "$missing" ] || return 0
  echo "== Installing$missing"
  as_root=
  [ "$(id -u)" -eq 0 ] || as_root=sudo
  $as_root apt-get update
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
}

# build OPTION...: configures with the CMake options given and builds $target, or all, in $BUILD_DIR.
build() {
  echo "== Configuring in $BUILD_DIR"
  cmake -S "$root" -B "$BUILD_DIR" -G Ninja -DCMAKE_BUILD_TYPE=Release $cached "$@"
  echo "== Building"
  NINJA_STATUS="[%f/%t, %es] " cmake --build "$BUILD_DIR" --target "${target:-all}"
}
