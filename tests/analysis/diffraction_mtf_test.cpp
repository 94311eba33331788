// SPDX-License-Identifier: Apache-2.0
// MTF with diffraction: closed forms of perfect lenses, laws, and sums over a grid of directions by another ray tracer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace diffraction_mtf_test {

constexpr double far = -std::numeric_limits<double>::infinity(), pi = std::numbers::pi;

/// A parabolic mirror of 100 mm focal length, perfect on the axis, with a central obscuration.
Lens parabola(double f_number, double obscuration = 0) {
  Prescription p;
  p.name = "parabola";
  p.surfaces = {
      {.radius = -200, .thickness = -100, .semi_diameter = 50 / f_number, .conic = -1, .stop = true, .mirror = true}};
  if (obscuration > 0) p.surfaces[0].obscuration_semi_diameter = obscuration * 50 / f_number;
  return compile(p);
}

/// Area of two discs of radii a >= b at a distance.
double overlap(double a, double b, double distance) {
  if (distance >= a + b) return 0;
  if (distance <= a - b) return pi * b * b;
  const double x = (distance * distance + a * a - b * b) / (2 * distance), half = std::sqrt(a * a - x * x);
  return a * a * std::acos(x / a) + b * b * std::acos((distance - x) / b) - distance * half;
}

TEST(LensDiffractionMtf, OfPerfectMirrorsIsTheClosedForm) {
  constexpr double f_number = 20;
  const std::array axis{0.0};
  const std::array frequencies{0.0, 2.0, 8.0, 20.0, 40.0, 60.0, 80.0, 100.0};
  for (const double obscuration : {0.0, 0.35, 0.8}) {
    for (const MtfPoint& point : diffraction_mtf(parabola(f_number, obscuration), far, axis, frequencies).values) {
      const double e = obscuration, shift = 2 * point.frequency_per_mm * d_line_nm * 1e-6 * f_number;
      const double limit =
          shift == 0 ? 1
                     : (overlap(1, 1, shift) - 2 * overlap(1, e, shift) + overlap(e, e, shift)) / (pi * (1 - e * e));
      EXPECT_NEAR(point.tangential, limit, point.sampling_error) << e << ' ' << point.frequency_per_mm;
      EXPECT_NEAR(point.sagittal, limit, point.sampling_error) << e << ' ' << point.frequency_per_mm;
      EXPECT_NEAR(point.tangential_limit, limit, point.sampling_error) << e << ' ' << point.frequency_per_mm;
      EXPECT_LE(point.sampling_error, e > 0.5 ? 2e-3 : 1e-3);
    }
  }
}

// The exit pupil is a circular stop behind the lens. From an image point at the angle t it is narrower by cos(t) in the
// sagittal section and by cos^3(t) in the tangential section.
TEST(LensDiffractionMtf, OffTheAxisHasTheFactorsOfTheCosine) {
  constexpr double radius = 1.5, stop_z = 7;
  Prescription p;
  p.surfaces = {{.radius = 102.16, .thickness = 4, .medium = {.nd = 1.5168}, .semi_diameter = 90},
                {.radius = -102.16, .thickness = stop_z - 4, .semi_diameter = 90},
                {.thickness = 95, .semi_diameter = radius, .stop = true}};
  const Lens lens = compile(p);
  for (const double field : {0.0, radians(20.0), radians(35.0)}) {
    const FieldFocus focus = field_curvature(lens, far, {&field, 1})[0];
    for (const bool tangential : {true, false}) {
      const Lens sharp = with_film(lens, lens.film_z() + (tangential ? *focus.tangential_mm : *focus.sagittal_mm));
      const MtfPoint point = diffraction_mtf(sharp, far, {&field, 1}, std::array{20.0})[0][0];
      const double distance = sharp.film_z() - stop_z, cosine = distance / std::hypot(distance, point.image_height_mm);
      const double f_number = distance / (2 * radius * std::pow(cosine, tangential ? 3 : 1));
      EXPECT_NEAR(tangential ? point.tangential_limit : point.sagittal_limit,
                  diffraction_limited_mtf(20, d_line_nm, f_number), 2e-3)
          << field << ' ' << point.image_height_mm;
      EXPECT_LT(cosine, field > 0 ? 0.96 : 1.1);
    }
  }
}

