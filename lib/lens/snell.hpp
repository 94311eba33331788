// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/kernel_vec.hpp"
#include "core/scalar.hpp"

namespace petzval::kernel {

/// Constants of refraction between two media, computed once in double: mu = n/n', k = (n'-n)(n'+n)/n'^2.
/// The product keeps k exact to an ulp where the indices nearly agree.
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

/// Normalises a direction that is nearly of unit length by one Newton step for 1/|d|.
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
/// normal: unit. cosine: direction times normal, > 0; side: 1 where the direction runs along the normal, -1 where
/// against it, and then cosine is minus their product. interface: in the order of travel. `transmitted` is false beyond
/// the critical angle (the direction is then finite but meaningless); at the critical angle itself the ray runs along
/// the surface and counts as refracted. T = mu I + Gamma N with Gamma = cos t' - mu cos t, written as k / (cos t' + mu
/// cos t), which does not cancel. (The second line for Gamma printed by Wu et al. 2010, section 5.1.1, lacks the factor
/// n/n'.) The length of the direction that comes in is put right here, beside the critical path, so that its error
/// never exceeds that of one surface; without, it random-walks over many surfaces, and the hits with it. What goes out
/// last: renormalised().
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

/// The same for a unit normal on either side; the result has unit length.
/// Accuracy: |error| cos(refraction) <= 4 eps, 0.91 at worst in tests/lens. Proven where the ratio of the indices is
/// within 1.8, the sine of the larger angle within 0.9 and the normal within 44 degrees of the axis (`sh tests/run.sh
/// -R Certified`): 16 eps into the denser medium, 24 eps (n / n')^2 into the thinner one.
template <class T>
Refracted<T> refract(const Vec<T>& direction, const Vec<T>& normal, const Interface<Storage<T>>& interface) noexcept {
  using R = Storage<T>;
  const T projection = dot(direction, normal);
  const R side = projection < R(0) ? R(-1) : R(1);
  const auto [refracted, transmitted] = refract(direction, normal, absolute(projection), side, interface);
  return {renormalised(refracted), transmitted};
}

/// Mirrors a unit direction at a surface point; unit normal, either side.
template <class T>
Vec<T> reflect(const Vec<T>& direction, const Vec<T>& normal) noexcept {
  using R = Storage<T>;
  return renormalised(direction - normal * T(R(2) * dot(direction, normal)));
}

}  // namespace petzval::kernel
