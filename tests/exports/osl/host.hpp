// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

// The host environment of an Open Shading Language shader, for a shader that a test has converted to C++. All numbers
// are floats, as in OSL.

struct Triple {
  float value[3] = {0, 0, 0};
  Triple(float all = 0) : value{all, all, all} {}
  Triple(float x, float y, float z) : value{x, y, z} {}
  float operator[](int i) const { return value[i]; }
};
inline Triple operator+(Triple a, Triple b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Triple operator-(Triple a, Triple b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Triple operator*(Triple a, Triple b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
inline Triple operator/(Triple a, Triple b) { return {a[0] / b[0], a[1] / b[1], a[2] / b[2]}; }
inline Triple operator-(Triple a) { return Triple() - a; }
inline Triple& operator+=(Triple& a, Triple b) { return a = a + b; }
inline Triple& operator-=(Triple& a, Triple b) { return a = a - b; }
inline Triple& operator/=(Triple& a, Triple b) { return a = a / b; }
inline float dot(Triple a, Triple b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
using point = Triple;
using vector = Triple;
using color = Triple;

inline Triple raster_position, random_sample, by_column, by_row;
inline vector camera_shader_raster_position() { return raster_position; }
inline vector Dx(vector) { return by_column; }  // of the raster position only
inline vector Dy(vector) { return by_row; }
inline vector camera_shader_random_sample() { return random_sample; }

inline float sqrt(float x) { return std::sqrt(x); }
inline float sin(float x) { return std::sin(x); }
inline float cos(float x) { return std::cos(x); }
inline float floor(float x) { return std::floor(x); }
inline float fabs(float x) { return std::fabs(x); }
inline float log2(float x) { return std::log2(x); }
inline float pow(float x, float y) { return std::pow(x, y); }
inline float atan2(float y, float x) { return std::atan2(y, x); }
inline float min(float a, float b) { return std::min(a, b); }
inline float max(float a, float b) { return std::max(a, b); }
inline float clamp(float x, float least, float most) { return std::clamp(x, least, most); }
