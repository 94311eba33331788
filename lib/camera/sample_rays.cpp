// SPDX-License-Identifier: Apache-2.0
#include "sample_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "camera_loops.hpp"
#include "core/instruction_set.hpp"
#include "dual_rays.hpp"
#include "paraxial_model.hpp"

namespace petzval::camera_detail {
namespace {

using kernel::Dual;

constexpr std::size_t block = 256;
/// Number of lanes of the widest registers of any instruction set.
template <class T>
constexpr std::size_t lanes = 64 / sizeof(T);
/// Number of lanes of the widest registers of this processor, but at least 8: fewer rays are not traced on lanes.
template <class T>
std::size_t lanes_here() noexcept {
  static const bool widest = instruction_sets().back() == InstructionSet::avx512;
  return widest ? lanes<T> : 8;
}

template <class T>
using Values = std::array<T, block>;

template <class T>
TiltedBounds<T> bounds_of(const TiltedFilm& film, const T* times) noexcept {
  const TiltedPlane p = film.plane(0);
  const double travel = film.plane(1).travel;
  const auto number = [](double x) { return static_cast<T>(x); };
  return {number(p.x_by_x),  number(p.x_by_y),  number(p.y_by_y), number(p.depth_by_x), number(p.depth_by_y),
          number(p.slope_x), number(p.slope_y), number(p.cosine), number(travel),       travel != 0 ? times : nullptr};
}

/// The scale of each ray; 0 for a wavelength that is not covered.
template <class T>
void fill_scales(std::size_t count, const WavelengthFacts& facts, const RayWavelengths& wavelengths, T* scales) {
  if (wavelengths.shared()) {
    std::fill_n(scales, count, static_cast<T>(facts.scale(wavelengths.all)));
    return;
  }
  camera_loops().of<T>().look_up(facts.scale_rows<T>(), count, wavelengths, scales);
}

/// Finds points of the upright film whose chief rays equal the rays of a pinhole in front of a tilted film.
template <class T>
void find_chiefs(std::size_t count, const FilmView& view, const RayWavelengths& wavelengths, const T* excess,
                 const T* virtual_x, const T* virtual_y, T* film_x, T* film_y) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const double scale = chief_scale(double{excess[i]}, view.wavelengths.pinhole_shift(wavelengths.at(i)));
    film_x[i] = static_cast<T>(virtual_x[i] * scale), film_y[i] = static_cast<T>(virtual_y[i] * scale);
  }
}

/// Sets the fate of rays outside their pupils to vignetted.
template <class T>
void keep_within(std::size_t count, const FilmPupilTable& pupils, const TwoPlaneRays<const T>& lines,
                 const RayWavelengths& wavelengths, RayFate* fates) noexcept {
  std::array<std::uint8_t, block> within;
  pupils.contains(count, lines, wavelengths, within.data());
  for (std::size_t i = 0; i < count; ++i) fates[i] = within[i] ? fates[i] : RayFate::vignetted;
}

/// Multiplies the weights of the first `valid_count` rays by the weights of the stop positions, and their densities by
/// the densities of the drawn positions.
template <class T>
void weigh_pupil(const FilmView& view, std::size_t count, std::size_t valid_count, const T* u, const T* v,
                 const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths, const T* densities,
                 RayFate* fates, const CameraRays<T>& rays) noexcept {
  Values<T> weights;
  if (view.tilted && !view.model.pinhole()) {
    view.weights.of_lines(count, lines, wavelengths, weights.data());
  } else {
    view.weights.of_samples(count, u, v, lines, wavelengths, weights.data());
  }
  for (std::size_t i = 0; i < valid_count; ++i) {
    const bool lit = weights[i] > T(0);
    rays.weights[i] = lit ? rays.weights[i] * weights[i] / densities[i] : T(0);
    fates[i] = lit || fates[i] != RayFate::transmitted ? fates[i] : RayFate::vignetted;
    if (rays.pdf_pupil) rays.pdf_pupil[i] *= densities[i];
    if (rays.pdf_direction) rays.pdf_direction[i] *= densities[i];
  }
}

