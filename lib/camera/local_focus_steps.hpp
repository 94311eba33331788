// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera_steps.hpp"
#include "power_spline.hpp"

/// Steps of LocalFocus for one ray, for loops, single rays and dual numbers.
///
/// To first order the rays of a film point X meet the plane of the entrance pupil at heights H with slopes u = U + w H:
/// U is the slope of the chief ray, and w is 1 / distance of the plane in focus, the same for all rays. To focus on
/// another plane, w is replaced, for each film point, radius in the pupil and wavelength. To change the depth of field,
/// H is scaled by a factor s.
namespace petzval::camera_detail {

/// First-order optics of one wavelength (mm): film point X and pupil point P map to the height a X + b P and the slope
/// c X + d P in the plane of the entrance pupil.
template <class T>
struct EntranceMaps {
  T z = 0;  ///< z of the plane of the entrance pupil
  T a = 0, b = 0, c = 0, d = 0;
  T chief_slope = 0;   ///< slope of the chief ray per mm on the film
  T radius = 0;        ///< radius of the pupil
  T from_surface = 0;  ///< z minus origin_z() of the focal surface
};

/// Requested focus of a film point.
template <class N>
struct FilmPointFocus {
  N excess;   ///< TiltedPlane::distance_excess(): 0 on an upright film
  N surface;  ///< 1 / distance on the focal surface, from its origin
  N offset;   ///< offset of the film divided by its distance from the pupil plane
  N scale;    ///< scale of the pupil
};

/// Data common to all rays.
template <class T>
struct FocusRules {
  EntranceMaps<T> primary;
  bool by_surface = false, by_offset = false;
  T power = 0;  ///< power of the lens, 1/mm
  PowerSpline<T> spline;
};

/// 1 / distance in focus at the centre of the pupil: `own` of the film, `asked` as requested.
template <class N>
struct InFocus {
  N own, asked;
};

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

/// 1 / distance in focus of a film point with the given TiltedPlane::distance_excess().
template <class T, class N>
inline N in_focus(const EntranceMaps<T>& maps, N excess) noexcept {
  return (maps.d - maps.c * excess) / (maps.b - maps.a * excess);
}

template <class T, class N>
inline InFocus<N> focus_of(const FocusRules<T>& rules, const EntranceMaps<T>& maps, T dispersion,
                           const FilmPointFocus<N>& point) noexcept {
  const N own = in_focus(maps, point.excess), primary = in_focus(rules.primary, point.excess);
  N asked = primary;
  if (rules.by_surface) asked = point.surface / (T(1) + point.surface * maps.from_surface);
  if (rules.by_offset) {
    // The distance of the film point from the pupil plane is the upright film's distance divided by 1 + excess.
    const N moved = T(1) / (T(1) / (T(1) + point.excess) + point.offset) - T(1);
    asked += in_focus(rules.primary, moved) - primary;
  }
  asked += (own - primary) * dispersion;
  return {own, asked};
}

/// A ray in the plane of the entrance pupil, from a ray in the plane z.
template <class N>
struct AtEntrance {
  N x, y, slope_x, slope_y;
};
template <class T, class R>
inline auto at_entrance(const EntranceMaps<T>& maps, T z, const R& ray) noexcept {
  const auto& [o, d] = ray;
  using N = std::remove_cvref_t<decltype(o.x)>;
  const N per_z = T(1) / d.z, slope_x = d.x * per_z, slope_y = d.y * per_z;
  const T away = maps.z - z;
  return AtEntrance<N>{o.x + slope_x * away, o.y + slope_y * away, slope_x, slope_y};
}

/// Height of a ray in the scaled pupil, divided by the radius of the pupil.
template <class T, class N>
inline N radius_of(const EntranceMaps<T>& maps, const FilmPointFocus<N>& point, const AtEntrance<N>& ray) noexcept {
  // Avoids the square root of 0, which has no derivative.
  return core_detail::square_root(N(ray.x * ray.x + ray.y * ray.y + T(1e-30))) * point.scale * (T(1) / maps.radius);
}

/// Bends a ray.
/// @param z plane in which the ray is given and returned
/// @param by_radius power that the spline adds at the radius of the ray, 1/mm
template <class T, class N, class R>
inline void bend_ray(const FocusRules<T>& rules, const EntranceMaps<T>& maps, T dispersion, T z,
                     const FilmPointFocus<N>& point, N by_radius, R& ray) noexcept {
  const auto [own, asked] = focus_of(rules, maps, dispersion, point);
  const auto [x, y, slope_x, slope_y] = at_entrance(maps, z, ray);
  // u' = U + w' s H = u + (w' s - w) H.
  const N turn = (asked + by_radius) * point.scale - own;
  const N u = slope_x + turn * x, v = slope_y + turn * y;
  const N down = T(-1) / core_detail::square_root(N(u * u + v * v + T(1)));
  const T away = maps.z - z;
  auto& [o, d] = ray;
  o.x = x * point.scale - u * away, o.y = y * point.scale - v * away, o.z = N(z);
  d.x = u * down, d.y = v * down, d.z = down;
}

}  // namespace
}  // namespace petzval::camera_detail
