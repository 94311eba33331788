// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "petzval/core/error.hpp"
#include "petzval/core/ray.hpp"

namespace petzval::fuzz {

/// Aborts with the violated rule, so that the fuzzer keeps the input.
inline void require(bool holds, const char* law) {
  if (holds) return;
  std::fprintf(stderr, "violated rule: %s\n", law);
  std::abort();
}

/// Runs work that may throw Error with one line of at most 1000 bytes, and nothing else. True if it did not throw.
bool done(const auto& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    const std::string_view what = error.what();
    require(!what.empty() && what.size() <= 1000, "a message has 1 to 1000 bytes");
    require(what.find('\n') == what.npos, "a message is one line");
    return false;
  }
}

template <class T>
bool finite(const Vec2<T>& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y);
}
template <class T>
bool finite(const Vec3<T>& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
template <class T>
bool finite(const Ray<T>& ray) noexcept {
  return finite(ray.origin) && finite(ray.direction);
}
/// True if a direction has unit length within a rounding error of `eps`.
template <class T>
bool unit(const Vec3<T>& v, double eps) noexcept {
  const double x = v.x, y = v.y, z = v.z;
  return std::abs(x * x + y * y + z * z - 1) <= eps;
}

}  // namespace petzval::fuzz