/// A ray by Snell's law at spheres: direction behind the lens, and the optical path to the plane across the ray through
/// the centre of the film, mm.
struct OwnRay {
  Vec2<double> direction;
  double path;
  bool passes;
};

std::optional<OwnRay> traced(const Lens& lens, std::size_t wavelength, double field_rad, const Vec2<double>& start) {
  Vec3<double> at(start, 0), direction(0, std::sin(field_rad), std::cos(field_rad));
  double n = 1, path = glm::dot(at, direction);
  bool passes = true;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const LensSurface& surface = lens.surfaces()[i];
    const double c = surface.curvature;
    const Vec3<double> from = at - Vec3<double>(0, 0, surface.vertex_z);
    const double b = direction.z - c * glm::dot(from, direction), f = c * glm::dot(from, from) - 2 * from.z;
    const double root = b * b - c * f;
    if (!(root >= 0)) return {};
    const double length = f / (b + std::sqrt(root));
    path += n * length, at += length * direction;
    passes = passes && std::hypot(at.x, at.y) <= surface.semi_diameter;
    const Vec3<double> normal = Vec3<double>(0, 0, 1) - c * (at - Vec3<double>(0, 0, surface.vertex_z));
    const double n_out = lens.index(i + 1, wavelength), cosine = glm::dot(direction, normal), ratio = n / n_out;
    const double squared = 1 - ratio * ratio * (1 - cosine * cosine);
    if (!(squared >= 0)) return {};
    direction = ratio * direction + (std::sqrt(squared) - ratio * cosine) * normal, n = n_out;
  }
  return OwnRay{Vec2<double>(direction), path + glm::dot(Vec3<double>(0, 0, lens.film_z()) - at, direction), passes};
}

using Amplitudes = std::vector<std::vector<std::complex<double>>>;

/// Amplitudes at directions a step apart, on a square about the middle of the pupil. Newton's iteration finds the rays.
Amplitudes amplitudes(const Lens& lens, std::size_t wavelength, double field_rad, double step, int half) {
  const double far_off = std::tan(field_rad), pupil_z = pupils(lens, wavelength).entrance.z, h = 1e-3;
  const double focal_length = first_order(lens, wavelength).effective_focal_length;
  const Vec2<double> chief(0, -pupil_z * far_off);
  const Vec2<double> middle = traced(lens, wavelength, field_rad, chief)->direction;
  Amplitudes grid(static_cast<std::size_t>(2 * half + 1),
                  std::vector<std::complex<double>>(static_cast<std::size_t>(2 * half + 1)));
  for (int i = -half; i <= half; ++i) {
    for (int j = -half; j <= half; ++j) {
      if (i * i + j * j > half * half) continue;
      const Vec2<double> wanted = middle + step * Vec2<double>(i, j);
      Vec2<double> start = chief - focal_length * step * Vec2<double>(i, j);
      for (int iteration = 0; iteration < 12; ++iteration) {
        const auto ray = traced(lens, wavelength, field_rad, start),
                   x = traced(lens, wavelength, field_rad, start + Vec2<double>(h, 0)),
                   y = traced(lens, wavelength, field_rad, start + Vec2<double>(0, h));
        if (!ray || !x || !y) break;
        const Vec2<double> a = (x->direction - ray->direction) / h, b = (y->direction - ray->direction) / h,
                           miss = wanted - ray->direction;
        const double area = a.x * b.y - a.y * b.x;
        if (glm::length(miss) < 1e-10) {
          const double waves = ray->path / (lens.wavelengths_nm()[wavelength] * 1e-6);
          if (ray->passes) {
            grid[static_cast<std::size_t>(i + half)][static_cast<std::size_t>(j + half)] =
                std::polar(1 / std::sqrt(std::abs(area)), 2 * pi * waves);
          }
          break;
        }
        start += Vec2<double>(miss.x * b.y - miss.y * b.x, a.x * miss.y - a.y * miss.x) / area;
      }
    }
  }
  return grid;
}

