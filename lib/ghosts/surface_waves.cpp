// SPDX-License-Identifier: Apache-2.0
#include "surface_waves.hpp"

#include <algorithm>
#include <cmath>

#include "lens/asphere_hit.hpp"
#include "petzval/core/error.hpp"
#include "trace/sequential.hpp"

namespace petzval::ghosts_detail {
namespace {

Vec cross(const Vec& a, const Vec& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vec unit(const Vec& a) noexcept { return a * (1 / std::sqrt(dot(a, a))); }

/// A unit vector perpendicular to a direction.
Vec across(const Vec& direction) noexcept {
  return unit(cross(direction, std::abs(direction.x) < 0.5 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
}

/// Turns the wave from one direction to the next and multiplies the fields of s and p.
void turn(const Vec& from, const Vec& to, const Vec& normal, double s, double p, Wave& wave) noexcept {
  const Vec plane = cross(from, normal);
  const Vec along_s = dot(plane, plane) > 1e-24 ? unit(plane) : across(from);
  const Vec p_from = cross(along_s, from), p_to = cross(along_s, to);
  for (Vec* field : {&wave.first, &wave.second}) {
    *field = along_s * (s * dot(*field, along_s)) + p_to * (p * dot(*field, p_from));
  }
}

}  // namespace

Wave Wave::along(const Vec& direction) noexcept {
  const Vec first = across(direction);
  return {first, cross(first, direction)};
}

Surfaces::Surfaces(const Lens& lens, Wavelength wavelength, double film_reflectance)
    : lens_(lens), view_(kernel::view<double>(lens_)), film_reflectance_(film_reflectance) {
  nm_ = wavelength.in_nm() ? *wavelength.in_nm() : lens.wavelengths_nm()[lens.wavelength_index(wavelength)];
  const std::size_t count = lens.surface_count();
  for (std::size_t i = 0; i <= count; ++i) {
    absorptions_.push_back(lens.absorption(i, wavelength));
    Row row;
    row.before = row.behind = lens.index(i, wavelength);
    if (i < count) {
      const LensSurface& own = lens.surfaces()[i];
      row.coating = own.coating.value_or(Coating{});
      row.reversed = own.mirror ? row.coating : reversed(row.coating);
      row.behind = lens.index(i + 1, wavelength);
      row.plain = row.coating == Coating{} && (own.mirror || row.before == row.behind);
    }
    rows_.push_back(std::move(row));
  }
}

RayFate Surfaces::meet(std::size_t surface, bool forward, const Vec& origin, const Vec& direction, bool apertures,
                       Contact& contact) const {
  const bool film = surface == count();
  const double vertex_z = film ? lens_.film_z() : view_.vertex_z[surface];
  const Vec start{origin.x, origin.y, origin.z - vertex_z};
  Vec at;
  bool described = true;
  if (film) {
    const double sense = lens_.light_direction(count());
    if (!(direction.z * sense > 0)) return RayFate::missed_surface;
    at = start - direction * (start.z / direction.z);
    contact.normal = {0, 0, 1};
  } else {
    const kernel::SurfaceTable<double>& table = view_.surfaces[surface];
    const double sense = forward || table.mirror ? table.sense : -table.sense;
    if (table.asphere < 0) {
      const auto hit = kernel::intersect(table.quadric, start, direction, sense);
      if (!hit.hit) return RayFate::missed_surface;
      at = hit.point;
      contact.normal = kernel::normal(table.quadric, at);
    } else {
      const kernel::Asphere<double>& asphere = view_.aspheres[table.asphere];
      const auto [point, hit, converged, past_rim] = kernel::intersect(asphere, start, direction, sense);
      if (!hit) return past_rim ? RayFate::vignetted : RayFate::missed_surface;
      at = point;
      contact.normal = kernel::normal(asphere, at);
      const double x = asphere.base.ax * at.x, y = asphere.base.ay * at.y;
      described = x * x + y * y <= asphere.rim2;
    }
    const double r2 = at.x * at.x + at.y * at.y;
    if (apertures && !(described && r2 <= table.semi_diameter_squared && r2 >= table.obscuration_squared)) {
      return RayFate::vignetted;
    }
    if (apertures && lens_.stop() == surface && !kernel::within(view_.iris, at.x, at.y)) return RayFate::vignetted;
  }
  contact.point = {at.x, at.y, at.z + vertex_z};
  contact.cosine = std::min(std::abs(dot(direction, contact.normal)), 1.0);
  contact.sign_p = -1;
  const Row& row = rows_[surface];
  if (film || row.plain) {
    const double reflected = film ? film_reflectance_ : mirror(surface) ? 1 : 0;
    contact.light = {reflected, reflected, 1 - reflected, 1 - reflected};
  } else {
    const double in = forward ? row.before : row.behind, out = forward ? row.behind : row.before;
    contact.light = surface_light(forward ? row.coating : row.reversed, in, out, contact.cosine, nm_);
    const bool past_brewster = contact.cosine * contact.cosine * (in * in + out * out) < in * in;
    if (row.coating == Coating{} && past_brewster) contact.sign_p = 1;
  }
  return RayFate::transmitted;
}

void Surfaces::reflect(const Contact& contact, Vec& direction, Wave& wave) noexcept {
  const Vec to = kernel::reflect(direction, contact.normal);
  const SurfaceLight& light = contact.light;
  turn(direction, to, contact.normal, std::sqrt(light.reflectance_s), contact.sign_p * std::sqrt(light.reflectance_p),
       wave);
  direction = to;
}

bool Surfaces::refract(std::size_t surface, bool forward, const Contact& contact, Vec& direction,
                       Wave& wave) const noexcept {
  const Row& row = rows_[surface];
  if (row.plain) return true;
  const double in = forward ? row.before : row.behind, out = forward ? row.behind : row.before;
  const auto [to, transmitted] = kernel::refract(direction, contact.normal, kernel::make_interface<double>(in, out));
  if (!transmitted) return false;
  const SurfaceLight& light = contact.light;
  turn(direction, to, contact.normal, std::sqrt(light.transmittance_s), std::sqrt(light.transmittance_p), wave);
  direction = to;
  return true;
}

double Surfaces::reflectance(std::size_t surface) const {
  if (surface == count()) return film_reflectance_;
  const Row& row = rows_[surface];
  if (mirror(surface) || row.plain) return 0;
  return surface_light(row.coating, row.before, row.behind, 1, nm_).reflectance();
}

std::optional<double> Surfaces::power(std::span<const lens_detail::Passage> path, Vec origin, Vec direction) const {
  Wave wave = Wave::along(direction);
  Contact contact;
  bool forward = true;
  double depth = 0;
  std::size_t space = 0;
  for (const auto& [surface, reflects] : path) {
    if (meet(surface, forward, origin, direction, false, contact) != RayFate::transmitted) return {};
    const Vec moved = contact.point - origin;
    if (&surface != &path.front().surface) depth += absorptions_[space] * std::sqrt(dot(moved, moved));
    origin = contact.point;
    if (reflects || mirror(surface)) {
      reflect(contact, direction, wave);
    } else if (!refract(surface, forward, contact, direction, wave)) {
      return {};
    }
    if (reflects) {
      forward = !forward;
    } else {
      space = forward ? surface + 1 : surface;
    }
  }
  return wave.power() * std::exp(-depth);
}

}  // namespace petzval::ghosts_detail
