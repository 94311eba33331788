// SPDX-License-Identifier: Apache-2.0
// Calls of tables that are built once: film pupils, polynomials, distortions and focal surfaces.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "fixed_lenses.hpp"
#include "laws.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/focus/focus.hpp"
#include "polynomial/ray_polynomial.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace {

using namespace petzval;

constexpr std::size_t count = 5;
constexpr double radius = 15;  // radius of all films, mm

template <class T>
const T& one_of(const std::vector<T>& all, fuzz::Bytes& bytes) {
  return all[bytes.byte() % all.size()];
}

FilmPoint wild_place(fuzz::Bytes& bytes) {
  const double x = bytes.number(-radius, radius), y = bytes.number(-radius, radius);
  return {x, y};
}

/// One table of each kind: strips with and without an obscuration, cells, a bladed iris, images of an iris, discs, a
/// rim, and two tilted films.
std::vector<FilmPupilTable> pupil_tables() {
  const Lens usual = fuzz::coloured("double_gauss_100mm_f2.0"), flat = fuzz::coloured("anamorphic_60mm_2x");
  const FilmPupilTable strips = FilmPupilTable::enclosing(usual, radius),
                       cells = FilmPupilTable::enclosing(flat, radius);
  const double steep = 0.1 / std::abs(strips.space().depth());
  constexpr double half = 10;
  const double most = steep * half * std::numbers::sqrt2;
  const FilmTilt tilt{.slope_x = steep, .slope_y = -steep, .min_excess = -most, .max_excess = most, .radius = half};
  const std::vector<PupilImage> images(3, {.shift = {0.1, 0.2}, .radius = {10, 12}});
  const std::vector<std::vector<PupilDisc>> discs(3, {{0, 10}, {0.4, 11}});
  return {strips,
          FilmPupilTable::equal_area(fuzz::coloured("catadioptric_mangin_1000mm_f7.5"), radius),
          cells,
          FilmPupilTable::enclosing(with_iris(usual, {.blades = 5, .roundness = 0.2, .rotation_rad = 0.3}), radius),
          FilmPupilTable::of_iris({50, 0}, {.blades = 7}, images, radius, 1),
          FilmPupilTable::of_discs({50, 0}, discs, radius, 1),
          strips.clipped_by_rim({.ratio = 1.1, .shift_per_mm = 0.05}),
          strips.for_tilted_film(tilt),
          cells.for_tilted_film(tilt)};
}

template <class T>
void samples(const FilmPupilTable& table, fuzz::Bytes& bytes) {
  std::array<std::array<T, count>, 7> n{};
  std::array<FilmPoint, count> film;
  const Wavelength wavelength = fuzz::wild_wavelength(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    film[i] = wild_place(bytes);
    const double u = bytes.number(0, 1), v = bytes.number(0, 1);
    const std::array numbers{film[i].x, film[i].y, u, v};
    for (std::size_t k = 0; k < 4; ++k) n[k][i] = static_cast<T>(numbers[k]);
    film[i] = {n[0][i], n[1][i]};
  }
  table.sample<T>(count, n[0].data(), n[1].data(), n[2].data(), n[3].data(), {.all = wavelength}, n[4].data(),
                  n[5].data(), n[6].data());
  for (std::size_t i = 0; i < count; ++i) {
    const PupilSample one = table.sample(film[i], n[2][i], n[3][i], wavelength);
    fuzz::require(std::isfinite(n[4][i]) && std::isfinite(n[5][i]) && std::isfinite(n[6][i]) && n[6][i] >= 0 &&
                      std::isfinite(one.x) && std::isfinite(one.y) && std::isfinite(one.area) && one.area >= 0,
                  "a sample of a pupil is finite");
    if (!(one.area > 0)) continue;
    const Vec2<double> at = table.position(film[i], one.x, one.y, wavelength);
    constexpr double fold = 0.02;  // sectors of interpolated polygons may overlap at corners of a bladed iris
    fuzz::require(fuzz::finite(at) && at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1 + fold,
                  "a sample lies within its pupil");
  }
}