/// Samples one block. Only the first `valid_count` rays get weights.
/// @param n a multiple of the number of lanes, so that a ray has the same bits at every position
template <class T>
void sample_block(const FilmView& view, std::size_t n, std::size_t valid_count, const CameraSamples<T>& samples,
                  const CameraRays<T>& rays) noexcept {
  const auto& loops = camera_loops().of<T>();
  const FilmPupilTable& pupils = view.pupils;
  const FilmBounds<T> bounds = core_detail::bounds_of<T>(view.film);
  const TiltedFilm* const tilted = view.tilted;
  const RayWavelengths& wavelengths = samples.wavelengths;

  alignas(64) Values<T> film_x, film_y, x, y, areas, scales;
  std::array<RayFate, block> local_fates;
  RayFate* const fates = rays.fates ? rays.fates : local_fates.data();
  fill_scales(n, view.wavelengths, wavelengths, scales.data());
  const T *pupil_u = samples.pupil_u, *pupil_v = samples.pupil_v;
  alignas(64) Values<T> drawn_u, drawn_v, densities;
  if (view.weights) {
    view.weights.draw(n, pupil_u, pupil_v, drawn_u.data(), drawn_v.data(), densities.data());
    pupil_u = drawn_u.data(), pupil_v = drawn_v.data();
  }
  loops.keep_on_film(bounds, n, samples.film_x, samples.film_y, film_x.data(), film_y.data());

  // Lines in terms of the upright film, and the lines that leave the lens: they differ for a pinhole.
  TwoPlaneRays<const T> lines{film_x.data(), film_y.data(), x.data(), y.data()}, leaving = lines;
  alignas(64) Values<T> virtual_x, virtual_y, excess, upright_x, upright_y, chief_x, chief_y;
  if (!tilted) {
    pupils.sample(n, film_x.data(), film_y.data(), pupil_u, pupil_v, wavelengths, x.data(), y.data(), areas.data());
  } else {
    loops.to_virtual(bounds_of(*tilted, samples.times), n, film_x.data(), film_y.data(), virtual_x.data(),
                     virtual_y.data(), excess.data());
    tilted->pupils().sample(n, virtual_x.data(), virtual_y.data(), pupil_u, pupil_v, wavelengths, x.data(), y.data(),
                            areas.data());
    loops.to_upright(n, excess.data(), virtual_x.data(), virtual_y.data(), x.data(), y.data(), upright_x.data(),
                     upright_y.data());
    lines = leaving = {upright_x.data(), upright_y.data(), x.data(), y.data()};
    if (view.model.pinhole()) {
      find_chiefs(n, view, wavelengths, excess.data(), virtual_x.data(), virtual_y.data(), chief_x.data(),
                  chief_y.data());
      leaving = {chief_x.data(), chief_y.data(), x.data(), y.data()};
    }
  }

  alignas(64) Values<T> transmittances;
  view.model.to_scene(n, leaving, wavelengths, rays.rays, fates, view.transmission.light(), transmittances.data());
  if (view.focus) {
    view.focus.bend(n, film_x.data(), film_y.data(), tilted ? excess.data() : nullptr, wavelengths, rays.rays);
  }
  if (view.moves_rays()) {
    loops.move_to_front(static_cast<T>(view.front.vertex_z), static_cast<T>(view.front.curvature), n, rays.rays);
  }

  if (tilted && decide(pupils, view.model)) keep_within(n, pupils, lines, wavelengths, fates);
  loops.weigh(bounds, static_cast<T>(view.depth), valid_count, samples.film_x, samples.film_y, lines, areas.data(),
              scales.data(), fates, rays);
  if (view.weights)
    weigh_pupil(view, n, valid_count, pupil_u, pupil_v, lines, wavelengths, densities.data(), fates, rays);
  if (view.transmission) {
    view.transmission.fill(n, lines, wavelengths, transmittances.data());
    for (std::size_t i = 0; i < valid_count; ++i) {
      rays.weights[i] *= transmittances[i];
      const bool dark = fates[i] == RayFate::transmitted && !(rays.weights[i] > T(0));
      fates[i] = dark ? RayFate::vignetted : fates[i];
    }
  }
  if (tilted) {
    loops.weigh_tilted(bounds_of(*tilted, samples.times), valid_count, excess.data(), x.data(), y.data(), fates, rays);
  }
}

