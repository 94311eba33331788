// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "camera_steps.hpp"
#include "core/widest.hpp"
#include "front.hpp"
#include "lens/wavelength_rows.hpp"
#include "local_focus_steps.hpp"
#include "paraxial_model.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// A TiltedPlane in numbers of type T. The film moves only if `times` is set.
template <class T>
struct TiltedBounds {
  T x_by_x, x_by_y, y_by_y, depth_by_x, depth_by_y, slope_x, slope_y, cosine;
  T whole_travel;            ///< travel during the complete exposure
  const T* times = nullptr;  ///< one for each sample
};

/// Maps film lines to rays in the plane z, for first-order models.
template <class T>
struct ParaxialJob {
  lens_detail::WavelengthRows<T> maps;  ///< the numbers of two SectionMaps
  bool equal_sections = false;          ///< true if both sections are equal
  const SectionMaps* shared = nullptr;  ///< at the common wavelength; null if it is not covered
  T z = 0;
  T reach = 0;  ///< largest sum of absolute coordinates of a line
  RayWavelengths wavelengths;
};

/// FilmPointFocus of N film points.
template <class T>
struct FilmPointFocuses {
  const T* excess;
  const T* surface;
  const T* offset;
  const T* scale;
};

constexpr std::size_t bend_block = 256;

/// Loops over samples, for float or double.
template <class T>
struct CameraLoopsOf {
  void (*keep_on_film)(const FilmBounds<T>&, std::size_t, const T* film_x, const T* film_y, T* kept_x,
                       T* kept_y) noexcept;
  /// Turns lines into rays that start in the pupil plane.
  /// @param towards as towards_scene()
  void (*start)(const TwoPlanes&, T towards, std::size_t, const TwoPlaneRays<const T>&, const RayArrays<T>&) noexcept;
  /// Moves the origins of rays along the rays to the front of the lens.
  void (*move_to_front)(T vertex_z, T curvature, std::size_t, const RayArrays<T>&) noexcept;
  /// Looks up a value for the wavelength of each ray; 0 if the wavelength is not covered.
  void (*look_up)(const lens_detail::WavelengthRows<T>&, std::size_t, const RayWavelengths&, T*) noexcept;
  /// @param scale one value for each ray; 0 if the wavelength is not covered
  void (*weigh)(const FilmBounds<T>&, T depth, std::size_t, const T* film_x, const T* film_y,
                const TwoPlaneRays<const T>&, const T* areas, const T* scale, RayFate*, const CameraRays<T>&) noexcept;
  /// For a tilted film: virtual points of film points and their distance_excess(), upright film points of lines through
  /// the pupil, and conversion of upright weights to weights of the tilted film.
  void (*to_virtual)(const TiltedBounds<T>&, std::size_t, const T* film_x, const T* film_y, T* virtual_x, T* virtual_y,
                     T* excess) noexcept;
  void (*to_upright)(std::size_t, const T* excess, const T* virtual_x, const T* virtual_y, const T* pupil_x,
                     const T* pupil_y, T* film_x, T* film_y) noexcept;
  void (*weigh_tilted)(const TiltedBounds<T>&, std::size_t, const T* excess, const T* pupil_x, const T* pupil_y,
                       RayFate*, const CameraRays<T>&) noexcept;
  void (*map)(std::size_t, const ParaxialJob<T>&, const TwoPlaneRays<const T>&, const RayArrays<T>&, RayFate*) noexcept;
  /// Bends up to bend_block rays of one wavelength, in place.
  /// @param z plane in which the rays are given
  void (*bend)(const FocusRules<T>&, const EntranceMaps<T>&, T dispersion, T z, std::size_t, const FilmPointFocuses<T>&,
               const RayArrays<T>&) noexcept;
};
struct CameraLoops {
  CameraLoopsOf<float> single;
  CameraLoopsOf<double> twice;
  /// Moves the ray of one sample to the front (if not null) and sets its weight and densities, for every fate.
  void (*weigh_one)(const Front* front, double depth, const TwoPlaneRay&, double area, double scale,
                    CameraRay&) noexcept;
  /// Maps one line.
  /// @param maps null like ParaxialJob::shared
  RayFate (*map_one)(const SectionMaps* maps, double z, double reach, const TwoPlaneRay& line,
                     Ray<double>& ray) noexcept;

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
