// SPDX-License-Identifier: Apache-2.0
#include "pupil_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "camera_loops.hpp"
#include "iris/iris_edges.hpp"
#include "make_model.hpp"
#include "paraxial_model.hpp"
#include "trace/stop_points.hpp"

namespace petzval::camera_detail {
namespace {

constexpr std::size_t block = 256;

/// The stop of a lens, for image-space rays.
struct RealStop {
  Lens lens;
  TwoPlanes space;
  double towards, semi_diameter;

  RealStop(const Lens& own, const TwoPlanes& planes)
      : lens(own),
        space(planes),
        towards(towards_scene(own, planes)),
        semi_diameter(own.surfaces()[*own.stop()].semi_diameter) {}

  /// Where at most `block` rays meet it, in semi-diameters.
  template <class T>
  void points(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths, T* x,
              T* y) const noexcept {
    alignas(64) std::array<std::array<T, block>, 6> v;
    const auto at = [&](std::size_t k) { return v[k].data(); };
    camera_loops().of<T>().start(space, static_cast<T>(towards), count, lines,
                                 {at(0), at(1), at(2), at(3), at(4), at(5)});
    trace_detail::stop_points<T>(lens, count, {at(0), at(1), at(2), at(3), at(4), at(5)}, x, y,
                                 {.travel = Travel::to_scene, .wavelengths = wavelengths});
    const T scale = static_cast<T>(1 / semi_diameter);
    for (std::size_t i = 0; i < count; ++i) x[i] *= scale, y[i] *= scale;
  }
};

/// Whether the plane of the pupil shows the stop upside down, along x and along y.
std::array<bool, 2> upside_down(const AnyRayModel& model, const std::optional<RealStop>& stop) {
  if (const auto* const first_order = model.as<ParaxialModel>(); first_order && !first_order->two_discs()) {
    return first_order->stop_upside_down();
  }
  if (!stop) return {false, false};
  const auto turned = [&](double u) {
    const PupilSample at = model.pupils().sample({}, u, 0.25);
    const double film = 0;
    Vec2<double> hit{0, 0};
    stop->points<double>(1, {&film, &film, &at.x, &at.y}, {}, &hit.x, &hit.y);
    return hit.x * at.x + hit.y * at.y < 0;
  };
  return {turned(0.25), turned(0)};
}

}  // namespace

struct PupilWeights::Data {
  FilmPupilTable pupils, whole;
  std::optional<RealStop> stop;  // none: weights act on pupils
  Vec2<double> sense;            // of the stop's axes in the frame of the weights
  std::optional<iris_detail::IrisWeights> weights;
  bool keep_light;  // that the rim which cuts the pupils takes

  /// Multiplies values with what makes up for the rim.
  template <class T>
  void brighten(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                T* values) const noexcept {
    if (!keep_light) return;
    for (std::size_t i = 0; i < count; ++i) {
      const FilmPoint film{lines.film_x[i], lines.film_y[i]};
      const double left = pupils.area(film, wavelengths.at(i));
      if (left > 0) values[i] *= static_cast<T>(whole.area(film, wavelengths.at(i)) / left);
    }
  }
};

PupilWeights::PupilWeights(const Lens& lens, const AnyRayModel& model, const BokehControls& controls) {
  const std::string where = lens.name() + ": camera: ";
  iris_detail::check(controls.weight_map, where);
  const FilmPupilTable& pupils = model.pupils();
  const bool keep_light = controls.keep_light && pupils.cut();
  if (controls.edge().even() && controls.weight_map.empty()) {
    if (keep_light) data_ = std::make_shared<const Data>(Data{pupils, pupils.whole(), {}, {1, 1}, {}, keep_light});
    return;
  }
  const ModelKind kind = model.kind();
  const bool custom = kind == ModelKind::custom, first_order = !custom && kind.is_first_order();
  std::optional<RealStop> stop;
  const bool has_rim = lens.stop() && std::isfinite(lens.surfaces()[*lens.stop()].semi_diameter);
  if (has_rim && !custom) stop.emplace(lens, model.pupils().space());
  // Samples begin at the first corner of a real stop's blades, wherever the pupil shows it; else at +y of the pupil.
  const auto* const closed = model.as<ParaxialModel>();
  const bool by_blades = !lens.iris().round() && !(closed && !closed->two_discs());
  const auto [along_x, along_y] = by_blades ? std::array{false, false} : upside_down(model, stop);
  const Iris iris = iris_detail::upside_down(lens.iris(), along_x, along_y);
  if (first_order) stop.reset();
  // Between the stop and its image, places are nearly alike; behind vignetted pupils they are not.
  const double uniform_part = stop ? 0.25 : 0;
  iris_detail::IrisWeights weights(
      iris, controls.edge(), iris_detail::upside_down(controls.weight_map, along_x, along_y), uniform_part, where);
  data_ = std::make_shared<const Data>(Data{pupils,
                                            pupils.whole(),
                                            std::move(stop),
                                            {along_x ? -1.0 : 1.0, along_y ? -1.0 : 1.0},
                                            std::move(weights),
                                            keep_light});
}

template <class T>
void PupilWeights::draw(std::size_t count, const T* u, const T* v, T* to_u, T* to_v, T* densities) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const auto drawn = draw(u[i], v[i]);
    to_u[i] = static_cast<T>(drawn.u), to_v[i] = static_cast<T>(drawn.v);
    densities[i] = static_cast<T>(drawn.density);
  }
}

