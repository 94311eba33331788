// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/ray_map.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "camera/camera_data.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace {

constexpr std::size_t planes_channels = 5, directions_channels = 7;
/// The tangent of the field grows fast beyond this field, and interpolation of slopes with it.
constexpr double widest_planes_rad = radians(60);
/// Samples of the weight of a chief ray.
constexpr std::size_t weight_samples = 16;

/// The nearest 16-bit float: 11 significant bits, multiples of 2^-24.
float rounded_to_half(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  const double unit = std::ldexp(1.0, std::max(exponent - 11, -24));
  return static_cast<float>(std::nearbyint(value / unit) * unit);
}

/// Exact rays of a lens sample in batches.
class MapRays {
 public:
  MapRays(const Camera& camera, int lens_samples) : camera_(camera), count_(static_cast<std::size_t>(lens_samples)) {
    if (lens_samples != 1) return;
    const Film& film = camera.film();
    const CameraSample middle{.film = film.point(film.columns / 2.0, film.rows / 2.0)};
    if (!camera.sample(middle)) single_v_ = 0.1;  // beside an obscuration
    if (camera.model() != ModelKind::exact_double && camera.model() != ModelKind::exact_float) return;
    try {
      const Lens closed = with_f_number(camera.lens(), 32 * real_f_number(camera.lens()));
      chiefs_.emplace(closed, film, CameraOptions{.model = ModelKind::exact_double});
      if (!chiefs_->sample(middle)) chiefs_.reset();
    } catch (const Error&) {  // an afocal lens, or an obscuration in the middle: no chief rays
    }
  }

  bool chief_rays() const noexcept { return chiefs_.has_value(); }
  std::array<double, 2> point(std::size_t sample) const {
    return count_ == 1 ? std::array{0.0, chiefs_ ? 0.0 : single_v_} : core_detail::fibonacci_point(sample, count_);
  }
  /// Rays of raster positions; a lost ray has weight 0.
  std::vector<CameraRay> rays(std::size_t sample, const std::vector<Vec2<double>>& raster) const {
    const auto [u, v] = point(sample);
    std::vector<CameraRay> found = traced(chiefs_ ? *chiefs_ : camera_, raster, u, v);
    if (!chiefs_) return found;
    std::vector<double> sums(found.size());
    for (std::size_t i = 0; i < weight_samples; ++i) {
      const auto [s, t] = core_detail::fibonacci_point(i, weight_samples);
      const std::vector<CameraRay> own = traced(camera_, raster, s, t);
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += own[k].weight;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
      if (found[k]) found[k].weight = sums[k] / weight_samples;
    }
    return found;
  }

 private:
  static std::vector<CameraRay> traced(const Camera& camera, const std::vector<Vec2<double>>& raster, double u,
                                       double v) {
    const std::size_t n = raster.size();
    std::vector<double> data(11 * n);
    const auto column = [&](std::size_t k) { return data.data() + k * n; };
    for (std::size_t i = 0; i < n; ++i) {
      const FilmPoint film = camera.film().point(raster[i].x, raster[i].y);
      column(0)[i] = film.x, column(1)[i] = film.y, column(2)[i] = u, column(3)[i] = v;
    }
    camera.sample<double>(n, {column(0), column(1), column(2), column(3)},
                          {{column(4), column(5), column(6), column(7), column(8), column(9)}, column(10)});
    std::vector<CameraRay> rays(n);
    for (std::size_t i = 0; i < n; ++i) {
      rays[i].ray = {{column(4)[i], column(5)[i], column(6)[i]}, {column(7)[i], column(8)[i], column(9)[i]}};
      rays[i].weight = column(10)[i];
    }
    return rays;
  }

  const Camera& camera_;
  std::size_t count_;
  double single_v_ = 0;
  std::optional<Camera> chiefs_;
};

/// The point of a ray on a sphere about (0, 0, z), or its direction if the sphere is infinite; relative to the centre
/// and the radius.
Vec3<double> seen(const Ray<double>& ray, double z, double radius) {
  if (!std::isfinite(radius)) return ray.direction;
  const Vec3<double> o = ray.origin - Vec3<double>{0, 0, z};
  const double b = glm::dot(o, ray.direction), c = glm::dot(o, o) - radius * radius;
  return (o + (std::sqrt(std::max(0.0, b * b - c)) - b) * ray.direction) / radius;
}

