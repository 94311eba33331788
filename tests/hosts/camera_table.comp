// SPDX-License-Identifier: Apache-2.0
// Rays and connections of petzval_camera.h as a Vulkan shader, GLSL or HLSL (camera_table_vulkan.cpp).
#ifdef PETZVAL_HLSL
#define table_at(i) table[i]
StructuredBuffer<float> table : register(t0);
StructuredBuffer<float> given : register(t1);
RWStructuredBuffer<float> found : register(u2);
#else
#extension GL_GOOGLE_include_directive : require
#define PETZVAL_GLSL
#define table_at(i) table[i]
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Table { float table[]; };
layout(std430, binding = 1) readonly buffer Given { float given[]; };
layout(std430, binding = 2) writeonly buffer Found { float found[]; };
#endif
#define PETZVAL_TABLE(i) table_at(i)
#include "petzval_camera.h"

// Film x, y, u, v, wavelength -> ray: 6 numbers, weight, fate; connection from the point on the ray at 500 mm: film x, y,
// importance, fate.
void write_result(int i) {
  float nm = given[5 * i + 4];
  pz_ray ray = pz_sample(given[5 * i], given[5 * i + 1], given[5 * i + 2], given[5 * i + 3], nm);
  pz_connection c = pz_connect(pz_along(ray.origin, 500.0f, ray.direction), given[5 * i + 2], given[5 * i + 3], nm);
  found[12 * i] = ray.origin.x;
  found[12 * i + 1] = ray.origin.y;
  found[12 * i + 2] = ray.origin.z;
  found[12 * i + 3] = ray.direction.x;
  found[12 * i + 4] = ray.direction.y;
  found[12 * i + 5] = ray.direction.z;
  found[12 * i + 6] = ray.weight;
  found[12 * i + 7] = float(ray.fate);
  found[12 * i + 8] = c.arrival.film.x;
  found[12 * i + 9] = c.arrival.film.y;
  found[12 * i + 10] = c.arrival.we;
  found[12 * i + 11] = float(c.arrival.fate);
}

#ifdef PETZVAL_HLSL
[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID) { write_result(int(id.x)); }
#else
void main() { write_result(int(gl_GlobalInvocationID.x)); }
#endif
