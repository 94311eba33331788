#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Compiles petzval_camera.h in every language that has a compiler here, and runs it as C99 and C++11.
#
#   sh camera_table.sh PETZVAL_PROGRAM INCLUDE [CAMERA_TABLE_VULKAN]
#
# CAMERA_TABLE_VULKAN: the program of camera_table_vulkan.cpp, which runs the shaders.
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
program=$1 include=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror"

# The table as C source and as bytes.
"$program" export double_gauss_100mm_f2.0 --blades 7 --f-number 2.8 --camera "$work/camera.h" --quiet
"$program" export double_gauss_100mm_f2.0 --blades 7 --f-number 2.8 --camera "$work/camera.bin" --quiet
cat >"$work/both.c" <<'C'
#include "petzval/petzval_camera.h"
#include "camera.h"
#define PETZVAL_TABLE_NAME second
#include "camera.h"
#include <stdio.h>
int main(void) {
  const pz_ray ray = pz_sample(petzval_table, 1.0f, 2.0f, 0.3f, 0.6f, 587.56f);
  printf("%d %g\n", ray.fate, (double)ray.weight);
  return ray.fate || second[0] != petzval_table[0];
}
C
for compilers in "gcc g++" "clang-14 clang++-14"; do
  c=${compilers% *} cxx=${compilers#* }
  command -v "$c" >/dev/null || continue
  for language in "$c -x c -std=c99" "$cxx -x c++ -std=c++11"; do
    # -ffp-contract=off: equal bits for all compilers. -Wno-...: the program itself is C.
    $language -O2 -ffp-contract=off -fno-math-errno $warnings -I "$include" "$here/camera_table.c" -o "$work/run" -lm
    "$work/run" "$work/camera.bin" 587.5618 >"$work/out"
    [ -e "$work/first" ] || cp "$work/out" "$work/first"
    cmp "$work/out" "$work/first" || { echo "$language prints something else:"; cat "$work/out" "$work/first"; exit 1; }
    $language -O1 -Wall -Wextra -Werror -I "$include" -I "$work" "$work/both.c" -o "$work/run" -lm
    "$work/run" >"$work/out"
    [ -e "$work/second" ] || cp "$work/out" "$work/second"
    cmp "$work/out" "$work/second"
    echo "$language: $(cat "$work/first")"
  done
done
printf '#include "petzval/petzval_camera.h"\n__kernel void rays(__global const float *t, __global float *w, __global const float *f) {\n  int i = get_global_id(0);\n  w[i] = pz_sample(t, f[i], 0.0f, 0.5f, 0.5f, 587.5618f).weight;\n}\n' >"$work/k.cl"
if command -v clang-14 >/dev/null; then
  clang-14 -x cl -cl-std=CL2.0 -Xclang -finclude-default-header -fsyntax-only -I "$include" "$work/k.cl"
  echo "OpenCL C by clang-14 compiles"
fi
printf '#include "petzval/petzval_camera.h"\n__global__ void rays(const float *t, float *w, const float *f) {\n  int i = threadIdx.x;\n  w[i] = pz_sample(t, f[i], 0.0f, 0.5f, 0.5f, 587.5618f).weight;\n}\n' >"$work/k.cu"
if command -v nvcc >/dev/null; then
  nvcc -c -I "$include" "$work/k.cu" -o "$work/k.o"
  echo "CUDA by nvcc compiles"
fi
if command -v glslc >/dev/null; then
  glslc -std=450 -fshader-stage=compute -O -I "$include/petzval" "$here/camera_table.comp" -o "$work/g.spv"
  glslc -x hlsl -DPETZVAL_HLSL -fshader-stage=compute -O -I "$include/petzval" "$here/camera_table.comp" -o "$work/h.spv"
  echo "GLSL and HLSL by glslc compile"
  if [ -n "${3:-}" ]; then
    for lens in double_gauss_100mm_f2.0 fisheye_16mm_f2.8 anamorphic_60mm_2x phone_5.6mm_f3.5; do
      "$program" export "$lens" --film 6x4 --camera "$work/lens.bin" --wavelengths 480,587.5618,640 --quiet
      for shader in g h; do "$3" "$work/$shader.spv" "$work/lens.bin" 480 520 587.5618; done
    done
  fi
fi
