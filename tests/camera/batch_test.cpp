// SPDX-License-Identifier: Apache-2.0
// Batches of camera samples, for every model, film pose and option.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/pupil/f_number.hpp"
#include "settings.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace batch_test {

using testing::data_lens;
using testing::data_prescription;
using testing::random_samples;
using testing::Samples;
using testing::shifted;
using testing::tilted_by;

enum class Wavelengths { primary, index, nm };

struct Case {
  std::string name{};
  ModelKind model = ModelKind::thin;
  Film film{};
  std::function<Lens()> lens{};
  std::function<void(CameraOptions&, const Lens&, const Film&)> options = [](auto&&...) {};
  Wavelengths wavelengths = Wavelengths::primary;
  std::string id{};  ///< if set, the film lies within the declared field of this prescription
  /// Tolerances: weights and densities (relative), rays in double, rays in float (mm, or components of directions).
  double weight = 1e-11, ray = 1e-11, in_float = 1e-4;
  /// Relative difference by other neighbours.
  double neighbours = 0;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Lens focused(const char* id) { return with_focus(data_lens(id), 3000, {.origin = DistanceOrigin::film}); }

Film travelling(Film film, double travel_mm) {
  film.travel_mm = travel_mm;
  return film;
}

std::vector<Case> cases() {
  std::vector<Case> result;
  const auto add = [&](const std::string& what, const auto& kinds,
                       const std::vector<std::pair<std::string, Film>>& films, Case like) {
    for (const ModelKind model : kinds) {
      for (const auto& [pose, film] : films) {
        like.name = what + "_" + std::string(name(model)) + "_" + pose;
        like.model = model, like.film = film;
        result.push_back(like);
        if (model == ModelKind::exact_float) result.back().weight = result.back().ray = 2e-5;
      }
    }
  };
  const Film upright{}, tilted = tilted_by(shifted, 8, 5), travels = travelling(tilted_by(shifted, -4, 2), 1);
  const std::array first_order{ModelKind::thick, ModelKind::thin_two_disc};
  const std::array each_kind{ModelKind::pinhole,     ModelKind::thin,          ModelKind::thin_two_disc,
                             ModelKind::thick,       ModelKind::polynomial(5), ModelKind::exact_float,
                             ModelKind::exact_double};

  const auto double_gauss = [] { return focused("double_gauss_100mm_f2.0"); };
  add("plain", models(), {{"upright", upright}, {"tilted", tilted}, {"travelling", travels}}, {.lens = double_gauss});
  add("aspheric", models(), {{"upright", upright}, {"tilted", tilted_by(shifted, 3, -2)}},
      {.lens = [] { return focused("modern_58mm_f0.95"); }});

  const auto bladed = [double_gauss] {
    return with_iris(with_f_number(double_gauss(), 2.4), {.blades = 5, .roundness = 0.2, .rotation_rad = 0.7});
  };
  add("blades", each_kind, {{"upright", upright}, {"tilted", tilted}}, {.lens = bladed});

  const Film small{.width_mm = 20, .height_mm = 14};
  add("cylinders",
      std::array{ModelKind::thin, ModelKind::thick, ModelKind::polynomial(3), ModelKind::polynomial(7),
                 ModelKind::polynomial(11), ModelKind::exact_float, ModelKind::exact_double},
      {{"upright", small}, {"tilted", tilted_by(small, 6, -3)}, {"travelling", travelling(small, 0.5)}},
      {.lens = [] { return focused("anamorphic_60mm_2x"); }});

  add("cylinders_index", std::array{ModelKind::thin, ModelKind::thick}, {{"upright", small}},
      {.lens = [] { return testing::compiled(data_prescription("anamorphic_60mm_2x"), testing::eight_wavelengths()); },
       .wavelengths = Wavelengths::index});

  for (const auto& [what, controls] : {std::pair<std::string, BokehControls>{"ring", testing::ring},
                                       {"map", testing::mapped()},
                                       {"cats_eye", {.lens_ratio = 1.2, .rate_of_change = 0.8, .keep_light = true}}}) {
    add(what, each_kind, {{"upright", upright}, {"tilted", tilted_by(upright, 3, 0)}},
        {.lens = double_gauss,
         .options = [bokeh = controls](CameraOptions& o, const Lens&, const Film&) { o.bokeh = bokeh; },
         .weight = 1e-8});
  }

  for (const auto& [what, surface, lens] :
       {std::tuple{"surface", true, false}, {"aberrations", false, true}, {"surface_and_aberrations", true, true}}) {
    const auto options = [by_surface = surface, by_lens = lens](CameraOptions& o, const Lens& of, const Film& on) {
      if (by_surface) o.focal_surface = testing::surface_of(of, on, true);
      if (by_lens) o.expressive = testing::aberrations();
    };
    add(what, first_order, {{"upright", upright}, {"tilted", tilted}, {"travelling", travels}},
        {.lens = [] { return data_lens("double_gauss_100mm_f2_28deg"); },
         .options = options,
         .weight = 1e-8,
         .ray = 1e-9,
         .in_float = 1e-6});
  }

  add("transmission_nm", each_kind, {{"upright", upright}},
      {.lens =
           [] {
             return testing::compiled(data_prescription("double_gauss_100mm_f1.35"), {440, 500, 546, 588, 700, 400});
           },
       .options = [](CameraOptions& o, const Lens&, const Film&) { o.transmission = true; },
       .wavelengths = Wavelengths::nm,
       .weight = 1e-3,
       .ray = 1e-6,
       .in_float = 1e-3,
       .neighbours = 1e-6});

  add("surface_nm", std::array{ModelKind::thick}, {{"upright", upright}},
      {.lens =
           [] {
             return testing::compiled(data_prescription("double_gauss_100mm_f2_28deg"), {550, 400, 480, 620, 700});
           },
       .options =
           [](CameraOptions& o, const Lens& of, const Film& on) {
             o.focal_surface = testing::surface_of(of, on, true), o.expressive = testing::aberrations();
           },
       .wavelengths = Wavelengths::nm,
       .weight = 1e-6,
       .ray = 1e-7});

  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8", "tessar_100mm_f2.8", "telephoto_200mm_f1.8",
                         "catadioptric_mangin_1000mm_f7.5"}) {
    const auto eight = [id] { return testing::compiled(data_prescription(id), testing::eight_wavelengths()); };
    std::string what = id;
    std::replace(what.begin(), what.end(), '.', '_');
    add(what + "_nm",
        std::array{ModelKind::pinhole, ModelKind::thin_two_disc, ModelKind::thick, ModelKind::polynomial(5),
                   ModelKind::exact_double},
        {{"upright", upright}}, {.lens = eight, .wavelengths = Wavelengths::nm, .id = id, .weight = 1e-6, .ray = 1e-6});
    if (what.starts_with("double"))
      add("index", models(), {{"upright", upright}}, {.lens = eight, .wavelengths = Wavelengths::index});
  }
  return result;
}

