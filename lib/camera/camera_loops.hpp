// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "camera_steps.hpp"
#include "core/widest.hpp"
#include "front.hpp"
#include "lens/wavelength_rows.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// A tilted film in numbers of type T: see TiltedPlane. It stays where it is unless it has times.
template <class T>
struct TiltedBounds {
  T x_by_x, x_by_y, y_by_y, depth_by_x, depth_by_y, slope_x, slope_y, cosine;
  T whole_travel;            ///< until the shutter closes
  const T* times = nullptr;  ///< of the samples
};

/// Loops over samples, for float or double.
template <class T>
struct CameraLoopsOf {
  void (*keep_on_film)(const FilmBounds<T>&, std::size_t, const T* film_x, const T* film_y, T* kept_x,
                       T* kept_y) noexcept;
  /// Lines as rays that start in the plane of the pupil. towards: as towards_scene().
  void (*start)(const TwoPlanes&, T towards, std::size_t, const TwoPlaneRays<const T>&, const RayArrays<T>&) noexcept;
  /// Moves the origins of rays to a lens's front, along them.
  void (*move_to_front)(T vertex_z, T curvature, std::size_t, const RayArrays<T>&) noexcept;
  /// The number of each ray's own wavelength; 0 where there is none.
  void (*look_up)(const lens_detail::WavelengthRows<T>&, std::size_t, const RayWavelengths&, T*) noexcept;
  /// scale: one for each ray, 0 for a ray without a wavelength.
  void (*weigh)(const FilmBounds<T>&, T depth, std::size_t, const T* film_x, const T* film_y,
                const TwoPlaneRays<const T>&, const T* areas, const T* scale, RayFate*, const CameraRays<T>&) noexcept;
  /// For a tilted film: the virtual points of film points, the upright film points of lines through the pupil, and the
  /// tilted film's weights from those of such lines.
  void (*to_virtual)(const TiltedBounds<T>&, std::size_t, const T* film_x, const T* film_y, T* virtual_x,
                     T* virtual_y) noexcept;
  void (*to_upright)(const TiltedBounds<T>&, std::size_t, const T* virtual_x, const T* virtual_y, const T* pupil_x,
                     const T* pupil_y, T* film_x, T* film_y) noexcept;
  void (*weigh_tilted)(const TiltedBounds<T>&, std::size_t, const T* virtual_x, const T* virtual_y, const T* pupil_x,
                       const T* pupil_y, RayFate*, const CameraRays<T>&) noexcept;
};
struct CameraLoops {
  CameraLoopsOf<float> single;
  CameraLoopsOf<double> twice;
  /// The ray of one sample with an area, whatever its fate: moves it to a lens's front, unless that is null, and sets
  /// its weight and densities.
  void (*weigh_one)(const Front* front, double depth, const TwoPlaneRay&, double area, double scale,
                    CameraRay&) noexcept;

  template <class T>
  const CameraLoopsOf<T>& of() const noexcept {
    if constexpr (sizeof(T) == sizeof(float)) {
      return single;
    } else {
      return twice;
    }
  }
};

PETZVAL_WIDEST(CameraLoops, camera_loops)

}  // namespace petzval::camera_detail
