// SPDX-License-Identifier: Apache-2.0
// A single number with the interface of lanes.hpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/simd.hpp"

namespace petzval::core_detail::one_lane {
namespace {

template <class R>
struct Native {
  using Bit = std::int32_t;
  using Bits = std::int32_t;
};

template <class R>
struct Mask {
  bool bits;

  friend Mask operator&(Mask a, Mask b) noexcept { return {a.bits && b.bits}; }
  friend Mask operator|(Mask a, Mask b) noexcept { return {a.bits || b.bits}; }
  friend Mask without(Mask a, Mask b) noexcept { return {a.bits && !b.bits}; }
};

template <class R>
struct Lanes {
  using Scalar = R;
  static constexpr int width = 1;
  R v;

  Lanes() = default;
  Lanes(R value) noexcept : v(value) {}

  friend Lanes operator+(Lanes a, Lanes b) noexcept { return a.v + b.v; }
  friend Lanes operator-(Lanes a, Lanes b) noexcept { return a.v - b.v; }
  friend Lanes operator*(Lanes a, Lanes b) noexcept { return a.v * b.v; }
  friend Lanes operator/(Lanes a, Lanes b) noexcept { return a.v / b.v; }
  friend Lanes operator-(Lanes a) noexcept { return -a.v; }

  friend Mask<R> operator<(Lanes a, Lanes b) noexcept { return {a.v < b.v}; }
  friend Mask<R> operator<=(Lanes a, Lanes b) noexcept { return {a.v <= b.v}; }
  friend Mask<R> operator>(Lanes a, Lanes b) noexcept { return {a.v > b.v}; }
  friend Mask<R> operator>=(Lanes a, Lanes b) noexcept { return {a.v >= b.v}; }
};

template <class R>
Lanes<R> select(Mask<R> mask, Lanes<R> a, Lanes<R> b) noexcept {
  return mask.bits ? a : b;
}
template <class R>
bool any(Mask<R> mask) noexcept {
  return mask.bits;
}
template <class R>
bool every(Mask<R> mask) noexcept {
  return mask.bits;
}
template <class R, class... More>
Mask<R> all_of(Mask<R> a, More... more) noexcept {
  return {(a.bits && ... && more.bits)};
}
template <class R>
Mask<R> also(Mask<R> a, Mask<R> b) noexcept {
  return a & b;
}
template <class R>
Mask<R> any_of(Mask<R> a, Mask<R> b) noexcept {
  return a | b;
}

template <class R>
Lanes<R> sqrt(Lanes<R> x) noexcept {
  return std::sqrt(x.v);
}
template <class R>
Lanes<R> root(Lanes<R> x) noexcept {
  return sqrt(x);
}
template <class R>
Lanes<R> second_root(Lanes<R> x) noexcept {
  return sqrt(x);
}
template <class R>
Lanes<R> quotient(Lanes<R> a, Lanes<R> b) noexcept {
  return a / b;
}
template <class R>
Lanes<R> near_reciprocal(Lanes<R> b) noexcept {
  return Lanes<R>(R(1)) / b;
}
template <class R>
Mask<R> has_root(Lanes<R> x) noexcept {
  return x >= Lanes<R>(R(0));
}

template <int by, class R>
void count(std::int32_t& counter, Mask<R> mask) noexcept {
  counter += mask.bits ? by : 0;
}
template <class R>
void keep(std::int32_t& counter, Mask<R> mask, std::int32_t other) noexcept {
  counter = mask.bits ? other : counter;
}

template <class R>
Lanes<R> load(const R* from) noexcept {
  return *from;
}
template <class R>
void store(R* to, Lanes<R> x) noexcept {
  *to = x.v;
}

template <class R>
int lanes_in(Mask<R> mask) noexcept {
  return mask.bits ? 1 : 0;
}
template <class R>
void pack(R* to, Mask<R>, Lanes<R> x) noexcept {
  *to = x.v;
}
template <class R>
Lanes<R> unpack(const R* from, Mask<R> mask, Lanes<R> others) noexcept {
  return mask.bits ? Lanes<R>(*from) : others;
}

}  // namespace
}  // namespace petzval::core_detail::one_lane