/// Samples of a case. Some are invalid, and their expected fates are returned.
template <class T>
std::vector<std::pair<std::size_t, RayFate>> fill(Samples<T>& samples, const Case& c) {
  constexpr T nan = std::numeric_limits<T>::quiet_NaN(), infinity = std::numeric_limits<T>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (c.wavelengths == Wavelengths::index) samples.wavelengths.push_back(static_cast<std::uint16_t>(i * i % 8));
    if (c.wavelengths == Wavelengths::nm) samples.nm.push_back(400 + static_cast<float>(i * i * 7 % 301));
    if (c.film.travel_mm != 0) samples.times.push_back(static_cast<T>(i % 100) / 80 - T(0.1));
  }
  samples.film_x[3] = nan, samples.film_x[7] = 40, samples.film_y[40] = infinity;
  samples.pupil_u[50] = nan, samples.pupil_v[51] = infinity;
  std::vector<std::pair<std::size_t, RayFate>> fates{{3, RayFate::outside_film},
                                                     {7, RayFate::outside_film},
                                                     {40, RayFate::outside_film},
                                                     {50, RayFate::vignetted},
                                                     {51, RayFate::vignetted}};
  if (c.wavelengths == Wavelengths::index)
    samples.wavelengths[60] = 8, fates.push_back({60, RayFate::outside_spectrum});
  if (c.wavelengths == Wavelengths::nm) {
    const float bad[] = {std::nanf(""), 399, 701, 0, HUGE_VALF, -550};
    for (std::size_t i = 0; i < std::size(bad); ++i) {
      samples.nm[60 + i] = bad[i], fates.push_back({60 + i, RayFate::outside_spectrum});
    }
  }
  return fates;
}

template <class T>
void expect_finite(const Samples<T>& samples, std::size_t i) {
  for (const auto* column : {&samples.x, &samples.y, &samples.z, &samples.dx, &samples.dy, &samples.dz,
                             &samples.weights, &samples.pdf_pupil, &samples.pdf_direction}) {
    EXPECT_TRUE(std::isfinite((*column)[i])) << i;
  }
  EXPECT_EQ(samples.weights[i] > 0, samples.fates[i] == RayFate::transmitted) << i;
}