PupilWeights::Drawn PupilWeights::drawn(double u, double v) const noexcept {
  return data_->weights ? data_->weights->draw(u, v) : Drawn{u, v, 1};
}

double PupilWeights::density(const Vec2<double>& sample) const noexcept {
  return data_->weights ? data_->weights->density(sample.x, sample.y) : 1;
}

template <class T>
void PupilWeights::of_samples(std::size_t count, const T* u, const T* v, const TwoPlaneRays<const T>& lines,
                              const RayWavelengths& wavelengths, T* weights) const noexcept {
  const Data& data = *data_;
  if (data.stop) {
    of_lines(count, lines, wavelengths, weights);
    return;
  }
  std::fill_n(weights, count, T(1));
  if (const auto& own = data.weights) {
    for (std::size_t i = 0; i < count; ++i) weights[i] = static_cast<T>(own->of_sample(u[i], v[i]));
  }
  data.brighten(count, lines, wavelengths, weights);
}

template <class T>
void PupilWeights::of_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                            T* weights) const noexcept {
  const Data& data = *data_;
  if (!data.stop) {
    std::fill_n(weights, count, T(1));
    for (std::size_t i = 0; data.weights && i < count; ++i) {
      const Vec2<double> at = data.pupils.position({lines.film_x[i], lines.film_y[i]}, lines.pupil_x[i],
                                                   lines.pupil_y[i], wavelengths.at(i));
      weights[i] = static_cast<T>(data.weights->of_sample(at.x, std::min(at.y, 1.0)));
    }
  } else {
    alignas(64) std::array<T, block> x, y;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      data.stop->points(n, lines.from(begin), wavelengths.from(begin), x.data(), y.data());
      for (std::size_t i = 0; i < n; ++i) {
        weights[begin + i] = static_cast<T>(data.weights->at({data.sense.x * x[i], data.sense.y * y[i]}));
      }
    }
  }
  data.brighten(count, lines, wavelengths, weights);
}

double PupilWeights::of_sample(double u, double v, const TwoPlaneRay& line, Wavelength wavelength) const noexcept {
  double weight = 0;
  of_samples<double>(1, &u, &v, {&line.film_x, &line.film_y, &line.pupil_x, &line.pupil_y}, {.all = wavelength},
                     &weight);
  return weight;
}

double PupilWeights::of_line(const TwoPlaneRay& line, Wavelength wavelength) const noexcept {
  double weight = 0;
  of_lines<double>(1, {&line.film_x, &line.film_y, &line.pupil_x, &line.pupil_y}, {.all = wavelength}, &weight);
  return weight;
}

#define PETZVAL_PUPIL_WEIGHTS(T)                                                                             \
  template void PupilWeights::draw(std::size_t, const T*, const T*, T*, T*, T*) const noexcept;              \
  template void PupilWeights::of_samples(std::size_t, const T*, const T*, const TwoPlaneRays<const T>&,      \
                                         const RayWavelengths&, T*) const noexcept;                          \
  template void PupilWeights::of_lines(std::size_t, const TwoPlaneRays<const T>&, const RayWavelengths&, T*) \
      const noexcept;
PETZVAL_PUPIL_WEIGHTS(float)
PETZVAL_PUPIL_WEIGHTS(double)
#undef PETZVAL_PUPIL_WEIGHTS

}  // namespace petzval::camera_detail
