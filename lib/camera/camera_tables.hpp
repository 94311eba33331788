// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"

namespace petzval {

/// Layout of camera_tables(): one array of floats, ready to be copied to a GPU. Lens frame, mm.
///
/// The array begins with head_size numbers. Counts, kinds and the positions of the lists are whole numbers.
struct CameraTables {
  enum Position : std::size_t {
    format,  ///< 4
    model,   ///< position in models()
    wavelength_count,
    primary_wavelength,
    film_z,
    pupil_z,
    film_x,  ///< centre of the film
    film_y,
    half_width,  ///< including the margin
    half_height,
    front_z,          ///< vertex of the front of the lens (see Camera)
    front_curvature,  ///< 0: a plane
    wavelengths,      ///< position of a list: [wavelength] nm
    /// Position of a list: [wavelength] weight = scale * area * depth^2 / length^4, with the length of the line from
    /// the film point to the pupil point, and the depth from film_z to pupil_z.
    scales,
    pupil_list,    ///< position of FilmPupilArrays::pupils
    pupils_kind,   ///< a FilmPupilArrays::Kind: 0 polar, 1 images, 2 quadrant
    pupil_radius,  ///< film points farther from the axis see nothing
    rows,
    columns,
    height,
    half_widths,  ///< position of FilmPupilArrays::half_widths
    iris,         ///< position of FilmPupilArrays::iris
    iris_blades,  ///< 0: a disc
    /// Position of a list. First order: [wavelength] a, b, c, d along x, then along y: height = a f + b p and slope = c
    /// f + d p for film point f and pupil point p, in the plane reference_z; rays travel towards -z. Polynomial:
    /// [wavelength] direction_by_film, direction_by_pupil, offset_by_film, offset_by_pupil (RayPolynomial::Fit).
    /// Surfaces: [surface] surface_size numbers: vertex_z, curvature, conic constant, semi-diameter (infinite: 3e38),
    /// radius of the central obscuration, 1 for a mirror, 1 for the stop, 1 for a cylinder curved along x and 2 for a
    /// cylinder curved along y, height h of the aspheric terms, and a[2] ... a[40]: z gains a[i] (r / h)^i, with r
    /// along x or y for a cylinder.
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
    indices,  ///< position of a list: [wavelength][space] index in front of each surface and behind the last one
    /// Position of a list: [edge] nx, ny, bend, distance. Light passes the stop if x nx + y ny + bend (x^2 + y^2) <=
    /// distance for all edges.
    edges,
    edge_count,
    stop_list,  ///< position of FilmPupilArrays::stop
    stop_size,  ///< numbers in stop_list; 0: the iris clips no polygon
    head_size = 38
  };
  static constexpr std::size_t surface_size = 9 + 39;

  /// Checks tables read from a file (read_floats()).
  ///
  /// @param tables  the array
  /// @param where   name of the source, which begins the message
  /// @throws Error  if the format differs or a list has the wrong length
  PETZVAL_API static void check(std::span<const float> tables, const std::string& where);
};

/// The film side of a camera as an array of floats, for sampling on a GPU; CameraTables describes the layout.
///
/// @throws Error  if the film is tilted or travels, if the camera has weights of the pupil, a focal surface or an
///                expressive lens, or if the model is custom
PETZVAL_API std::vector<float> camera_tables(const Camera& camera);

}  // namespace petzval