/// Checks that results do not depend on the batch of a sample and its index; without a tolerance, to the bit.
template <class T>
void expect_independent_of_neighbours(const Camera& camera, const Samples<T>& whole, double tolerance) {
  Samples<T> parts = whole;
  parts.fates.clear();
  std::size_t first = 0;
  for (const std::size_t count : {1, 2, 3, 7, 8, 15, 16, 17, 64, 255, 256, 257, 99}) {
    parts.run(camera, first, count);
    first += count;
  }
  ASSERT_EQ(first, whole.size());
  EXPECT_EQ(whole.fates, parts.fates);
  for (const auto column :
       {&Samples<T>::x, &Samples<T>::y, &Samples<T>::z, &Samples<T>::dx, &Samples<T>::dy, &Samples<T>::dz,
        &Samples<T>::weights, &Samples<T>::pdf_pupil, &Samples<T>::pdf_direction}) {
    const auto& one = whole.*column;
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], (parts.*column)[i], tolerance * std::abs(one[i]));
  }
}

class Batches : public ::testing::TestWithParam<Case> {};

TEST_P(Batches, EqualSingleSamplesForAnyNeighbours) {
  Case c = GetParam();
  const Lens lens = c.lens();
  if (!c.id.empty()) {
    c.film.width_mm = std::min(36.0, 1.6 * testing::declared_radius(data_prescription(c.id), lens));
    c.film.height_mm = c.film.width_mm * 2 / 3;
  }
  CameraOptions options{.model = c.model};
  c.options(options, lens, c.film);
  const Camera camera(lens, c.film, options);
  EXPECT_EQ(camera.model(), c.model);
  auto samples = random_samples(c.film, 1000);
  auto in_float = random_samples<float>(c.film, 1000);
  const auto fates = fill(samples, c);
  fill(in_float, c);
  samples.run(camera), in_float.run(camera);
  for (const auto& [i, fate] : fates) {
    EXPECT_EQ(samples.fates[i], fate) << i;
    EXPECT_EQ(in_float.fates[i], fate) << i;
  }
  expect_independent_of_neighbours(camera, samples, c.neighbours);
  expect_independent_of_neighbours(camera, in_float, c.neighbours);

  int other_fates = 0, other_fates_in_float = 0, transmitted = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    expect_finite(samples, i), expect_finite(in_float, i);
    const CameraRay one = camera.sample(samples.one(i));
    other_fates += one.fate != samples.fates[i];
    other_fates_in_float += in_float.fates[i] != samples.fates[i];
    if (one.fate != samples.fates[i]) continue;
    EXPECT_NEAR(one.pdf_film * c.film.area_mm2(), one.fate == RayFate::outside_film ? 0 : 1, 1e-12) << i;
    EXPECT_NEAR(one.weight, samples.weights[i], c.weight * std::max(one.weight, 1e-3)) << i;
    EXPECT_NEAR(one.pdf_pupil, samples.pdf_pupil[i], c.weight * one.pdf_pupil) << i;
    EXPECT_NEAR(one.pdf_direction, samples.pdf_direction[i], c.weight * one.pdf_direction) << i;
    if (!one) continue;
    ++transmitted;
    EXPECT_NEAR(glm::length(one.ray.direction), 1, c.ray);
    EXPECT_NEAR(glm::length(one.ray.direction - samples.ray(i).direction), 0, c.ray) << i;
    EXPECT_NEAR(glm::length(one.ray.origin - samples.ray(i).origin), 0, 100 * c.ray) << i;
    if (in_float.fates[i] != one.fate) continue;
    EXPECT_NEAR(glm::length(one.ray.direction - in_float.ray(i).direction), 0, c.in_float) << i;
    EXPECT_NEAR(in_float.weights[i] / one.weight, 1, std::max(c.in_float, 1e-4)) << i;
  }
  EXPECT_GT(transmitted, 500);
  EXPECT_LE(other_fates, c.model == ModelKind::exact_float ? 3 : 0);
  EXPECT_LE(other_fates_in_float, 6);
}

INSTANTIATE_TEST_SUITE_P(Camera, Batches, ::testing::ValuesIn(cases()), [](const auto& c) { return c.param.name; });

}  // namespace batch_test
}  // namespace petzval
