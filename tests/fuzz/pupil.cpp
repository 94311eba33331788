// SPDX-License-Identifier: Apache-2.0
// Any lens: rays aimed at the stop, boundaries of pupils, the light on the film.
#include "pupil/pupil_boundary.hpp"

#include "laws.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"
#include "wild_lens.hpp"

namespace {

using namespace petzval;

constexpr double pi = std::numbers::pi;

FieldPoint wild_field(fuzz::Bytes& bytes) {
  const double z = bytes.one_in(2) ? -HUGE_VAL : bytes.number(-1e4, -1);
  return {bytes.number(-1, 1), z, bytes.number(-3, 3)};
}

void aimed(const Lens& lens, fuzz::Bytes& bytes) {
  const FieldPoint field = wild_field(bytes);
  const AimedRay ray = aim(lens, field, {bytes.number(-1, 1), bytes.number(-1, 1)});
  if (!ray) return;
  fuzz::require(fuzz::finite(ray.ray) && fuzz::unit(ray.ray.direction, 1e-12), "an aimed ray has unit length");
  fuzz::require(fuzz::finite(ray.end.ray), "the end of an aimed ray is finite");
  const double rim = lens.surfaces()[pupils(lens).stop].semi_diameter;
  fuzz::require(ray.residual < 1e-3 || ray.residual * rim < 1e-6, "an aimed ray meets its target on the stop");
}

void boundary(const Lens& lens, const PupilBoundary& found, fuzz::Bytes& bytes) {
  fuzz::require(std::isfinite(found.area()) && found.area() >= 0, "the area of a pupil is finite and not negative");
  for (const PupilSpan& span : found.spans) {
    fuzz::require(span.from_radius <= span.to_radius, "the end of a span is not inside its start");
    const Ray<double> ray = found.plane.ray(span.to.x, span.to.y);
    // Limits (README): rays start within 1e9 mm.
    if (!(std::hypot(span.to.x, span.to.y) < 1e9)) continue;
    fuzz::require(trace(lens, ray, {.travel = found.plane.travel()}).transmitted(),
                  "a ray to the end of a span passes");
  }
  const PupilSampler sampler(found);
  if (sampler.empty()) return;
  const double u = bytes.between(0, 0.9999), v = bytes.between(0, 0.9999);
  const Vec2<double> p = sampler(u, v);
  fuzz::require(std::isfinite(p.x) && std::isfinite(p.y), "a sample of a pupil is finite");
}

void light(const Lens& lens, const FilmPoint& film) {
  const double irradiance = film_irradiance(lens, film), n = lens.index(lens.surface_count());
  fuzz::require(irradiance >= 0 && irradiance <= 1.001 * pi * n * n,
                "irradiance is at most the irradiance of a half space");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const int work = bytes.byte();
    const Lens lens = fuzz::wild_lens(bytes);
    if (work < 128) return aimed(lens, bytes);
    const FilmPoint film{bytes.number(-20, 20), bytes.number(-20, 20)};
    if (work < 192) return boundary(lens, pupil_boundary(lens, wild_field(bytes), {}, 5), bytes);
    if (work < 248) return boundary(lens, exit_pupil_boundary(lens, film, {}, 5), bytes);
    light(lens, film);
  });
  return 0;
}
