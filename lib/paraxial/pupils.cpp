// SPDX-License-Identifier: Apache-2.0
#include "petzval/paraxial/first_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The surface that clips the axial beam from infinity first: the surface with the least ratio of its semi-diameter to
/// the height of a ray that enters at height 1. In a lens with cylinders the height is the larger one of both
/// meridians.
std::size_t limiting_surface(const Lens& lens, Wavelength wavelength) {
  std::size_t limiting = lens.surface_count();
  double least = infinity;
  const auto in_y = ray_matrices_to(lens, wavelength, Meridian::y),
             in_x = ray_matrices_to(lens, wavelength, Meridian::x);
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const double height = std::max(std::abs(in_y[i].a), std::abs(in_x[i].a));
    const double semi_diameter = lens.surfaces()[i].semi_diameter;
    const double entering = semi_diameter == 0 ? 0 : semi_diameter / height;
    if (entering < least) {
      least = entering;
      limiting = i;
    }
  }
  if (limiting == lens.surface_count()) {
    throw Error(lens.name() + (lens.stop() ? ": the stop has no rim" : ": no stop is marked") +
                " and no surface limits the axial beam; at least one surface must have a semi_diameter");
  }
  return limiting;
}

/// The image of the stop, from a ray through the centre of the stop with optical slope 1. At a vertex, this ray has
/// height y and optical slope nu. By the Lagrange invariant, nu is the size of the stop divided by the size of its
/// image. An image more than 1e12 times as large as the stop counts as infinitely distant: telecentric up to rounding.
Pupil pupil(double vertex_z, double n, double y, double nu, double semi_diameter) {
  if (std::abs(nu) < 1e-12) return {infinity, infinity};
  return {vertex_z - n * y / nu, 2 * semi_diameter / std::abs(nu)};
}

}  // namespace

bool has_pupils(const Lens& lens) noexcept {
  const auto limits = [](const LensSurface& s) { return std::isfinite(s.semi_diameter); };
  return std::any_of(lens.surfaces().begin(), lens.surfaces().end(), limits);
}

Pupils pupils(const Lens& lens, Wavelength wavelength, Meridian meridian) {
  Pupils result;
  // A marked stop without a rim does not clip rays.
  result.stop_inferred = !lens.stop() || std::isinf(lens.surfaces()[*lens.stop()].semi_diameter);
  result.stop = result.stop_inferred ? limiting_surface(lens, wavelength) : *lens.stop();

  // The ray (0, 1) at the vertex of the stop is (-b, a) at the first vertex, by the inverse of the front matrix, and
  // (b, d) at the last vertex.
  const RayMatrix front = ray_matrix_to(lens, result.stop, wavelength, meridian);
  const RayMatrix rear = ray_matrix(lens, result.stop, lens.surface_count(), wavelength, meridian);
  const double n = signed_index(lens, 0, wavelength);
  const double n_image = signed_index(lens, lens.surface_count(), wavelength);
  const double semi_diameter = lens.surfaces()[result.stop].semi_diameter;
  result.entrance = pupil(lens.surfaces().front().vertex_z, n, -front.b, front.a, semi_diameter);
  result.exit = pupil(lens.surfaces().back().vertex_z, n_image, rear.b, rear.d, semi_diameter);
  return result;
}

double paraxial_f_number(const Lens& lens, Wavelength wavelength) {
  const Meridian meridian = main_meridian(lens, wavelength);
  const double diameter = pupils(lens, wavelength, meridian).entrance.diameter;
  const FirstOrder data = first_order(lens, wavelength, meridian);
  return data.afocal ? infinity : std::abs(data.effective_focal_length) / diameter;
}

double film_side_f_number(const Lens& lens, Wavelength wavelength) {
  const Pupil exit = pupils(lens, wavelength).exit;
  if (exit.diameter == 0) return infinity;  // also if the pupil lies on the film
  return std::isfinite(exit.z) ? std::abs((lens.film_z() - exit.z) / exit.diameter)
                               : paraxial_f_number(lens, wavelength);
}

}  // namespace petzval
