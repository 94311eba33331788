// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/kernel_vec.hpp"
#include "core/scalar.hpp"

namespace petzval::kernel {

/// Constants of refraction between two media, computed in double: mu = n/n', k = (n'-n)(n'+n)/n'^2.
/// The product keeps k exact to an ulp if the indices are nearly equal.
template <class R>
struct Interface {
  R mu = 1;
  R k = 0;
};

template <class R>
Interface<R> make_interface(double n_in, double n_out) noexcept {
  return {static_cast<R>(n_in / n_out), static_cast<R>((n_out - n_in) * (n_out + n_in) / (n_out * n_out))};
}

template <class T>
struct Refracted {
  Vec<T> direction;
  Mask<T> transmitted;
};

/// Factor that normalises a direction of nearly unit length: one Newton step for 1/|d|.
template <class T>
T length_correction(const Vec<T>& d) noexcept {
  using R = Storage<T>;
  return R(1.5) - R(0.5) * dot(d, d);
}

template <class T>
Vec<T> renormalised(const Vec<T>& d) noexcept {
  return d * length_correction(d);
}

/// Refracts a direction at a surface point (Snell's law in vector form).
///
/// T = mu I + Gamma N with Gamma = cos t' - mu cos t, written as k / (cos t' + mu cos t), which does not cancel. (The
/// second line for Gamma printed by Wu et al. 2010, section 5.1.1, lacks the factor n/n'.)
///
/// The length of the incoming direction is corrected here, off the critical path, so that its error never exceeds the
/// error of one surface. Without the correction, this error and the errors of the hits would grow like a random walk
/// over many surfaces. The last direction of a lens must be normalised by renormalised().
/// @param normal unit normal
/// @param cosine |direction . normal|
/// @param side 1 if the direction points along the normal, otherwise -1
/// @param interface in the order of travel
/// @return `transmitted` is false beyond the critical angle (the direction is then finite but meaningless); at the
///   critical angle itself the ray travels along the surface and counts as refracted
template <class T>
Refracted<T> refract(const Vec<T>& direction, const Vec<T>& normal, const T& cosine, Storage<T> side,
                     const Interface<Storage<T>>& interface) noexcept {
  using R = Storage<T>;
  const T mu = interface.mu * length_correction(direction);
  const T mc = mu * cosine;
  const T s = interface.k + mc * mc;  // cos^2 of the angle of refraction
  const T sum = safe_sqrt(s) + mc;
  const auto regular = sum > R(0);
  const T gamma = (side * interface.k) / select(regular, sum, T(1));
  return {direction * mu + normal * gamma, s >= R(0)};
}

/// Refracts a direction for a unit normal on either side; the result has unit length.
///
/// Accuracy: |error| cos(refraction) <= 4 eps, 0.91 at worst in tests/lens. Proven for a ratio of the indices within
/// 1.8, the sine of the larger angle within 0.9 and the normal within 44 degrees of the axis (`sh tests/run.sh -R
/// Certified`): 16 eps into the denser medium, 24 eps (n / n')^2 into the less dense medium.
template <class T>
Refracted<T> refract(const Vec<T>& direction, const Vec<T>& normal, const Interface<Storage<T>>& interface) noexcept {
  using R = Storage<T>;
  const T projection = dot(direction, normal);
  const R side = projection < R(0) ? R(-1) : R(1);
  const auto [refracted, transmitted] = refract(direction, normal, absolute(projection), side, interface);
  return {renormalised(refracted), transmitted};
}

/// Reflects a unit direction at a surface point, for a unit normal on either side.
template <class T>
Vec<T> reflect(const Vec<T>& direction, const Vec<T>& normal) noexcept {
  using R = Storage<T>;
  return renormalised(direction - normal * T(R(2) * dot(direction, normal)));
}

}  // namespace petzval::kernel