/// Writes a ray at a pixel.
void store(const CameraRay& own, RayMap& map, std::size_t sample, std::size_t pixel) {
  const bool planes = map.layout == RayMapLayout::planes;
  const auto& [o, d] = own.ray;
  if (!own || (planes && !(d.z < 0))) return;
  std::array<double, directions_channels> numbers{};
  if (planes) {
    const double x = static_cast<double>(pixel % static_cast<std::size_t>(map.columns)) + 0.5 - map.columns / 2.0;
    const double y = static_cast<double>(pixel / static_cast<std::size_t>(map.columns)) + 0.5 - map.rows / 2.0;
    const Vec2<double> slope{-d.x / d.z, -d.y / d.z};
    const double ahead = o.z - map.plane_z_mm;
    numbers = {o.x + slope.x * ahead, o.y + slope.y * ahead, slope.x - map.slope_per_pixel.x * x,
               slope.y - map.slope_per_pixel.y * y, own.weight};
  } else {
    const Vec3<double> from = o - Vec3<double>{0, 0, map.plane_z_mm}, foot = o - glm::dot(from, d) * d;
    numbers = {foot.x, foot.y, foot.z, d.x, d.y, d.z, own.weight};
  }
  const std::size_t channels = planes ? planes_channels : directions_channels;
  const std::size_t pixels = static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows);
  for (std::size_t k = 0; k < channels; ++k) {
    map.values[(sample * channels + k) * pixels + pixel] =
        map.half ? rounded_to_half(numbers[k]) : static_cast<float>(numbers[k]);
  }
}

/// Layout, slopes, front and widest field, from a coarse grid of rays.
void look_ahead(const MapRays& exact, RayMap& map) {
  constexpr int steps = 48;
  std::vector<Vec2<double>> grid;
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= steps; ++i) {
      grid.push_back({0.5 + i * (map.columns - 1.0) / steps, 0.5 + j * (map.rows - 1.0) / steps});
    }
  }
  Vec2<double> products{0, 0}, squares{0, 0};
  for (std::size_t s = 0; s < map.lens_samples.size(); ++s) {
    const std::vector<CameraRay> rays = exact.rays(s, grid);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!rays[i]) continue;
      const auto& [o, d] = rays[i].ray;
      map.widest_field_rad = std::max(map.widest_field_rad, std::acos(std::clamp(-d.z, -1.0, 1.0)));
      map.front_z_mm = std::min(map.front_z_mm, o.z);
      if (!(d.z < 0)) continue;
      const Vec2<double> at = grid[i] - Vec2<double>{map.columns, map.rows} / 2.0;
      products += at * Vec2<double>{-d.x / d.z, -d.y / d.z}, squares += at * at;
    }
  }
  if (map.widest_field_rad > widest_planes_rad) map.layout = RayMapLayout::directions;
  if (map.half && map.layout == RayMapLayout::planes) {
    for (const int k : {0, 1}) map.slope_per_pixel[k] = squares[k] > 0 ? products[k] / squares[k] : 0;
  }
}

double distance_in_focus(const Camera& camera, double plane_z) {
  const FocusSolution found = solve_subject(camera.lens(), camera.film().z());
  const bool none = found.status == FocusStatus::afocal || found.status == FocusStatus::no_rays;
  const double distance = none ? HUGE_VAL : plane_z - found.subject_z;
  return distance > 0 && distance < 1e9 ? distance : HUGE_VAL;
}

}  // namespace

std::vector<std::string_view> RayMap::channels() const {
  if (layout == RayMapLayout::planes) return {"x", "y", "slope_x", "slope_y", "weight"};
  return {"x", "y", "z", "dx", "dy", "dz", "weight"};
}

CameraRay RayMap::ray(std::size_t lens_sample, double raster_x, double raster_y) const noexcept {
  const double x = std::clamp(raster_x - 0.5, 0.0, columns - 1.0), y = std::clamp(raster_y - 0.5, 0.0, rows - 1.0);
  const int left = std::clamp(static_cast<int>(x), 0, std::max(0, columns - 2));
  const int top = std::clamp(static_cast<int>(y), 0, std::max(0, rows - 2));
  const std::size_t channels = layout == RayMapLayout::planes ? planes_channels : directions_channels;
  std::array<double, directions_channels> sum{};
  CameraRay result;
  if (!(raster_x >= 0 && raster_x <= columns && raster_y >= 0 && raster_y <= rows)) return result;
  for (const int j : {0, 1}) {
    for (const int i : {0, 1}) {
      const std::size_t pixel = static_cast<std::size_t>(std::min(top + j, rows - 1)) * columns +
                                static_cast<std::size_t>(std::min(left + i, columns - 1));
      const double part = std::abs(1 - i - (x - left)) * std::abs(1 - j - (y - top));
      if (part == 0) continue;
      if (!(channel(lens_sample, channels - 1)[pixel] > 0)) return result;
      for (std::size_t k = 0; k < channels; ++k) sum[k] += part * double{channel(lens_sample, k)[pixel]};
    }
  }
  if (layout == RayMapLayout::planes) {
    const Vec2<double> at{x + 0.5 - columns / 2.0, y + 0.5 - rows / 2.0};
    const Vec2<double> slope = Vec2<double>{sum[2], sum[3]} + slope_per_pixel * at;
    result.ray = {{sum[0], sum[1], plane_z_mm}, glm::normalize(Vec3<double>{slope.x, slope.y, -1})};
  } else {
    result.ray = {{sum[0], sum[1], sum[2]}, glm::normalize(Vec3<double>{sum[3], sum[4], sum[5]})};
  }
  result.weight = sum[channels - 1], result.fate = RayFate::transmitted;
  return result;
}

