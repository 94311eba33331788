// SPDX-License-Identifier: Apache-2.0
// Welford's notation: A = n (y c + u) and Abar = n (ybar c + ubar) are the refraction invariants of the marginal ray
// and the chief ray, H = n (u ybar - ubar y) = A ybar - Abar y is the optical invariant, and a step is the change of a
// value at a surface. Indices and thicknesses are signed, which covers mirrors.
#include "petzval/analysis/aberrations.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "core/text.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

/// A surface by its vertex curvature and the coefficient of r^4 that a sphere of this curvature lacks.
struct ThirdOrderShape {
  double curvature, fourth;
};

ThirdOrderShape third_order_shape(const LensSurface& surface) noexcept {
  const double c = surface.curvature;
  double vertex = c, fourth = 0;
  for (const auto& [order, coefficient] : surface.aspheric) {
    if (order == 2) vertex += 2 * coefficient;
    if (order == 4) fourth += coefficient;
  }
  // The last term is exactly 0 without a term of order 2.
  return {vertex, fourth + surface.conic * c * c * c / 8 + (c * c * c - vertex * vertex * vertex) / 8};
}

/// Height and optical slope n u.
struct RayState {
  double y, nu;
};

void check(const Lens& lens, const ParaxialField& field) {
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    if (lens.surfaces()[i].curved_in != Section::both) {
      throw Error(lens.name() + ": surface " + std::to_string(i) +
                  " is a cylinder; paraxial_rays and seidel_sums need a lens of revolution");
    }
  }
  const auto fail = [&](const char* parameter, double value, const char* rule) {
    throw Error(lens.name() + ": " + parameter + " = " + to_text(value) + "; must be " + rule);
  };
  if (std::isnan(field.object_distance)) fail("object_distance", field.object_distance, "a number");
  if (const auto& diameter = field.entrance_pupil_diameter; diameter && !(*diameter > 0 && std::isfinite(*diameter))) {
    fail("entrance_pupil_diameter", *diameter, "positive and finite");
  }
  if (field.object_height) {
    if (!std::isfinite(*field.object_height)) fail("object_height", *field.object_height, "finite");
    if (!(std::abs(field.object_distance) <= 1e100)) {
      fail("object_distance", field.object_distance, "finite if an object height is given");
    }
  } else if (!(std::abs(field.field_rad) < std::numbers::pi / 2)) {
    fail("field_rad", field.field_rad, "between -pi/2 and pi/2");
  }
}

}  // namespace

ParaxialRays paraxial_rays(const Lens& lens, const ParaxialField& field, Wavelength wavelength) {
  check(lens, field);
  const Pupils stopped = pupils(lens, wavelength);
  const std::size_t stop = stopped.stop;
  double radius = lens.surfaces()[stop].semi_diameter;
  if (field.entrance_pupil_diameter) radius *= *field.entrance_pupil_diameter / stopped.entrance.diameter;
  const RayMatrix front = ray_matrix_to(lens, stop, wavelength);
  double n = signed_index(lens, 0, wavelength);

  // The marginal ray has a y + b n u = radius at the stop. It starts on the axis at the distance L: y = L u.
  const bool distant = std::abs(field.object_distance) > 1e100;
  const double reduced = field.object_distance / n;
  RayState marginal{radius / front.a, 0};
  if (!distant) {
    const double nu = radius / (front.a * reduced + front.b);
    marginal = {reduced * nu, nu};
  }
  if (marginal.y < 0 || (marginal.y == 0 && marginal.nu < 0)) marginal = {-marginal.y, -marginal.nu};

  // A ray through the centre of the stop is a multiple of (-b, a) at the first vertex.
  const double scale = field.object_height ? -*field.object_height / (front.a * reduced + front.b)
                                           : n * std::tan(field.field_rad) / front.a;
  // The chief ray of the axial point is the axis, also if a telecentric lens has no multiple.
  const bool on_axis = field.object_height.value_or(field.field_rad) == 0;
  RayState chief = on_axis ? RayState{0, 0} : RayState{-front.b * scale, front.a * scale};
  if (!(radius > 0) || !std::isfinite(marginal.y + marginal.nu) || !std::isfinite(chief.y + chief.nu)) {
    throw Error(
        lens.name() + ": no " + (std::isfinite(marginal.y + marginal.nu) ? "chief" : "marginal") +
        " ray; the object must not lie at the image of the stop, and an object given by an angle or at infinity "
        "needs an entrance pupil at a finite distance");
  }

  ParaxialRays result{.object_marginal_u = marginal.nu / n, .object_chief_u = chief.nu / n, .surfaces = {}};
  result.invariant = marginal.nu * chief.y - chief.nu * marginal.y;
  result.surfaces.reserve(lens.surface_count());
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const double n_out = signed_index(lens, i + 1, wavelength);
    const double power = (n_out - n) * third_order_shape(lens.surfaces()[i]).curvature;
    marginal.nu -= power * marginal.y;
    chief.nu -= power * chief.y;
    n = n_out;
    const ParaxialRays::Pair& at =
        result.surfaces.emplace_back(ParaxialRays::Pair{marginal.y, marginal.nu / n, chief.y, chief.nu / n});
    marginal.y += lens.surfaces()[i].thickness * at.marginal_u;
    chief.y += lens.surfaces()[i].thickness * at.chief_u;
  }
  return result;
}

