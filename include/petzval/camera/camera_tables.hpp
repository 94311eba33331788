// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "petzval/core/export.hpp"

namespace petzval {

/// The layout of Camera::tables(): one array of floats, to be copied to a GPU as it is. Counts, kinds and positions in
/// the array are whole numbers. Lens frame, mm.
///
///     format ... edge_count  the positions below
///     wavelengths            [wavelength] nm
///     scales                 [wavelength] of weights: weight = scale area depth^2 / length^4, length that of the line
///                            from the film point to the place in the pupil, depth from film_z to pupil_z
///     pupil_list, half_widths, iris, stop_list  as in FilmPupilArrays
///     rays, first order      [wavelength] a, b, c, d along x, then along y: place = a f + b p and slope = c f + d p of
///                            film and pupil point, in the plane reference_z; rays run towards -z
///     rays, polynomial       [wavelength] the coefficients of direction_by_film, direction_by_pupil, offset_by_film
///                            and offset_by_pupil (see RayPolynomial; degree and domain: below)
///     rays, surfaces         [surface] surface_size numbers each: vertex_z, curvature, conic constant, semi-diameter
///                            (infinite: 3e38), that of the central obscuration, 1 for a mirror, 1 for the stop,
///                            1 for a cylinder curved along x and 2 for one along y, height h of the aspheric terms,
///                            and a[2] ... a[40]: z gains a[i] (r / h)^i, r along x or y of a cylinder
///     indices                [wavelength][space] of the media, before each surface and behind the last one
///     edges                  [edge] nx, ny, bend, distance: light passes the stop where
///                            x nx + y ny + bend (x^2 + y^2) <= distance
struct CameraTables {
  enum Position : std::size_t {
    format,  ///< 4
    model,   ///< position in models()
    wavelength_count,
    primary_wavelength,
    film_z,
    pupil_z,
    film_x,  ///< of the middle of the film
    film_y,
    half_width,  ///< with the margin
    half_height,
    front_z,          ///< vertex of the front of the lens (see Camera)
    front_curvature,  ///< 0: a plane
    wavelengths,      ///< where the lists begin
    scales,
    pupil_list,
    pupils_kind,   ///< a FilmPupilArrays::Kind: 0 polar, 1 images, 2 quadrant
    pupil_radius,  ///< film points farther from the axis see nothing
    rows,
    columns,
    height,
    half_widths,
    iris,
    iris_blades,  ///< 0: a disc
    rays,
    rays_kind,  ///< 0 first order, 1 polynomial, 2 surfaces
    reference_z,
    degree,
    domain_film_radius,
    domain_pupil_shift,
    domain_pupil_radius,
    domain_pupil_shift_x,
    domain_pupil_radius_x,  ///< 0: a polynomial of a lens of revolution
    surface_count,
    indices,
    edges,
    edge_count,
    stop_list,
    stop_size,  ///< numbers in it; 0: the iris cuts no polygon
    head_size = 38
  };
  static constexpr std::size_t surface_size = 9 + 39;

  /// For tables that were read from a file (read_floats() in io/write_file.hpp). Throws Error, which begins with
  /// `where`, for another format and for lists that are not as long as they must be.
  PETZVAL_API static void check(std::span<const float> tables, const std::string& where);
};

}  // namespace petzval