RayMap ray_map(const Camera& camera, const RayMapOptions& options) {
  const Film& film = camera.film();
  const Lens& lens = camera.lens();
  if (options.lens_samples < 1 || options.lens_samples > 256) {
    throw Error("ray_map: lens_samples = " + std::to_string(options.lens_samples) + "; must be 1 to 256");
  }
  RayMap map;
  map.columns = film.columns, map.rows = film.rows, map.half = options.half;
  const std::size_t pixels = static_cast<std::size_t>(film.columns) * static_cast<std::size_t>(film.rows);
  const auto samples = static_cast<std::size_t>(options.lens_samples);
  if (pixels * samples * directions_channels > std::size_t{1} << 28) {
    throw Error("ray_map: " + std::to_string(film.columns) + " x " + std::to_string(film.rows) + " pixels with " +
                std::to_string(samples) + " lens samples; must be at most 2^28 values at 7 for each ray");
  }
  const double pupil = has_pupils(lens) ? pupils(lens).entrance.z : HUGE_VAL;
  map.plane_z_mm = std::abs(pupil) <= 1000 ? pupil : 0;
  map.focus_mm = distance_in_focus(camera, map.plane_z_mm);
  const MapRays exact(camera, options.lens_samples);
  map.chief_rays = exact.chief_rays();
  const FilmPupilTable& table = CameraAccess::data(camera).model.pupils();
  map.pupil_z_mm = table.space().pupil_z;
  for (std::size_t s = 0; s < samples; ++s) {
    const auto [u, v] = exact.point(s);
    const PupilSample at = table.sample(film.point(film.columns / 2.0, film.rows / 2.0), u, v);
    map.lens_samples.push_back({u, v, {at.x, at.y}});
  }
  look_ahead(exact, map);
  const std::size_t channels = map.channels().size();
  map.values.assign(pixels * samples * channels, 0.0f);
  const auto columns = static_cast<std::size_t>(film.columns), rows = static_cast<std::size_t>(film.rows);
  parallel_for(samples * rows, 8, options.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec2<double>> raster(columns);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t sample = i / rows, row = i % rows;
      for (std::size_t column = 0; column < columns; ++column) {
        raster[column] = {static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
      }
      const std::vector<CameraRay> rays = exact.rays(sample, raster);
      for (std::size_t column = 0; column < columns; ++column) store(rays[column], map, sample, row * columns + column);
    }
  });

  // Errors at places of each lens sample, half of them in the middles of cells.
  if (film.columns < 2 || film.rows < 2) return map;
  const std::size_t places = std::max<std::size_t>(256, (std::size_t{1} << 15) / samples);
  struct Sum {
    double squares = 0, largest = 0;
    std::size_t used = 0, left_out = 0;
  };
  std::vector<Sum> sums(samples);
  parallel_for(samples, 1, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const core_detail::Kronecker<2> sequence(s + 1);
      std::vector<Vec2<double>> raster(places);
      for (std::size_t i = 0; i < places; ++i) {
        const auto [x, y] = sequence(i);
        const Vec2<double> at{x * (film.columns - 1), y * (film.rows - 1)};
        raster[i] = i % 2 == 0 ? glm::floor(at) + 1.0 : at + 0.5;
      }
      const std::vector<CameraRay> rays = exact.rays(s, raster);
      for (std::size_t i = 0; i < places; ++i) {
        const Vec2<double> last{film.columns - 1.5, film.rows - 1.5};
        const Vec2<double> corner = glm::min(glm::floor(raster[i] - 0.5) + 0.5, last);
        const auto at = [&](int right, int down) { return map.ray(s, corner.x + right, corner.y + down); };
        const CameraRay found = map.ray(s, raster[i].x, raster[i].y);
        if (!found || !rays[i]) {
          sums[s].left_out += at(0, 0) || at(1, 0) || at(0, 1) || at(1, 1);
          continue;
        }
        const auto point = [&](const CameraRay& ray) { return seen(ray.ray, map.plane_z_mm, map.focus_mm); };
        const Vec3<double> first = point(at(0, 0));
        const double pixel = std::sqrt(glm::length(glm::cross(point(at(1, 0)) - first, point(at(0, 1)) - first)));
        const double error = glm::length(point(found) - point(rays[i])) / pixel;
        sums[s].squares += error * error, ++sums[s].used;
        sums[s].largest = std::max(sums[s].largest, error);
      }
    }
  });
  Sum all;
  for (const Sum& one : sums) {
    all.squares += one.squares, all.used += one.used, all.left_out += one.left_out;
    all.largest = std::max(all.largest, one.largest);
  }
  if (all.used == 0) throw Error(lens.name() + ": ray_map: all rays are lost; must have four lit pixels side by side");
  map.rms_px = std::sqrt(all.squares / static_cast<double>(all.used)), map.largest_px = all.largest;
  map.left_out = static_cast<double>(all.left_out) / static_cast<double>(all.used + all.left_out);
  return map;
}

}  // namespace petzval