/// Samples fewer rays than lanes: pads them with copies of the last sample.
template <class T>
void sample_rest(const FilmView& view, std::size_t count, const CameraSamples<T>& samples,
                 const CameraRays<T>& rays) noexcept {
  alignas(64) std::array<std::array<T, lanes<T>>, 5> in;
  alignas(64) std::array<std::array<T, lanes<T>>, 9> out;
  std::array<std::uint16_t, lanes<T>> each;
  std::array<float, lanes<T>> each_nm;
  std::array<RayFate, lanes<T>> fates;
  const auto padded = [&](const auto* from, auto& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[std::min(i, count - 1)];
  };
  padded(samples.film_x, in[0]), padded(samples.film_y, in[1]);
  padded(samples.pupil_u, in[2]), padded(samples.pupil_v, in[3]);
  if (samples.times) padded(samples.times, in[4]);
  RayWavelengths wavelengths = samples.wavelengths;
  if (wavelengths.each) {
    padded(wavelengths.each, each);
    wavelengths.each = each.data();
  }
  if (wavelengths.each_nm) {
    padded(wavelengths.each_nm, each_nm);
    wavelengths.each_nm = each_nm.data();
  }
  const auto at = [&](std::size_t k) { return out[k].data(); };
  sample_block<T>(
      view, lanes_here<T>(), count,
      {in[0].data(), in[1].data(), in[2].data(), in[3].data(), wavelengths, samples.times ? in[4].data() : nullptr},
      {{at(0), at(1), at(2), at(3), at(4), at(5)},
       at(6),
       fates.data(),
       rays.pdf_pupil ? at(7) : nullptr,
       rays.pdf_direction ? at(8) : nullptr});
  T* const to[] = {rays.rays.x,  rays.rays.y,  rays.rays.z,    rays.rays.dx,      rays.rays.dy,
                   rays.rays.dz, rays.weights, rays.pdf_pupil, rays.pdf_direction};
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (to[k]) std::copy_n(out[k].begin(), count, to[k]);
  }
  if (rays.fates) std::copy_n(fates.begin(), count, rays.fates);
}

}  // namespace

WavelengthFacts::WavelengthFacts(const RayModel& model, std::vector<double> scale, std::span<const double> nm)
    : primary_(model.pupils().primary_wavelength()), scale_(std::move(scale)) {
  if (const auto* const first_order = model.first_order()) {
    shifts_.assign(first_order->pinhole_shifts().begin(), first_order->pinhole_shifts().end());
  }
  shifts_.resize(scale_.size());
  const auto between = [&](const std::vector<double>& of) -> lens_detail::BetweenWavelengths<1> {
    std::vector<std::array<double, 1>> values;
    for (const double value : of) values.push_back({value});
    return {nm.empty() ? lens_detail::CompiledWavelengths() : lens_detail::CompiledWavelengths(nm), values};
  };
  between_scales_ = between(scale_);
  between_shifts_ = between(shifts_);
}

bool WavelengthFacts::covers(Wavelength wavelength) const noexcept {
  const auto nm = wavelength.in_nm();
  return nm ? between_scales_.covers(*nm) : wavelength.index(primary_) < count();
}

double WavelengthFacts::scale_between(Wavelength wavelength) const noexcept {
  const auto nm = wavelength.in_nm();
  return nm && between_scales_.covers(*nm) ? between_scales_(*nm)[0] : 0;
}

double WavelengthFacts::pinhole_shift(Wavelength wavelength) const noexcept {
  if (!covers(wavelength)) return 0;
  const auto nm = wavelength.in_nm();
  return nm ? between_shifts_(*nm)[0] : shifts_[wavelength.index(primary_)];
}

template <class T>
void sample_rays(const FilmView& view, std::size_t count, const CameraSamples<T>& given,
                 const CameraRays<T>& rays) noexcept {
  CameraSamples<T> samples = given;
  samples.wavelengths = given.wavelengths.resolved(view.model.pupils().primary_wavelength());
  const std::size_t whole = count - count % lanes_here<T>();
  for (std::size_t begin = 0; begin < whole; begin += block) {
    const std::size_t n = std::min(block, whole - begin);
    sample_block(view, n, n, samples.from(begin), rays.from(begin));
  }
  if (whole < count) sample_rest(view, count - whole, samples.from(whole), rays.from(whole));
}

