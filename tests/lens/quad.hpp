// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

/// Numbers of 113 bits, the reference for kernels in double.
#if __LDBL_MANT_DIG__ == 113
using Quad = long double;
#else
__extension__ typedef __float128 Quad;
#endif

inline Quad root(Quad x) {
  if (!(x > 0)) return 0;
  Quad r = static_cast<Quad>(std::sqrt(static_cast<long double>(x)));
  for (int i = 0; i < 3; ++i) r = (r + x / r) / 2;
  return r;
}

struct QuadVec {
  Quad x, y, z;
};

inline Quad inner(const QuadVec& a, const QuadVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline QuadVec along(const QuadVec& p, const QuadVec& d, Quad t) {
  return {p.x + t * d.x, p.y + t * d.y, p.z + t * d.z};
}
inline QuadVec unit(const QuadVec& v) {
  const Quad l = root(inner(v, v));
  return {v.x / l, v.y / l, v.z / l};
}
