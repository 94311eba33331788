// SPDX-License-Identifier: Apache-2.0
#include "pupil_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "iris/iris_edges.hpp"
#include "paraxial_model.hpp"

namespace petzval::camera_detail {
namespace {

constexpr std::size_t block = 256;

}  // namespace

struct PupilWeights::Data {
  FilmPupilTable pupils, unclipped;  // with the stop if weights act on the stop
  bool on_stop;                      // else weights act on the pupil of each film point
  std::optional<iris_detail::IrisWeights> weights;
  bool keep_light;  // compensate for the light that the rim takes

  /// Weights of any rays that pass.
  template <class T>
  void weigh(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
             T* values) const noexcept {
    if (on_stop) {
      alignas(64) std::array<T, block> x, y;
      for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t n = std::min(block, count - begin);
        pupils.stop_points(n, lines.from(begin), wavelengths.from(begin), x.data(), y.data());
        for (std::size_t i = 0; i < n; ++i) values[begin + i] = static_cast<T>(weights->at({x[i], y[i]}));
      }
      return;
    }
    std::fill_n(values, count, T(1));
    for (std::size_t i = 0; weights && i < count; ++i) {
      const Vec2<double> at =
          pupils.position({lines.film_x[i], lines.film_y[i]}, lines.pupil_x[i], lines.pupil_y[i], wavelengths.at(i));
      values[i] = static_cast<T>(weights->of_sample(at.x, std::min(at.y, 1.0)));
    }
  }
  /// Multiplies values by the compensation for the rim.
  template <class T>
  void brighten(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                T* values) const noexcept {
    if (!keep_light) return;
    for (std::size_t i = 0; i < count; ++i) {
      const FilmPoint film{lines.film_x[i], lines.film_y[i]};
      const double left = pupils.polygon_area(film, wavelengths.at(i));
      if (left > 0) values[i] *= static_cast<T>(unclipped.polygon_area(film, wavelengths.at(i)) / left);
    }
  }
};

PupilWeights::PupilWeights(const Lens& lens, const RayModel& model, const BokehControls& controls) {
  const std::string where = lens.name() + ": camera: ";
  iris_detail::check(controls.weight_map, where);
  FilmPupilTable pupils = model.pupils();
  const bool keep_light = controls.keep_light && pupils.is_clipped();
  if (controls.edge().even() && controls.weight_map.empty()) {
    if (keep_light) data_ = std::make_shared<const Data>(Data{pupils, pupils.unclipped(), false, {}, keep_light});
    return;
  }
  const bool traced = !model.kind().is_first_order();
  const bool has_rim = lens.stop() && std::isfinite(lens.surfaces()[*lens.stop()].semi_diameter);
  if (traced && has_rim && !pupils.knows_stop()) pupils = pupils.with_stop(lens);
  // Pupils in closed form are images of the stop.
  const ParaxialModel* const first_order = model.first_order();
  const auto [along_x, along_y] = first_order ? first_order->stop_upside_down() : std::array{false, false};
  // Positions in the stop and in its image are nearly equal, unless the pupil is vignetted.
  const double uniform_fraction = pupils.knows_stop() ? 0.25 : 0;
  iris_detail::IrisWeights weights(iris_detail::upside_down(lens.iris(), along_x, along_y), controls.edge(),
                                   iris_detail::upside_down(controls.weight_map, along_x, along_y), uniform_fraction,
                                   where);
  data_ = std::make_shared<const Data>(
      Data{pupils, pupils.unclipped(), pupils.knows_stop(), std::move(weights), keep_light});
}

std::optional<FilmPupilTable> PupilWeights::pupils() const {
  return data_ ? std::optional(data_->pupils) : std::nullopt;
}

template <class T>
void PupilWeights::draw(std::size_t count, const T* u, const T* v, T* to_u, T* to_v, T* densities) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const auto drawn = draw(u[i], v[i]);
    to_u[i] = static_cast<T>(drawn.u), to_v[i] = static_cast<T>(drawn.v);
    densities[i] = static_cast<T>(drawn.density);
  }
}

PupilWeights::IrisSample PupilWeights::drawn(double u, double v) const noexcept {
  return data_->weights ? data_->weights->draw(u, v) : IrisSample{u, v, 1};
}

double PupilWeights::density(const Vec2<double>& sample) const noexcept {
  return data_->weights ? data_->weights->density(sample.x, sample.y) : 1;
}

template <class T>
void PupilWeights::of_samples(std::size_t count, const T* u, const T* v, const TwoPlaneRays<const T>& lines,
                              const RayWavelengths& wavelengths, T* weights) const noexcept {
  const Data& data = *data_;
  std::array<double, block> scales;  // scale of the iris for samples of the iris; 0 for samples of a polygon
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    const auto lines_here = lines.from(begin);
    const auto wavelengths_here = wavelengths.from(begin);
    for (std::size_t i = 0; i < n; ++i) {
      const FilmPoint film{lines_here.film_x[i], lines_here.film_y[i]};
      scales[i] = data.on_stop ? data.pupils.sampled_iris_scale(film, wavelengths_here.at(i)) : 1;
    }
    const bool polygons = std::any_of(scales.begin(), scales.begin() + n, [](double scale) { return scale == 0; });
    if (polygons) data.weigh(n, lines_here, wavelengths_here, weights + begin);
    for (std::size_t i = 0; i < n; ++i) {
      // For samples of the iris, u and v determine the stop point; v is the fraction of the area nearer to the centre.
      const double area_fraction = std::min(v[begin + i] * scales[i] * scales[i], 1.0);
      if (!data.weights) {
        weights[begin + i] = T(1);
      } else if (scales[i] > 0) {
        weights[begin + i] = static_cast<T>(data.weights->of_sample(u[begin + i], area_fraction));
      }
    }
  }
  data.brighten(count, lines, wavelengths, weights);
}

template <class T>
void PupilWeights::of_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                            T* weights) const noexcept {
  data_->weigh(count, lines, wavelengths, weights);
  data_->brighten(count, lines, wavelengths, weights);
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
