// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/geometry.hpp"

namespace petzval::kernel {

/// Three components of any scalar type. GLM vectors cannot hold derivatives or lanes.
template <class T>
struct Vec {
  T x, y, z;

  friend Vec operator+(const Vec& a, const Vec& b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(const Vec& a, const Vec& b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(const Vec& a, const T& s) noexcept { return {a.x * s, a.y * s, a.z * s}; }
};

template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
Vec<T> to_kernel(const Vec3<T>& v) noexcept {
  return {v.x, v.y, v.z};
}
template <class T>
Vec3<T> to_public(const Vec<T>& v) noexcept {
  return {v.x, v.y, v.z};
}

}  // namespace petzval::kernel
