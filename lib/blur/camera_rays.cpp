// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "petzval/blur/lens_rays.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "ray_table.hpp"

namespace petzval {
namespace {

using namespace blur_detail;

constexpr int light_points = 128, light_cells = 48;  // of light_table()

/// The rays of one film point.
class Bundle {
 public:
  Bundle(const Camera& camera, const FilmPoint& film, std::span<const PupilPoint> points, Wavelength wavelength)
      : film_x_(points.size(), film.x), film_y_(points.size(), film.y), weights_(points.size()) {
    for (const PupilPoint& p : points) u_.push_back(p.u), v_.push_back(p.v);
    for (std::vector<double>& numbers : rays_) numbers.resize(points.size());
    camera.sample<double>(
        points.size(), {film_x_.data(), film_y_.data(), u_.data(), v_.data(), {wavelength}, nullptr},
        {{rays_[0].data(), rays_[1].data(), rays_[2].data(), rays_[3].data(), rays_[4].data(), rays_[5].data()},
         weights_.data()});
  }

  double weight(std::size_t i) const noexcept { return weights_[i]; }
  Ray<double> ray(std::size_t i) const noexcept {
    return {{rays_[0][i], rays_[1][i], rays_[2][i]}, {rays_[3][i], rays_[4][i], rays_[5][i]}};
  }

 private:
  std::vector<double> film_x_, film_y_, u_, v_, rays_[6], weights_;
};

/// Converts the rays of a camera to lines through layers.
class RaysOfCamera {
 public:
  RaysOfCamera(const Camera& camera, const LayerCamera& layers, std::span<const Wavelength> wavelengths,
               const LensRaysOptions& options)
      : camera_(camera),
        layers_(layers),
        origin_z_(layer_origin_z(camera)),
        wavelengths_(wavelengths.begin(), wavelengths.end()) {
    if (camera.model().is_exact()) light_ = light_table(options);
  }

  void operator()(int channel, const Vec2<double>& raster, std::span<const PupilPoint> points,
                  std::span<LayerRay> found) const {
    const FilmPoint film = film_point(raster);
    const Wavelength wavelength = wavelengths_[static_cast<std::size_t>(channel)];
    const Bundle bundle(camera_, film, points, wavelength);
    double light = 0, sum = 0;
    LayerRay mean{{0, 0}, {0, 0}, 0};
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].weight = bundle.weight(i), light += found[i].weight;
      if (found[i].weight > 0) {
        found[i] = line(bundle.ray(i), found[i].weight);
      } else {
        found[i] = pulled_in(film, points[i], wavelength);
      }
      sum += found[i].weight;
      mean.position += found[i].weight * found[i].position, mean.slope += found[i].weight * found[i].slope;
    }
    if (!(sum > 0)) {
      std::fill(found.begin(), found.end(), LayerRay{raster, {0, 0}, 0});
      return;
    }
    if (light_.rays > 0) {
      float ray[row_count];
      light_.ray_at(static_cast<std::size_t>(channel), 0, raster.x, raster.y, ray);
      light = static_cast<double>(ray[weight]) * static_cast<double>(found.size());
    }
    const double scale = light / sum;
    for (LayerRay& ray : found) {
      if (ray.weight == 0) ray.position = mean.position / sum, ray.slope = mean.slope / sum;
      ray.weight *= scale;
    }
  }

 private:
  FilmPoint film_point(const Vec2<double>& raster) const noexcept {
    const Film& film = camera_.film();
    const int parts = layers_.columns / film.columns;
    return film.point(raster.x / parts, raster.y / parts);
  }