template PETZVAL_API void sample_rays(const FilmView&, std::size_t, const CameraSamples<float>&,
                                      const CameraRays<float>&) noexcept;
template PETZVAL_API void sample_rays(const FilmView&, std::size_t, const CameraSamples<double>&,
                                      const CameraRays<double>&) noexcept;

namespace {

/// A sample of the film before its ray is known, over a scalar: double, or a dual number with respect to film x and y.
template <class V>
struct Start {
  bool kept = false;  ///< true if the point is on the film; otherwise `film` is its centre
  FilmPoint film;
  PupilWeights::IrisSample drawn{};
  double area = 0;
  TwoPlaneRay line;          ///< for the weight
  TwoPlaneRayOf<V> leaving;  ///< for the ray; differs from `line` for a pinhole
  V excess{};                ///< distance_excess() of a tilted film
  TiltedPlane plane{};       ///< of a tilted film
};

double value_of(double x) noexcept { return x; }
double value_of(const Dual& x) noexcept { return x.a; }
template <class V>
TwoPlaneRay value_of(const TwoPlaneRayOf<V>& line) noexcept {
  return {value_of(line.film_x), value_of(line.film_y), value_of(line.pupil_x), value_of(line.pupil_y)};
}

/// The position of a sample in the pupil of a film point.
/// @param area receives the area of the sample
PlanePoint<double> in_pupil(const FilmPupilTable& pupils, const PlanePoint<double>& film,
                            const PupilWeights::IrisSample& drawn, Wavelength wavelength, double& area) noexcept {
  const PupilSample at = pupils.sample({film.x, film.y}, drawn.u, drawn.v, wavelength);
  area = at.area;
  return {at.x, at.y};
}
PlanePoint<Dual> in_pupil(const FilmPupilTable& pupils, const PlanePoint<Dual>& film,
                          const PupilWeights::IrisSample& drawn, Wavelength wavelength, double& area) noexcept {
  FilmPupilTable::Derivatives by;
  const PupilSample at = pupils.sample({film.x.a, film.y.a}, drawn.u, drawn.v, wavelength, by);
  const auto& [by_x, by_y] = by;
  area = at.area;
  return {{at.x, by_x.x * film.x.v + by_y.x * film.y.v}, {at.y, by_x.y * film.x.v + by_y.y * film.y.v}};
}

template <class V>
Start<V> start(const FilmView& view, const FilmPoint& film, double u, double v, Wavelength wavelength,
               double time) noexcept {
  const bool kept = on_film(view.bounds, film.x, film.y);
  const auto drawn = view.weights.draw(u, v);
  // x and y are copied one at a time: a load of both numbers would stall if they were stored separately just before.
  const double x = kept ? film.x : view.bounds.centre_x, y = kept ? film.y : view.bounds.centre_y;
  PlanePoint<V> point{V(x), V(y)};
  if constexpr (std::is_same_v<V, Dual>) point = {Dual(x, 0), Dual(y, 1)};
  double area = 0;
  if (!view.tilted) {
    const PlanePoint<V> at = in_pupil(view.pupils, point, drawn, wavelength, area);
    const TwoPlaneRayOf<V> line{point.x, point.y, at.x, at.y};
    return {kept, {x, y}, drawn, area, value_of(line), line};
  }
  const TiltedPlane plane = view.tilted->plane(time);
  point = virtual_of(plane, point.x, point.y);
  const V excess = distance_excess(plane, point.x, point.y);
  const PlanePoint<V> at = in_pupil(view.tilted->pupils(), point, drawn, wavelength, area);
  TwoPlaneRayOf<V> leaving = upright_of(excess, point.x, point.y, at.x, at.y);
  const TwoPlaneRay line = value_of(leaving);
  if (view.model.pinhole()) {
    const V scale = chief_scale(excess, view.wavelengths.pinhole_shift(wavelength));
    leaving.film_x = point.x * scale, leaving.film_y = point.y * scale;
  }
  return {kept, {x, y}, drawn, area, line, leaving, excess, plane};
}

/// Sets weight, densities and fate of a sample.
/// @param front moves the ray to this front; null if the ray starts at the front
/// @param transmittance of an exact ray
template <class V>
void weigh(const FilmView& view, const Start<V>& s, Wavelength wavelength, const Front* front, double transmittance,
           CameraRay& out) noexcept {
  const TwoPlaneRay& line = s.line;
  const bool decides = view.tilted && decide(view.pupils, view.model);
  if (decides && !view.pupils.contains({line.film_x, line.film_y}, line.pupil_x, line.pupil_y, wavelength)) {
    out.fate = RayFate::vignetted;
  }
  const double scale = view.wavelengths.scale(wavelength);
  out.fate = fate_of(out.fate, s.kept, scale > 0, s.area > 0);
  camera_loops().weigh_one(front, view.depth, line, s.area, scale, out);
  if (!(s.kept && s.area > 0)) out.pdf_pupil = out.pdf_direction = 0;
  if (view.weights) {
    const bool of_line = view.tilted && !view.model.pinhole();
    const double weight = out.fate != RayFate::transmitted ? 0
                          : of_line                        ? view.weights.of_line(line, wavelength)
                                    : view.weights.of_sample(s.drawn.u, s.drawn.v, line, wavelength);
    out.weight *= weight / s.drawn.density;
    out.pdf_pupil *= s.drawn.density, out.pdf_direction *= s.drawn.density;
    if (!(weight > 0) && out.fate == RayFate::transmitted) out.fate = RayFate::vignetted;
  }
  if (view.transmission && out.fate == RayFate::transmitted) {
    const auto& [x, y, u, v] = line;
    view.transmission.fill<double>(1, {&x, &y, &u, &v}, {.all = wavelength}, &transmittance);
    out.weight *= transmittance;
    if (!(out.weight > 0)) out.fate = RayFate::vignetted;
  }
  if (view.tilted) {
    const double near = 1 + value_of(s.excess);
    const double facing = facing_of(s.plane, value_of(s.excess), line.pupil_x, line.pupil_y);
    out.weight *= facing;
    out.pdf_direction /= near * near;
    if (!(facing > 0) && out.fate == RayFate::transmitted) out.fate = RayFate::vignetted;
  }
  if (out.fate != RayFate::transmitted) out.weight = 0;
}

}  // namespace