/// Contrasts at 10, 20 and 30 per mm: sums over pairs of directions, `cells` steps apart at 10 per mm.
std::vector<MtfPoint> by_grid(const Lens& lens, double field_rad, int cells, std::span<const double> weights) {
  std::array<std::complex<double>, 4> tangential{}, sagittal{};
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    const double step = 10 * lens.wavelengths_nm()[w] * 1e-6 / cells;
    const int half = static_cast<int>(1.1 / (2 * real_f_number(lens) * step));
    const Amplitudes grid = amplitudes(lens, w, field_rad, step, half);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t shift = k * static_cast<std::size_t>(cells);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        for (std::size_t j = shift; j < grid.size(); ++j) {
          const double weight = weights[w] * step * step;
          tangential[k] += weight * grid[i][j] * std::conj(grid[i][j - shift]);
          sagittal[k] += weight * grid[j][i] * std::conj(grid[j - shift][i]);
        }
      }
    }
  }
  std::vector<MtfPoint> result;
  for (std::size_t k = 1; k < 4; ++k) {
    result.push_back({.frequency_per_mm = 10.0 * static_cast<double>(k),
                      .tangential = std::abs(tangential[k] / tangential[0]),
                      .sagittal = std::abs(sagittal[k] / sagittal[0])});
  }
  return result;
}

TEST(LensDiffractionMtf, EqualsSumsOverAGridByAnotherTracer) {
  struct Case {
    const char* lens;
    double f_number;  // 0: as in the file
    double field_deg;
    int cells;
  };
  const std::array weights{1.0, 2.0};
  for (const Case& one : {Case{"cooke_triplet_50mm_f5", 0, 14, 7}, Case{"cooke_triplet_50mm_f5", 8, 20, 12},
                          Case{"double_gauss_100mm_f2.0", 4, 10, 6}, Case{"double_gauss_100mm_f2.0", 0, 22, 3},
                          Case{"tessar_100mm_f2.8", 0, 15, 4}}) {
    SCOPED_TRACE(std::string(one.lens) + ", " + std::to_string(one.field_deg) + " degrees");
    Lens lens = compile(testing::data_prescription(one.lens), std::array{486.1327, 587.5618},
                        {.missing_glass = MissingGlass::abbe});
    if (one.f_number > 0) lens = with_f_number(lens, one.f_number);
    const std::array fields{radians(one.field_deg)};
    const std::array frequencies{10.0, 20.0, 30.0};
    const auto mtf = diffraction_mtf(lens, far, fields, frequencies, weights);
    const auto grid = by_grid(lens, fields[0], one.cells, weights);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(mtf[0][k].tangential, grid[k].tangential, 1e-3) << frequencies[k];
      EXPECT_NEAR(mtf[0][k].sagittal, grid[k].sagittal, 1e-3) << frequencies[k];
      EXPECT_LE(mtf[0][k].sampling_error, 1e-3);
      EXPECT_LE(mtf[0][k].tangential, mtf[0][k].tangential_limit + mtf[0][k].sampling_error);
      EXPECT_LE(mtf[0][k].sagittal, mtf[0][k].sagittal_limit + mtf[0][k].sampling_error);
    }
  }
}