  /// A table of one ray per node whose weight is the light of the film point.
  ///
  /// The pupil of the samples is slightly larger than the part that transmits rays. The transmitted fraction needs more
  /// samples than a blur, most of them near the edge of the pupil, and changes slowly over the film.
  RayTable light_table(const LensRaysOptions& options) const {
    std::vector<PupilPoint> points = vogel_points(light_points);
    std::vector<double> factors;
    for (PupilPoint& p : points) {
      const double inwards = 1 - p.v;
      factors.push_back(3 * inwards * inwards / light_points), p.v = 1 - inwards * inwards * inwards;
    }
    const auto source = [&](int channel, const Vec2<double>& raster, std::span<const PupilPoint>,
                            std::span<LayerRay> found) {
      const Bundle bundle(camera_, film_point(raster), points, wavelengths_[static_cast<std::size_t>(channel)]);
      found[0] = {raster, {0, 0}, 0};
      for (std::size_t i = 0; i < points.size(); ++i) found[0].weight += bundle.weight(i) * factors[i];
    };
    const int step = std::max(1, std::max(layers_.columns, layers_.rows) / light_cells);
    return ray_table({0, 0, layers_.columns, layers_.rows}, std::span(points).first(1), wavelengths_.size(), source,
                     step, options.threads, options.stop);
  }

  LayerRay line(const Ray<double>& ray, double weight) const noexcept {
    const Vec3<double>&o = ray.origin, &d = ray.direction;
    const double run_x = d.x / -d.z, run_y = d.y / -d.z, dz = origin_z_ - o.z;  // the scene lies towards -z
    return {layers_.axis + layers_.focal_px * Vec2<double>{run_x, -run_y},
            layers_.focal_px * Vec2<double>{o.x - run_x * dz, -(o.y - run_y * dz)}, weight};
  }

  /// Moves a lost sample towards the centre of the pupil until its ray passes; weight 0 if no ray passes.
  LayerRay pulled_in(const FilmPoint& film, const PupilPoint& point, Wavelength wavelength) const {
    double passes = 0, lost = 1;  // fractions of v
    CameraRay found;
    for (const double radius_fraction : {0.98, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2}) {
      found = sample(film, point.u, radius_fraction * point.v, wavelength);
      if (found) {
        passes = radius_fraction;
        break;
      }
      lost = radius_fraction;
    }
    if (!found) return {{0, 0}, {0, 0}, 0};
    for (int i = 0; i < 6; ++i) {
      const double radius_fraction = 0.5 * (passes + lost);
      const CameraRay nearer = sample(film, point.u, radius_fraction * point.v, wavelength);
      if (nearer) {
        passes = radius_fraction, found = nearer;
      } else {
        lost = radius_fraction;
      }
    }
    return line(found.ray, found.weight);
  }
  CameraRay sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const {
    return camera_.sample({.film = film, .pupil_u = u, .pupil_v = v, .wavelength = wavelength});
  }

  Camera camera_;
  LayerCamera layers_;
  double origin_z_;
  std::vector<Wavelength> wavelengths_;
  RayTable light_;  ///< empty unless the model clips rays at apertures
};

}  // namespace

LensRays LensRays::of(const Camera& camera, const LayerCamera& layers, std::span<const PupilPoint> points,
                      std::span<const Wavelength> wavelengths, const LensRaysOptions& options) {
  if (camera.film().travel_mm != 0) {
    throw Error("lens rays: the film travels while the shutter is open; must not travel (Film::at)");
  }
  const int columns = camera.film().columns, rows = camera.film().rows, parts = std::max(1, layers.columns / columns);
  if (layers.columns != parts * columns || layers.rows != parts * rows) {
    throw Error("lens rays: picture of the layers: columns x rows = " + std::to_string(layers.columns) + " x " +
                std::to_string(layers.rows) + "; must equal the film's, " + std::to_string(columns) + " x " +
                std::to_string(rows) + ", or a whole multiple");
  }
  const Wavelength primary{};
  if (wavelengths.empty()) wavelengths = {&primary, 1};
  CameraSample middle;
  middle.film = camera.film().point(columns / 2.0, rows / 2.0);
  for (const Wavelength at : wavelengths) {
    // The index throws if the lens does not cover the wavelength.
    middle.wavelength = at;
    if (!at.in_nm() || camera.sample(middle).fate == RayFate::outside_spectrum) {
      static_cast<void>(camera.lens().index(0, at));
    }
  }
  return LensRays(layers, points, static_cast<int>(wavelengths.size()),
                  RaysOfCamera(camera, layers, wavelengths, options), options);
}

}  // namespace petzval