CameraRay sample_ray(const FilmView& view, const FilmPoint& film, double u, double v, Wavelength wavelength,
                     double time) noexcept {
  const auto s = start<double>(view, film, u, v, wavelength, time);
  CameraRay out;
  double transmittance = 1;
  out.fate = view.model.to_scene(s.leaving, wavelength, out.ray, view.transmission.light(), &transmittance);
  if (view.focus) view.focus.bend(s.film, s.excess, wavelength, out.ray);
  weigh(view, s, wavelength, view.moves_rays() ? &view.front : nullptr, transmittance, out);
  return out;
}

CameraRayDifferential sample_differential(const FilmView& view, const FilmPoint& film, double u, double v,
                                          Wavelength wavelength, double time) noexcept {
  const auto s = start<Dual>(view, film, u, v, wavelength, time);
  CameraRayDifferential result;
  RayOf<Dual> ray = view.model.to_scene(s.leaving, wavelength, result.sample.fate);
  if (view.focus) view.focus.bend(s.film, s.excess, wavelength, ray);
  if (view.moves_rays()) move_to_front(view.front.vertex_z, view.front.curvature, ray);
  result.sample.ray = ray_of(ray, value_only);
  double transmittance = 1;
  if (view.transmission) {  // derivatives do not change the light
    Ray<double> same;
    view.model.to_scene(value_of(s.leaving), wavelength, same, view.transmission.light(), &transmittance);
  }
  weigh(view, s, wavelength, nullptr, transmittance, result.sample);
  if (!result.sample) return result;
  result.by_film_x = ray_of(ray, by_first);
  result.by_film_y = ray_of(ray, by_second);
  return result;
}

}  // namespace petzval::camera_detail
