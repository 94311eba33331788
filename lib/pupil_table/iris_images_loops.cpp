// SPDX-License-Identifier: Apache-2.0
// Samples of images of an iris, compiled once for each instruction set: plain loops that the compiler vectorizes. Names
// are local, and no other library is called, as in lib/core/lanes.hpp.
#include "iris_images_loops.hpp"

#include "core/loop_math.hpp"
#include "lens/look_up.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Calls body(begin, end, image_of) with the images of all rays, by ray.
template <class R, class Body>
inline void with_images(const IrisImageTable<R>& table, std::size_t count, const RayWavelengths& wavelengths,
                        const Body& body) noexcept {
  if (wavelengths.shared()) {
    body(0, count, [image = table.image](std::size_t) { return image; });
    return;
  }
  constexpr std::size_t block = lens_detail::look_up_block;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = count - begin < block ? count - begin : block;
    R seen[4][block];
    const std::size_t y = table.equal_sections ? 0 : 2;
    lens_detail::look_up(table.images, wavelengths, begin, n, seen, y + 2);
    const R *const shift_x = seen[0], *const radius_x = seen[1], *const shift_y = seen[y],
                   *const radius_y = seen[y + 1];
    body(begin, begin + n, [=, area = table.area](std::size_t i) -> ImageSections<R> {
      const std::size_t k = i - begin;
      return {shift_x[k], shift_y[k], radius_x[k], radius_y[k], area * (radius_x[k] * radius_y[k])};
    });
  }
}

/// A film point and its image, all finite.
template <class R>
struct Seen {
  R film_x, film_y;
  ImageSections<R> image;
};

template <class R>
inline Seen<R> seen(const SeenIris<R>& table, const ImageSections<R>& image, R film_x, R film_y, bool sound) noexcept {
  const bool known = sound & (film_x * film_x + film_y * film_y <= table.film_radius * table.film_radius);
  const R fx = known ? film_x : R(0), fy = known ? film_y : R(0);
  ImageSections<R> own = image;
  own.area = known ? image.area : R(0);
  return {fx, fy, on_tilted(own, table.slope_x * fx + table.slope_y * fy)};
}

/// Writes samples. sample_at(i, u, v): a uniform point of the iris.
template <class R, class ImageOf, class SampleAt>
inline void fill(const SeenIris<R>& given, const ImageOf& image_of, const SampleAt& sample_at, std::size_t begin,
                 std::size_t end, const R* film_x, const R* film_y, const R* u, const R* v, R* x, R* y,
                 R* areas) noexcept {
  const SeenIris<R> table = given;  // a copy that no output can alias
  PETZVAL_INDEPENDENT
  for (std::size_t i = begin; i < end; ++i) {
    // Comparisons with NaN are false.
    const bool sound = (film_x[i] + film_y[i] + u[i] + v[i]) * R(0) >= R(0);
    const auto [fx, fy, image] = seen(table, image_of(i), film_x[i], film_y[i], sound);
    const auto [px, py] = sample_at(i, core_detail::clamped(u[i]), core_detail::clamped(v[i]));
    const bool lit = image.area > R(0);
    x[i] = image.shift_x * fx + (lit ? image.radius_x : R(0)) * px;
    y[i] = image.shift_y * fy + (lit ? image.radius_y : R(0)) * py;
    areas[i] = image.area;
  }
}

/// Calls body(sample_at) with the sample function for fill().
template <class R, class Body>
inline void with_sampler(const iris_detail::IrisSectors<R>& iris, const Body& body) noexcept {
  if (iris.count == 0) {
    body([](std::size_t, R u, R v) { return iris_detail::disc_point(u, v); });
  } else {
    body([iris](std::size_t, R u, R v) { return iris_detail::sector_point(iris, u, v); });
  }
}

template <class R>
void sample(const IrisImageTable<R>& table, std::size_t count, const R* film_x, const R* film_y, const R* u, const R* v,
            const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  with_images(table, count, wavelengths, [&](std::size_t first, std::size_t last, const auto& image_of) {
    with_sampler(table.iris, [&](const auto& sample_at) {
      fill(table, image_of, sample_at, first, last, film_x, film_y, u, v, x, y, areas);
    });
  });
}

PupilSample sample_one(const SeenIris<double>& given, const ImageSections<double>& image, double film_x, double film_y,
                       double u, double v) noexcept {
  PupilSample result{};
  with_sampler(given.iris, [&](const auto& sample_at) {
    const auto image_of = [&image](std::size_t) { return image; };
    fill(given, image_of, sample_at, 0, 1, &film_x, &film_y, &u, &v, &result.x, &result.y, &result.area);
  });
  return result;
}

template <class R>
void sample_areas(const IrisImageTable<R>& given, std::size_t count, const TwoPlaneRays<const R>& lines,
                  const RayWavelengths& wavelengths, R* areas) noexcept {
  const IrisImageTable<R> table = given;
  const auto [film_x, film_y, pupil_x, pupil_y] = lines;
  constexpr std::size_t block = 64;
  R x[block], y[block];
  with_images(table, count, wavelengths,
              [&, film_x = film_x, film_y = film_y, pupil_x = pupil_x, pupil_y = pupil_y](
                  std::size_t first, std::size_t last, const auto& image_of) {
                for (std::size_t begin = first; begin < last; begin += block) {
                  const std::size_t n = last - begin < block ? last - begin : block;
                  PETZVAL_INDEPENDENT
                  for (std::size_t i = 0; i < n; ++i) {
                    const std::size_t o = begin + i;
                    const auto [fx, fy, image] = seen(table, image_of(o), film_x[o], film_y[o], true);
                    x[i] = (pupil_x[o] - image.shift_x * fx) / image.radius_x;
                    y[i] = (pupil_y[o] - image.shift_y * fy) / image.radius_y;
                    areas[o] = x[i] * x[i] + y[i] * y[i] <= iris_detail::rim_squared<R> ? image.area : R(0);
                  }
                  for (std::size_t k = 0; k < table.iris.count; ++k) {
                    PETZVAL_INDEPENDENT
                    for (std::size_t i = 0; i < n; ++i) {
                      areas[begin + i] = iris_detail::within_edge(table.iris, k, x[i], y[i]) ? areas[begin + i] : R(0);
                    }
                  }
                }
              });
}

}  // namespace

const IrisImageLoops PETZVAL_LOOPS{
    {sample<float>, sample_areas<float>}, {sample<double>, sample_areas<double>}, sample_one};

}  // namespace petzval::pupil_table_detail
