// SPDX-License-Identifier: Apache-2.0
#include "petzval/paraxial/first_order.hpp"
#include "paraxial/ray_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A surface at its vertex, with the signed indices on both sides.
struct VertexSurface {
  double n_in, n_out, curvature;

  double power() const noexcept { return (n_out - n_in) * curvature; }
  RayMatrix matrix() const noexcept { return {1, 0, -power(), 1}; }
};

double vertex_curvature(const LensSurface& surface, Meridian meridian) noexcept {
  if (surface.curved_in == (meridian == Meridian::y ? Section::x : Section::y)) return 0;
  double curvature = surface.curvature;
  for (const auto& [order, coefficient] : surface.aspheric) {
    if (order == 2) curvature += 2 * coefficient;
  }
  return curvature;
}

VertexSurface at_vertex(const Lens& lens, std::size_t i, Wavelength wavelength, Meridian meridian) {
  return {signed_index(lens, i, wavelength), signed_index(lens, i + 1, wavelength),
          vertex_curvature(lens.surfaces()[i], meridian)};
}

/// Transfer from the vertex of the previous surface to the vertex of surface i, in a medium of index n.
RayMatrix transfer_to(const Lens& lens, std::size_t i, double n) noexcept {
  return {1, lens.surfaces()[i - 1].thickness / n, 0, 1};
}

}  // namespace

double signed_index(const Lens& lens, std::size_t space, Wavelength wavelength) {
  return lens.light_direction(space) * lens.index(space, wavelength);
}

RayMatrix ray_matrix(const Lens& lens, std::size_t first, std::size_t last, Wavelength wavelength, Meridian meridian) {
  last = std::min(last, lens.surface_count());
  RayMatrix m;
  for (std::size_t i = first; i < last; ++i) {
    const VertexSurface s = at_vertex(lens, i, wavelength, meridian);
    if (i > first) m = m.then(transfer_to(lens, i, s.n_in));
    m = m.then(s.matrix());
  }
  return m;
}

RayMatrix ray_matrix_to(const Lens& lens, std::size_t surface, Wavelength wavelength, Meridian meridian) {
  if (surface == 0) return {};
  return ray_matrix(lens, 0, surface, wavelength, meridian)
      .then(transfer_to(lens, surface, signed_index(lens, surface, wavelength)));
}

std::vector<RayMatrix> ray_matrices_to(const Lens& lens, Wavelength wavelength, Meridian meridian) {
  std::vector<RayMatrix> result;
  result.reserve(lens.surface_count());
  RayMatrix m;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const VertexSurface s = at_vertex(lens, i, wavelength, meridian);
    if (i > 0) m = m.then(transfer_to(lens, i, s.n_in));
    result.push_back(m);
    m = m.then(s.matrix());
  }
  return result;
}

FirstOrder first_order(const Lens& lens, Wavelength wavelength, Meridian meridian) {
  const std::size_t count = lens.surface_count();
  FirstOrder result;
  RayMatrix m;
  double contributions = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const VertexSurface s = at_vertex(lens, i, wavelength, meridian);
    if (i > 0) m = m.then(transfer_to(lens, i, s.n_in));
    contributions += std::abs(m.a * s.power());
    result.petzval_sum += s.power() / (s.n_in * s.n_out);
    m = m.then(s.matrix());
  }
  const double n = result.object_index = signed_index(lens, 0, wavelength);
  const double n_image = result.image_index = signed_index(lens, count, wavelength);

  // A focal length beyond 1e100 mm counts as infinite; so does the focal length of a matrix outside the range of
  // double.
  const bool in_range = std::isfinite(m.a) && std::isfinite(m.b) && std::isfinite(m.c) && std::isfinite(m.d);
  result.afocal = !(in_range && std::abs(m.c) > std::max(1e-12 * contributions, 1e-100));
  if (result.afocal) {
    result.effective_focal_length = infinity;
    result.front_focal_z = result.front_principal_z = result.front_nodal_z = result.front_focal_distance = -infinity;
    result.rear_focal_z = result.rear_principal_z = result.rear_nodal_z = result.back_focal_distance = infinity;
    return result;
  }
  const double front_z = lens.surfaces().front().vertex_z;
  const double rear_z = lens.surfaces().back().vertex_z;
  result.power = m.power();
  result.effective_focal_length = 1 / result.power;
  // A ray that leaves parallel to the axis has c y + d n u = 0 at the first vertex; a ray that enters parallel leaves
  // with (a, c) y.
  result.front_focal_distance = n * m.d / m.c;
  result.back_focal_distance = -n_image * m.a / m.c;
  result.front_focal_z = front_z + result.front_focal_distance;
  result.rear_focal_z = rear_z + result.back_focal_distance;
  result.front_principal_z = front_z + n * (m.d - 1) / m.c;
  result.rear_principal_z = rear_z + n_image * (1 - m.a) / m.c;
  // The distance from a focal point to the nodal point on the same side is the focal length of the other side.
  result.front_nodal_z = front_z + (n * m.d - n_image) / m.c;
  result.rear_nodal_z = rear_z + (n - n_image * m.a) / m.c;
  return result;
}

double squeeze(const Lens& lens, Wavelength wavelength) {
  return std::abs(first_order(lens, wavelength, Meridian::y).effective_focal_length /
                  first_order(lens, wavelength, Meridian::x).effective_focal_length);
}

Meridian main_meridian(const Lens& lens, Wavelength wavelength) {
  const bool only_x = !lens.rotationally_symmetric() && first_order(lens, wavelength, Meridian::y).afocal &&
                      !first_order(lens, wavelength, Meridian::x).afocal;
  return only_x ? Meridian::x : Meridian::y;
}

double paraxial_image_z(const Lens& lens, double object_z, Wavelength wavelength, Meridian meridian) {
  const FirstOrder data = first_order(lens, wavelength, meridian);
  RayMatrix m = ray_matrix(lens, 0, lens.surface_count(), wavelength, meridian);
  if (data.afocal) m.c = 0;

  // At the first vertex, the ray from the object at distance l with n u = q has the height y = p = -q l / n.
  const double l = object_z - lens.surfaces().front().vertex_z;
  const bool distant = std::abs(l) > 1e100;
  const double p = distant ? 1 : -l / data.object_index;
  const double q = distant ? 0 : 1;
  const double y = m.a * p + m.b * q;
  const double nu = m.c * p + m.d * q;
  // If the object lies within rounding of the front focal point, its image is at infinity.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * (std::abs(m.c * p) + std::abs(m.d * q));
  if (std::abs(nu) <= rounding) return infinity;
  return lens.surfaces().back().vertex_z - data.image_index * y / nu;
}

double lensmaker_focal_length(double n, double c1, double c2, double thickness) noexcept {
  const double power = (n - 1) * (c1 - c2 + (n - 1) * thickness * c1 * c2 / n);
  return power == 0 ? infinity : 1 / power;
}

}  // namespace petzval