TEST(LensDiffractionMtf, OfShiftedFilmsEqualsLensesWithThem) {
  const Lens lens = testing::data_lens("cooke_triplet_50mm_f5");
  const std::array fields{0.0, radians(14.0)}, frequencies{20.0, 40.0};
  const std::array shifts{-0.1, 0.0, 0.15};
  const auto through = diffraction_mtf(lens, far, fields, frequencies, {}, 2, shifts);
  ASSERT_EQ(through.columns, 6u);
  for (std::size_t s = 0; s < shifts.size(); ++s) {
    const auto moved = diffraction_mtf(with_film(lens, lens.film_z() + shifts[s]), far, fields, frequencies);
    for (std::size_t field = 0; field < 2; ++field) {
      for (std::size_t k = 0; k < 2; ++k) {
        const MtfPoint &a = through[field][2 * s + k], &b = moved[field][k];
        EXPECT_EQ(a.film_shift_mm, shifts[s]);
        EXPECT_NEAR(a.tangential, b.tangential, 1e-3);
        EXPECT_NEAR(a.sagittal, b.sagittal, 1e-3);
      }
    }
  }
  // Backwards in front of a mirror.
  const auto mirror = diffraction_mtf(parabola(4), far, std::array{0.0}, std::array{30.0}, {}, 1, std::array{0.05});
  const auto moved = diffraction_mtf(with_film(parabola(4), -99.95), far, std::array{0.0}, std::array{30.0});
  EXPECT_NEAR(mirror[0][0].tangential, moved[0][0].tangential, 1e-4);
  EXPECT_LT(moved[0][0].tangential, 0.8);
}

TEST(LensDiffractionMtf, OfWideBlursIsTheGeometricMtf) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f1.1");
  const Lens blurred = with_film(lens, lens.film_z() + 2);
  const std::array fields{0.0, radians(5.0)}, frequencies{0.5, 1.0};
  const auto rays = geometric_mtf(spot_diagram(blurred, far, fields, 32768), frequencies);
  const auto waves = diffraction_mtf(blurred, far, fields, frequencies);
  for (std::size_t i = 0; i < waves.values.size(); ++i) {
    EXPECT_NEAR(waves.values[i].tangential, rays.values[i].tangential, 5e-3) << i;
    EXPECT_NEAR(waves.values[i].sagittal, rays.values[i].sagittal, 5e-3) << i;
  }
}

TEST(LensDiffractionMtf, OfDarkFieldsIsZeroAndThreadsDoNotMatter) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const std::array fields{radians(10.0), radians(80.0)}, frequencies{0.0, 30.0};
  const auto one = diffraction_mtf(lens, far, fields, frequencies),
             more = diffraction_mtf(lens, far, fields, frequencies, {}, 3);
  EXPECT_NEAR(one[0][0].tangential, 1, 1e-12);
  EXPECT_EQ(one[0][1].sagittal, more[0][1].sagittal);
  EXPECT_EQ(one[1][0].tangential, 0);
  EXPECT_EQ(one[1][1].sampling_error, 0);
}

TEST(LensDiffractionMtf, RefusesLensesWithoutImagesAndInvalidNumbers) {
  const std::array axis{0.0}, frequencies{10.0};
  const Lens lens = testing::data_lens("cooke_triplet_50mm_f5");
  testing::expect_error(
      [&] {
        diffraction_mtf(lens, far, axis, frequencies, std::array{1.0, 1.0});
      },
      {"weights", 2, 1});
  testing::expect_error([&] { diffraction_mtf(lens, far, axis, std::array{std::nan("")}); }, {"frequency", "nan"});
  Prescription window;
  window.surfaces = {{.thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 5}, {.thickness = 50}};
  testing::expect_error([&] { diffraction_mtf(compile(window), far, axis, frequencies); }, {"afocal"});
  testing::expect_error([&] { diffraction_mtf(testing::data_lens("cylinder_3.9mm"), far, axis, frequencies); },
                        {"parallel"});
}

}  // namespace diffraction_mtf_test
}  // namespace petzval