SeidelSums seidel_sums(const Lens& lens, const ParaxialField& field, Wavelength wavelength, Wavelength shorter,
                       Wavelength longer) {
  const ParaxialRays rays = paraxial_rays(lens, field, wavelength);
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    for (const AsphereTerm& term : lens.surfaces()[i].aspheric) {
      if (term.order == 3 && term.coefficient != 0) {
        throw Error(lens.name() + ": surface " + std::to_string(i) +
                    ": aspheric coefficient of order 3 = " + to_text(term.coefficient) + "; must be 0 for seidel_sums");
      }
    }
  }
  const double h = rays.invariant;
  const auto relative_dispersion = [&](std::size_t space, double n) {
    return (signed_index(lens, space, shorter) - signed_index(lens, space, longer)) / n;
  };
  SeidelSums result;
  result.surfaces.reserve(lens.surface_count());
  double n = signed_index(lens, 0, wavelength), u = rays.object_marginal_u, u_chief = rays.object_chief_u;
  double dispersion = relative_dispersion(0, n);
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const auto& [y, u_out, y_chief, u_chief_out] = rays.surfaces[i];
    const auto [c, fourth] = third_order_shape(lens.surfaces()[i]);
    const double n_out = signed_index(lens, i + 1, wavelength), dispersion_out = relative_dispersion(i + 1, n_out);
    const double a = n * (y * c + u), a_chief = n * (y_chief * c + u_chief);
    const double bend = u_out / n_out - u / n, step = 1 / n_out - 1 / n;
    const double square_step = 1 / (n_out * n_out) - 1 / (n * n);
    const double asphere = 8 * fourth * (n_out - n) * y;  // times three heights
    SeidelTerms& t = result.surfaces.emplace_back();
    t.s1 = -a * a * y * bend + asphere * y * y * y;
    t.s2 = -a * a_chief * y * bend + asphere * y * y * y_chief;
    t.s3 = -a_chief * a_chief * y * bend + asphere * y * y_chief * y_chief;
    t.s4 = -h * h * c * step;
    // Abar / A (S3 + S4), without the division: A may be 0.
    t.s5 = -a_chief * (a_chief * a_chief * y * square_step + c * step * y_chief * (h - a_chief * y)) +
           asphere * y_chief * y_chief * y_chief;
    t.c1 = a * y * (dispersion_out - dispersion);
    t.c2 = a_chief * y * (dispersion_out - dispersion);
    for (double SeidelTerms::*term : {&SeidelTerms::s1, &SeidelTerms::s2, &SeidelTerms::s3, &SeidelTerms::s4,
                                      &SeidelTerms::s5, &SeidelTerms::c1, &SeidelTerms::c2}) {
      result.sums.*term += t.*term;
    }
    n = n_out, u = u_out, u_chief = u_chief_out, dispersion = dispersion_out;
  }
  return result;
}

}  // namespace petzval