void places(const FilmPupilTable& table, fuzz::Bytes& bytes) {
  std::array<std::array<double, count>, 4> n{};
  std::array<std::uint8_t, count> within;
  std::array<double, count> clearances;
  const Wavelength wavelength = fuzz::wild_wavelength(bytes);
  const double size = bytes.byte() < 128 ? 20 : 60;
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint film = wild_place(bytes);
    n[0][i] = film.x, n[1][i] = film.y;
    n[2][i] = bytes.number(-size, size), n[3][i] = bytes.number(-size, size);
  }
  const TwoPlaneRays<const double> lines{n[0].data(), n[1].data(), n[2].data(), n[3].data()};
  table.contains<double>(count, lines, {.all = wavelength}, within.data());
  table.clearances(count, lines, wavelength, clearances.data());
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint film{n[0][i], n[1][i]};
    const bool one = table.contains(film, n[2][i], n[3][i], wavelength);
    fuzz::require(clearances[i] >= -1 && clearances[i] <= 1, "a clearance is from -1 to 1");
    // Skips points next to edges, and at denormal distances from the centre of a polygon.
    constexpr double edge = 1e-9;
    const Vec2<double> middle = table.middle(film, wavelength);
    const bool in_the_middle = std::hypot(n[2][i] - middle.x, n[3][i] - middle.y) < 1e-300;
    if (std::abs(clearances[i]) > edge && !in_the_middle) {
      fuzz::require(one == (clearances[i] > 0) && one == (within[i] != 0),
                    "points inside a pupil have a positive clearance");
    }
    const double area = table.area(film, wavelength), angle = table.projected_solid_angle(film, wavelength);
    fuzz::require(
        std::isfinite(area) && area >= 0 && std::isfinite(angle) && angle >= 0 && angle < 2 * std::numbers::pi,
        "area and solid angle of a pupil are finite and not negative");
    if (one) fuzz::require(area > 0, "the area of a pupil that contains a point is positive");
    fuzz::require(fuzz::finite(table.middle(film, wavelength)), "the centre of a pupil is finite");
    const auto by = table.derivatives(film, bytes.number(0, 1), n[3][i], wavelength);
    fuzz::require(fuzz::finite(by.by_film_x) && fuzz::finite(by.by_film_y), "derivatives of a sample are finite");
  }
}

std::vector<RayPolynomial> polynomials() {
  std::vector<RayPolynomial> result;
  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_8mm_f2.8", "anamorphic_60mm_2x"}) {
    const Lens lens = fuzz::coloured(id);
    result.push_back(RayPolynomial::fit(lens, FilmPupilTable::equal_area(lens, 8), 3));
  }
  return result;
}

void lines(const RayPolynomial& polynomial, fuzz::Bytes& bytes) {
  const FilmPoint film = wild_place(bytes);
  const TwoPlaneRay line{film.x, film.y, bytes.number(-20, 20), bytes.number(-20, 20)};
  const Wavelength wavelength = fuzz::wild_wavelength(bytes);
  Ray<double> one, many;
  RayFate fate;
  const RayFate alone = polynomial.to_scene(line, wavelength, one);
  polynomial.to_scene<double>(
      1, {&line.film_x, &line.film_y, &line.pupil_x, &line.pupil_y}, {.all = wavelength},
      {&many.origin.x, &many.origin.y, &many.origin.z, &many.direction.x, &many.direction.y, &many.direction.z}, &fate);
  fuzz::require(alone == fate, "a line has the same fate in a batch");
  for (const auto& ray : {one, many}) {
    fuzz::require(fuzz::finite(ray) && fuzz::unit(ray.direction, 1e-12), "a polynomial's ray is valid");
  }
  TwoPlaneRay back;
  const Ray<double> in{one.origin, -one.direction};
  polynomial.to_film(1, {&in.origin.x, &in.origin.y, &in.origin.z, &in.direction.x, &in.direction.y, &in.direction.z},
                     {.all = wavelength}, {&back.film_x, &back.film_y, &back.pupil_x, &back.pupil_y}, &fate);
  fuzz::require(std::isfinite(back.film_x) && std::isfinite(back.film_y) && std::isfinite(back.pupil_x) &&
                    std::isfinite(back.pupil_y),
                "a line of a polynomial is finite");
}

