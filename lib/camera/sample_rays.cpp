// SPDX-License-Identifier: Apache-2.0
#include "sample_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "camera_loops.hpp"
#include "tilted_pinhole.hpp"

namespace petzval::inline v0::camera_detail {
namespace {

constexpr std::size_t block = 256;

template <class T>
using Values = std::array<T, block>;

template <class T>
TiltedBounds<T> bounds_of(const TiltedFilm& film) noexcept {
  const TiltedPlane& p = film.plane();
  const auto number = [](double x) { return static_cast<T>(x); };
  return {number(p.x_by_x),     number(p.x_by_y),  number(p.y_by_y),  number(p.depth_by_x),
          number(p.depth_by_y), number(p.slope_x), number(p.slope_y), number(p.cosine)};
}

/// The scale of each ray; 0 for a wavelength that the model does not have.
template <class T>
void fill_scales(std::size_t count, std::span<const double> scale, const RayWavelengths& wavelengths, T* scales) {
  const auto scale_of = [&](std::size_t w) { return w < scale.size() ? static_cast<T>(scale[w]) : T(0); };
  if (!wavelengths.each) {
    std::fill_n(scales, count, scale_of(wavelengths.all.position(0)));
    return;
  }
  for (std::size_t i = 0; i < count; ++i) scales[i] = scale_of(wavelengths.each[i]);
}

/// The points of the upright film whose rays through the middles of their pupils are those of a pinhole in front of a
/// tilted film.
template <class T>
void find_chiefs(std::size_t count, const FilmView& view, const RayWavelengths& wavelengths, const T* virtual_x,
                 const T* virtual_y, T* film_x, T* film_y) noexcept {
  const std::span<const double> shifts = view.model.pinhole_shifts();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t w = wavelengths.position(i, 0);
    const double shift = w < shifts.size() ? shifts[w] : 0;
    const double part = part_of_virtual(view.tilted->plane(), {virtual_x[i], virtual_y[i]}, shift);
    film_x[i] = static_cast<T>(virtual_x[i] * part), film_y[i] = static_cast<T>(virtual_y[i] * part);
  }
}

/// Rays beside a model's pupils become vignetted.
template <class T>
void keep_within(std::size_t count, const FilmPupilTable& pupils, const TwoPlaneRays<const T>& lines,
                 const RayWavelengths& wavelengths, RayFate* fates) noexcept {
  std::array<std::uint8_t, block> within;
  pupils.contains(count, lines, wavelengths, within.data());
  for (std::size_t i = 0; i < count; ++i) fates[i] = within[i] ? fates[i] : RayFate::vignetted;
}

}  // namespace

template <class T>
void sample_rays(const FilmView& view, std::size_t count, const CameraSamples<T>& given,
                 const CameraRays<T>& out) noexcept {
  const auto& loops = camera_loops().of<T>();
  const FilmPupilTable& pupils = view.model.pupils();
  const FilmBounds<T> bounds = film_detail::bounds_of<T>(view.film);
  const T depth = static_cast<T>(pupils.space().depth());
  const TiltedFilm* const tilted = view.tilted;
  const TiltedBounds<T> tilted_bounds = tilted ? bounds_of<T>(*tilted) : TiltedBounds<T>{};
  const bool pinhole = tilted && view.model.pinhole(), clips = view.model.clips_at_apertures();
  CameraSamples<T> samples = given;
  samples.wavelengths = given.wavelengths.resolved(pupils.primary_wavelength());

  alignas(64) Values<T> virtual_x, virtual_y, film_x, film_y, x, y, areas, scales;
  std::array<RayFate, block> local_fates;
  if (!samples.wavelengths.each) fill_scales(std::min(block, count), view.scale, samples.wavelengths, scales.data());
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    const CameraSamples<T> some = samples.from(begin);
    const CameraRays<T> rays = out.from(begin);
    RayFate* const fates = rays.fates ? rays.fates : local_fates.data();
    const TwoPlaneRays<const T> lines{film_x.data(), film_y.data(), x.data(), y.data()};
    if (samples.wavelengths.each) fill_scales(n, view.scale, some.wavelengths, scales.data());

    loops.keep_on_film(bounds, n, some.film_x, some.film_y, film_x.data(), film_y.data());
    if (!tilted) {
      pupils.sample(n, film_x.data(), film_y.data(), some.pupil_u, some.pupil_v, some.wavelengths, x.data(), y.data(),
                    areas.data());
      view.model.to_scene(n, lines, some.wavelengths, rays.rays, fates);
    } else {
      loops.to_virtual(tilted_bounds, n, film_x.data(), film_y.data(), virtual_x.data(), virtual_y.data());
      tilted->pupils().sample(n, virtual_x.data(), virtual_y.data(), some.pupil_u, some.pupil_v, some.wavelengths,
                              x.data(), y.data(), areas.data());
      if (pinhole) {
        find_chiefs(n, view, some.wavelengths, virtual_x.data(), virtual_y.data(), film_x.data(), film_y.data());
        view.model.to_scene(n, lines, some.wavelengths, rays.rays, fates);
      }
      loops.to_upright(tilted_bounds, n, virtual_x.data(), virtual_y.data(), x.data(), y.data(), film_x.data(),
                       film_y.data());
      if (!pinhole) view.model.to_scene(n, lines, some.wavelengths, rays.rays, fates);
      if (!clips) keep_within(n, pupils, lines, some.wavelengths, fates);
    }
    loops.weigh(bounds, depth, n, some.film_x, some.film_y, lines, areas.data(), scales.data(), fates, rays);
    if (tilted) {
      loops.weigh_tilted(tilted_bounds, n, virtual_x.data(), virtual_y.data(), x.data(), y.data(), fates, rays);
    }
  }
}

