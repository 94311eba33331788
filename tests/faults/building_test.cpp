// SPDX-License-Identifier: Apache-2.0
// Failing allocations while lenses, cameras and PSF sets are built.
#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "allocations.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {
namespace building_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_all_or_nothing;

using testing::bits;

std::string bits(std::initializer_list<double> numbers) {
  return bits(std::span<const double>(numbers.begin(), numbers.size()));
}

TEST(MemoryEnds, WhileALensIsCompiled) {
  for (const char* id : {"double_gauss_100mm_f2_28deg", "phone_5.6mm_f3.5", "anamorphic_60mm_2x"}) {
    SCOPED_TRACE(id);
    const Prescription p = data_prescription(id);
    expect_all_or_nothing([&] {
      const Lens lens = compile(p);
      const auto hit = trace(lens, Ray<double>{{0.1, 0.2, -10}, {0, 0, 1}});
      return bits({hit.ray.origin.x, hit.ray.origin.y, lens.film_z(), lens.wavelengths_nm()[0]});
    });
  }
}

TEST(MemoryEnds, WhileALensIsFocused) {
  const Lens lens = data_lens("double_gauss_100mm_f2_28deg");
  expect_all_or_nothing([&] { return bits({with_focus(with_f_number(lens, 4), 2000).film_z()}); });
}

/// A ray to the film and a scene point.
std::string seen_by(const Camera& camera) {
  const CameraRay ray = camera.sample({.film = {3, 2}, .pupil_u = 0.3, .pupil_v = 0.4});
  const Projection place = camera.project({100, 50, -2000});
  return bits({ray.ray.origin.x, ray.ray.direction.y, ray.weight, place.film.x, place.film.y});
}

TEST(MemoryEnds, WhileACameraOfAnyModelIsBuilt) {
  const Lens lens = with_focus(with_f_number(data_lens("double_gauss_100mm_f2_28deg"), 4), 2000);
  const Film film{.width_mm = 12, .height_mm = 8, .columns = 48, .rows = 32};
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::thick,
                                ModelKind::polynomial(3), ModelKind::exact_float}) {
    SCOPED_TRACE(name(model));
    expect_all_or_nothing([&] { return seen_by(Camera(lens, film, {.model = model, .threads = 2})); });
  }
}

TEST(MemoryEnds, WhileACameraWithBladesWeightsAndATiltIsBuilt) {
  const Lens lens = with_focus(with_iris(data_lens("double_gauss_100mm_f2_28deg"), {.blades = 6}), 2000);
  const Film film{.width_mm = 12, .height_mm = 8, .columns = 48, .rows = 32, .tilt_rad = radians(3)};
  expect_all_or_nothing([&] {
    return seen_by(Camera(lens, film, {.threads = 2, .bokeh = {.weight_distribution = 3, .weight_strength = 0.7}}));
  });
}

TEST(MemoryEnds, WhilePolynomialsAreFitted) {
  const Lens lens = data_lens("double_gauss_100mm_f2_28deg");
  expect_all_or_nothing([&] {
    const auto polynomial = RayPolynomial::fit(lens, FilmPupilTable::equal_area(lens, 7), 3);
    return bits(std::span<const double>(polynomial.fits().front().direction_by_film));
  });
}

TEST(MemoryEnds, WhileASetOfPsfsIsMade) {
  const Lens open = data_lens("double_gauss_100mm_f2_28deg"), lens = with_focus(open, 2000);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto kernel = [&](double field_deg) {
    return psf_kernel(lens, open, {radians(field_deg), -infinity}, 0, {.samples = 4096, .pixels = 9, .threads = 3});
  };
  const auto shown = [](const PsfKernel& k) {
    return bits(std::span<const float>(k.light)) + bits(std::span<const float>(k.hits_x));
  };
  expect_all_or_nothing([&] { return shown(kernel(7)); });
  const std::vector<PsfKernel> kernels{kernel(0), kernel(7)};
  expect_all_or_nothing([&] {
    const PsfSet set({{0, 7}, {infinity}, {d_line_nm}, {2}}, kernels);
    return shown(set.kernels()[1]);
  });
  const PsfSet set({{0, 7}, {infinity}, {d_line_nm}, {2}}, kernels);
  expect_all_or_nothing([&] { return shown(set.at({3, infinity, d_line_nm, 2})); });
}

/// A truncated table would be another illuminant.
TEST(MemoryEnds, WhileTablesOfColoursAreRead) {
  const std::filesystem::path glass = std::filesystem::path(PETZVAL_TEST_DATA) / "glass";
  expect_all_or_nothing([&] {
    const ColourMatching table = ColourMatching::load(glass / "cie1931_2deg_5nm.csv");
    const Spectrum light = illuminant("D65", glass / "cie_daylight_10nm.csv");
    const auto xyz = tristimulus(light, table);
    return bits({xyz[0], xyz[1], xyz[2]});
  });
}

}  // namespace building_test
}  // namespace petzval