std::vector<LensDistortion> distortions() {
  std::vector<LensDistortion> result;
  const Film film{.width_mm = 24, .height_mm = 16, .columns = 240, .rows = 160};
  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_8mm_f2.8", "anamorphic_60mm_2x"}) {
    const Lens lens = with_focus(fuzz::coloured(id), 3000);
    for (const ModelKind model : {ModelKind::exact_float, ModelKind::exact_double}) {
      result.emplace_back(Camera(lens, film, {.model = model}));
    }
  }
  return result;
}

void pixels(const LensDistortion& distortion, fuzz::Bytes& bytes) {
  const Vec2<double> at{bytes.number(-20, 260), bytes.number(-20, 180)};
  const auto shown = distortion.distorted(at), seen = distortion.undistorted(at);
  if (shown) fuzz::require(fuzz::finite(*shown), "a distorted position is finite");
  if (!seen) return;
  fuzz::require(fuzz::finite(*seen), "an undistorted position is finite");
  const auto again = distortion.distorted(*seen);
  fuzz::require(again && std::hypot(again->x - at.x, again->y - at.y) < 0.02, "distortion inverts undistortion");
}

void surface(fuzz::Bytes& bytes) {
  const IdealLens lens = thin_lens(50, 2);
  const Film film{.z_mm = 51};
  std::vector<FocalPoint> points(static_cast<std::size_t>(bytes.count(1, 6)));
  for (FocalPoint& point : points) {
    point.film_point = wild_place(bytes);
    if (!bytes.one_in(4)) point.inverse_distance = bytes.number(0, 1e-2);
    if (bytes.one_in(2)) point.extent_stops = bytes.number(-3, 3);
    if (bytes.one_in(4)) point.blur_mm = bytes.number(-0.5, 0.5);
    if (bytes.one_in(4)) point.weight = bytes.number(0, 3), point.fade = bytes.number(0, 1);
  }
  FocalSurfaceOptions options{.kind = bytes.one_in(2) ? SurfaceKind::shepard : SurfaceKind::affine,
                              .beta = bytes.number(1, 8)};
  const FocalSurface found(lens, film, points, options);
  std::array<std::array<double, count>, 4> n{};
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint at = i == 0 ? points[0].film_point : wild_place(bytes);
    n[0][i] = at.x, n[1][i] = at.y;
  }
  found.at<double>(count, n[0].data(), n[1].data(), n[2].data(), n[3].data());
  const auto between = [](double value, double least, double most) {
    const double room = 1e-9 * (std::abs(least) + std::abs(most));
    return value >= least - room && value <= most + room;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPoint place{n[0][i], n[1][i]};
    const auto one = found.at(place);
    fuzz::require(between(one.inverse_distance, found.farthest(), found.nearest()) &&
                      between(n[2][i], found.farthest(), found.nearest()) &&
                      between(one.extent_stops, found.least_extent(), found.most_extent()) &&
                      between(n[3][i], found.least_extent(), found.most_extent()),
                  "a focal surface stays within its limits");
    const double range = found.nearest() - found.farthest();
    fuzz::require(std::abs(one.inverse_distance - n[2][i]) <= 1e-6 * (range + std::abs(one.inverse_distance)),
                  "a position of a batch equals the single call");
    const auto slopes = found.slopes(place);
    fuzz::require(fuzz::finite(slopes.inverse_distance) && fuzz::finite(slopes.extent_stops),
                  "slopes of a surface are finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  static const auto tables = pupil_tables();
  static const auto fits = polynomials();
  static const auto pictures = distortions();
  switch (bytes.count(0, 5)) {
    case 0: samples<float>(one_of(tables, bytes), bytes); break;
    case 1: samples<double>(one_of(tables, bytes), bytes); break;
    case 2: places(one_of(tables, bytes), bytes); break;
    case 3: lines(one_of(fits, bytes), bytes); break;
    case 4: pixels(one_of(pictures, bytes), bytes); break;
    default: fuzz::done([&] { surface(bytes); });
  }
  return 0;
}