template PETZVAL_API void sample_rays(const FilmView&, std::size_t, const CameraSamples<float>&,
                                      const CameraRays<float>&) noexcept;
template PETZVAL_API void sample_rays(const FilmView&, std::size_t, const CameraSamples<double>&,
                                      const CameraRays<double>&) noexcept;

CameraRay sample_ray(const FilmView& view, const FilmPoint& film, double u, double v, std::size_t wavelength) noexcept {
  const FilmPupilTable& pupils = view.model.pupils();
  const TiltedFilm* const tilted = view.tilted;
  const auto bounds = film_detail::bounds_of<double>(view.film);
  const bool kept = std::abs(film.x - bounds.centre_x) <= bounds.half_width &&
                    std::abs(film.y - bounds.centre_y) <= bounds.half_height;
  const bool known = wavelength < view.scale.size();
  const FilmPoint point = kept ? film : FilmPoint{bounds.centre_x, bounds.centre_y};
  CameraRay out;

  // The line for the weight, and that of the ray.
  FilmPoint virtual_point;
  TwoPlaneRay line;
  double area = 0;
  if (!tilted) {
    const PupilSample at = pupils.sample(point, u, v, wavelength);
    line = {point.x, point.y, at.x, at.y};
    area = at.area;
    out.fate = view.model.to_scene(line, wavelength, out.ray);
  } else {
    virtual_point = tilted->virtual_point(point);
    const PupilSample at = tilted->pupils().sample(virtual_point, u, v, wavelength);
    line = tilted->upright(virtual_point, at.x, at.y);
    area = at.area;
    TwoPlaneRay leaving = line;
    if (view.model.pinhole()) {
      const double shift = known ? view.model.pinhole_shifts()[wavelength] : 0;
      const double part = part_of_virtual(tilted->plane(), virtual_point, shift);
      leaving.film_x = virtual_point.x * part, leaving.film_y = virtual_point.y * part;
    }
    out.fate = view.model.to_scene(leaving, wavelength, out.ray);
    const bool within = view.model.clips_at_apertures() ||
                        pupils.contains({line.film_x, line.film_y}, line.pupil_x, line.pupil_y, wavelength);
    if (!within) out.fate = RayFate::vignetted;
  }

  if (!(area > 0)) out.fate = RayFate::vignetted;
  if (!(known && view.scale[wavelength] > 0)) out.fate = RayFate::invalid;
  if (!kept) out.fate = RayFate::outside_film;
  if (kept && area > 0) {
    const double x = line.pupil_x - line.film_x, y = line.pupil_y - line.film_y, depth = pupils.space().depth();
    const double depth2 = depth * depth, length2 = x * x + y * y + depth2, per_length2 = 1 / length2;
    out.pdf_pupil = 1 / area;
    out.pdf_direction = length2 * std::sqrt(length2) / (std::abs(depth) * area);
    if (out.fate == RayFate::transmitted) {
      out.weight = view.scale[wavelength] * area * depth2 * per_length2 * per_length2;
    }
  }
  if (tilted) {
    const double near = tilted->nearness(virtual_point);
    const double facing = tilted->weight(virtual_point, line.pupil_x, line.pupil_y);
    out.weight *= facing;
    out.pdf_direction /= near * near;
    if (!(facing > 0) && out.fate == RayFate::transmitted) out.fate = RayFate::vignetted;
  }
  return out;
}

}  // namespace petzval::inline v0::camera_detail
