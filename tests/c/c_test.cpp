// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "handles.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/report.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/io/json.hpp"
#include "petzval/petzval.h"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace {

using petzval::Vec3;
using namespace petzval::testing;

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

LensHandle read(const std::string& file, const std::vector<double>& nm = {}) {
  petzval_lens_options options = petzval_lens_options_init();
  options.wavelengths_nm = nm.data(), options.wavelength_count = nm.size();
  return read_lens(file, &options);
}
LensHandle focused(const std::vector<double>& nm = {}) {
  LensHandle lens = read(double_gauss, nm);
  EXPECT_EQ(petzval_lens_set_f_number(lens.get(), 2.8), PETZVAL_OK);
  EXPECT_EQ(petzval_lens_set_focus(lens.get(), 2000, PETZVAL_FROM_FRONT_VERTEX), PETZVAL_OK);
  return lens;
}
CameraHandle camera_of(const LensHandle& lens, const petzval_camera_options& options = petzval_camera_options_init()) {
  petzval_film film = petzval_film_init();
  film.columns = 600, film.rows = 400;
  return create_camera(lens, &film, &options);
}
petzval::Camera same_camera(const std::vector<double>& nm = {}, petzval::CameraOptions options = {}) {
  const auto prescription = petzval::read_prescription(double_gauss);
  petzval::Lens lens = nm.empty() ? petzval::compile(prescription) : petzval::compile(prescription, nm);
  lens = petzval::with_focus(petzval::with_f_number(lens, 2.8), 2000);
  return {lens, {.columns = 600, .rows = 400}, options};
}
std::vector<petzval_sample> samples(std::size_t count, double time = 0) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<petzval_sample> result(count);
  for (auto& s : result) s = {600 * u(random), 400 * u(random), u(random), u(random), 0, time};
  return result;
}
petzval_ray sample(const petzval_camera* camera, const petzval_sample& at) {
  petzval_ray ray;
  EXPECT_EQ(petzval_camera_sample(camera, &at, &ray), PETZVAL_OK) << petzval_message();
  return ray;
}
Vec3<double> vector_of(const double* v) { return {v[0], v[1], v[2]}; }

TEST(CInterface, RaysEqualThoseOfTheCamera) {
  const CameraHandle camera = camera_of(focused());
  const petzval::Camera same = same_camera();
  for (const petzval_sample& at : samples(200)) {
    const petzval_ray ray = sample(camera.get(), at);
    const petzval::CameraRay other = same.sample(
        {.film = same.film().point(at.raster_x, at.raster_y), .pupil_u = at.pupil_u, .pupil_v = at.pupil_v});
    EXPECT_EQ(vector_of(ray.origin), other.ray.origin);
    EXPECT_EQ(vector_of(ray.direction), other.ray.direction);
    EXPECT_EQ(ray.weight, other.weight);
    EXPECT_EQ(ray.pdf_direction, other.pdf_direction);
    EXPECT_EQ(ray.fate, static_cast<int>(other.fate));
  }
}

TEST(CInterface, BatchesEqualSingleRays) {
  petzval_camera_options options = petzval_camera_options_init();
  options.frame = PETZVAL_FRAME_MITSUBA, options.origin = PETZVAL_FROM_FILM;
  const CameraHandle camera = camera_of(focused(), options);
  const auto singles = samples(700);  // more than one block
  std::array<std::vector<double>, 12> in;
  std::array<std::vector<float>, 12> floats;
  for (auto& values : in) values.resize(singles.size());
  for (auto& values : floats) values.resize(singles.size());
  std::vector<std::uint8_t> fates(singles.size());
  for (std::size_t i = 0; i < singles.size(); ++i) {
    const petzval_sample& s = singles[i];
    in[0][i] = s.raster_x, in[1][i] = s.raster_y, in[2][i] = s.pupil_u, in[3][i] = s.pupil_v;
    for (int k = 0; k < 4; ++k) floats[k][i] = static_cast<float>(in[k][i]);
  }
  const petzval_samples_double from{in[0].data(), in[1].data(), in[2].data(), in[3].data(), nullptr, nullptr};
  const petzval_rays_double to{in[4].data(), in[5].data(),  in[6].data(), in[7].data(),  in[8].data(),
                               in[9].data(), in[10].data(), fates.data(), in[11].data(), nullptr};
  ASSERT_EQ(petzval_camera_sample_double(camera.get(), singles.size(), &from, &to), PETZVAL_OK);
  const petzval_samples_float from_float{floats[0].data(), floats[1].data(), floats[2].data(),
                                         floats[3].data(), nullptr,          nullptr};
  const petzval_rays_float to_float{floats[4].data(), floats[5].data(), floats[6].data(),  floats[7].data(),
                                    floats[8].data(), floats[9].data(), floats[10].data(), nullptr,
                                    nullptr,          nullptr};
  ASSERT_EQ(petzval_camera_sample_float(camera.get(), singles.size(), &from_float, &to_float), PETZVAL_OK);
  for (std::size_t i = 0; i < singles.size(); ++i) {
    const petzval_ray ray = sample(camera.get(), singles[i]);
    EXPECT_EQ(fates[i], ray.fate);
    EXPECT_NEAR(in[10][i], ray.weight, 1e-6 * ray.weight);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(in[4 + k][i], ray.origin[k], 1e-7);
      EXPECT_NEAR(in[7 + k][i], ray.direction[k], 1e-6);
      if (ray.fate == PETZVAL_FATE_TRANSMITTED && floats[10][i] > 0) {
        EXPECT_NEAR(floats[7 + k][i], ray.direction[k], 2e-5);
      }
    }
  }
}

TEST(CInterface, DifferentialsAreDifferencesOfRays) {
  petzval_camera_options options = petzval_camera_options_init();
  options.model = "exact_double", options.frame = PETZVAL_FRAME_PBRT, options.origin = PETZVAL_FROM_FILM;
  const CameraHandle camera = camera_of(focused(), options);
  for (petzval_sample at : samples(50)) {
    petzval_ray_differential found;
    ASSERT_EQ(petzval_camera_sample_differential(camera.get(), &at, &found), PETZVAL_OK);
    if (found.ray.weight == 0) continue;
    // The pupil sample of a neighbour differs a little; its ray must agree to first order in the change of the film.
    petzval_sample right = at;
    right.raster_x += 1;
    const petzval_ray next = sample(camera.get(), right);
    if (next.weight == 0) continue;
    EXPECT_NEAR(next.direction[0] - found.ray.direction[0], found.direction_by_x[0],
                0.05 * std::abs(found.direction_by_x[0]));
    EXPECT_LT(std::abs(found.direction_by_y[0]), std::abs(found.direction_by_x[0]));
    EXPECT_GT(found.direction_by_x[0], 0);  // pbrt: to the right is +x
    EXPECT_LT(found.direction_by_y[1], 0);  // and the next row is lower
  }
}

TEST(CInterface, ImportanceFollowsTheUnitOfTheCamera) {
  const LensHandle lens = focused();
  petzval_camera_options options = petzval_camera_options_init();
  options.frame = PETZVAL_FRAME_PBRT, options.origin = PETZVAL_FROM_FILM;
  const CameraHandle metres = camera_of(lens, options);
  options.units_per_mm = 1;
  const CameraHandle mm = camera_of(lens, options);
  const std::array<double, 3> in_mm{120, 60, 3000}, in_metres{0.12, 0.06, 3};
  for (const petzval_sample& at : samples(100)) {
    petzval_connection small, large;
    ASSERT_EQ(petzval_camera_connect(mm.get(), 1, in_mm.data(), &at.pupil_u, &at.pupil_v, nullptr, nullptr, &small),
              PETZVAL_OK);
    ASSERT_EQ(
        petzval_camera_connect(metres.get(), 1, in_metres.data(), &at.pupil_u, &at.pupil_v, nullptr, nullptr, &large),
        PETZVAL_OK);
    if (small.pdf == 0) continue;
    EXPECT_NEAR(large.pdf / small.pdf, 1, 1e-6);
    EXPECT_NEAR(large.distance / small.distance, 1e-3, 1e-9);
    EXPECT_NEAR(large.importance.raster_x, small.importance.raster_x, 1e-3);
    EXPECT_NEAR(large.importance.raster_y, small.importance.raster_y, 1e-3);
    if (small.importance.we == 0) continue;
    EXPECT_NEAR(large.importance.we / small.importance.we, 1e6, 1);
    // Scene side equals film side: We divided by the density is the weight of the film sample with this ray.
    petzval_importance again;
    ASSERT_EQ(petzval_camera_importance(metres.get(), 1, in_metres.data(), large.direction, nullptr, nullptr, &again),
              PETZVAL_OK);
    EXPECT_NEAR(again.we / large.importance.we, 1, 1e-9);
    double pdf = 0;
    ASSERT_EQ(petzval_camera_connection_pdf(metres.get(), in_metres.data(), large.direction, 0, 0, &pdf), PETZVAL_OK);
    EXPECT_NEAR(pdf / large.pdf, 1, 1e-5);
  }
}

TEST(CInterface, WavelengthsOfAPathHaveTheLightOfSingleWavelengths) {
  const std::vector<double> nm{420, 500, 580, 660};
  const CameraHandle camera = camera_of(focused(nm));
  std::array<double, 4> hero_only{}, combined{};
  const auto all = samples(20000);
  for (const petzval_sample& at : all) {
    std::array<petzval_path_wavelength, 4> found;
    petzval_ray ray;
    for (std::size_t hero = 0; hero < 4; ++hero) {  // each wavelength of the set is the hero once
      std::vector<double> order = nm;
      std::swap(order[0], order[hero]);
      ASSERT_EQ(petzval_camera_sample_path(camera.get(), &at, 4, order.data(), &ray, found.data()), PETZVAL_OK);
      hero_only[hero] += ray.weight;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t own = k == 0 ? hero : k == hero ? 0 : k;
        combined[own] += found[k].weight / 4;
      }
      if (ray.weight > 0) {
        EXPECT_NEAR(found[0].raster_x, at.raster_x, 0.02);
        EXPECT_LT(std::hypot(found[1].raster_x - at.raster_x, found[1].raster_y - at.raster_y), 3);
      }
    }
  }
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(combined[k] / hero_only[k], 1, 2e-3);
}

TEST(CInterface, FocusInPlaceIsThatOfANewCamera) {
  for (const char* const model : {"exact_float", "exact_double"}) {
    petzval_camera_options options = petzval_camera_options_init();
    options.model = model, options.near_mm = 800, options.far_mm = infinity;
    const CameraHandle moving = camera_of(focused(), options);
    options = petzval_camera_options_init();
    options.model = model;
    for (const double distance : {800.0, 2000.0, 9000.0, infinity}) {
      ASSERT_EQ(petzval_camera_set_focus(moving.get(), distance, distance), PETZVAL_OK) << petzval_message();
      LensHandle lens = focused();
      ASSERT_EQ(petzval_lens_set_focus(lens.get(), distance, PETZVAL_FROM_FRONT_VERTEX), PETZVAL_OK);
      const CameraHandle fixed = camera_of(lens, options);
      petzval_camera_info one = petzval_camera_info_init(), two = one;
      petzval_camera_get_info(moving.get(), &one), petzval_camera_get_info(fixed.get(), &two);
      EXPECT_NEAR(one.film_z_mm, two.film_z_mm, 1e-9);
      double weights_one = 0, weights_two = 0;
      for (const petzval_sample& at : samples(20000, 0.7)) {  // the time does not matter
        const petzval_ray ray = sample(fixed.get(), at);
        weights_two += ray.weight, weights_one += sample(moving.get(), at).weight;
        if (ray.weight == 0) continue;
        const std::array<double, 3> back{-ray.direction[0], -ray.direction[1], -ray.direction[2]};
        petzval_importance found;
        ASSERT_EQ(petzval_camera_importance(moving.get(), 1, ray.origin, back.data(), nullptr, nullptr, &found),
                  PETZVAL_OK);
        EXPECT_NEAR(found.raster_x, at.raster_x, 0.02);
        EXPECT_NEAR(found.raster_y, at.raster_y, 0.02);
      }
      EXPECT_NEAR(weights_one / weights_two, 1, 2e-3) << distance;
    }
    EXPECT_EQ(petzval_camera_set_focus(moving.get(), 700, 700), PETZVAL_REFUSED);
    EXPECT_EQ(petzval_camera_set_focus(moving.get(), nan, 900), PETZVAL_REFUSED);
  }
  EXPECT_EQ(petzval_camera_set_focus(camera_of(focused()).get(), 900, 900), PETZVAL_BAD_ARGUMENT);
}

TEST(CInterface, WrittenCamerasHaveTheSameRays) {
  petzval_glasses* own = nullptr;
  ASSERT_EQ(petzval_glasses_create(nullptr, nullptr, &own), PETZVAL_OK);
  const std::unique_ptr<petzval_glasses, Free> glasses(own);
  EXPECT_GT(petzval_glasses_count(own), 1000u);
  petzval_lens_options how = petzval_lens_options_init();
  const std::array<double, 3> nm{450, 550, 650};
  how.wavelengths_nm = nm.data(), how.wavelength_count = nm.size(), how.glasses = own, how.primary_nm = 550;
  petzval_lens* read_lens = nullptr;
  ASSERT_EQ(petzval_lens_read(double_gauss.c_str(), &how, &read_lens), PETZVAL_OK) << petzval_message();
  const LensHandle lens(read_lens);
  petzval_lens_set_iris(read_lens, 7, 0.2, 0.1), petzval_lens_set_f_number(read_lens, 4);
  petzval_lens_set_focus(read_lens, infinity, PETZVAL_FROM_FRONT_VERTEX);
  petzval_camera_options options = petzval_camera_options_init();
  options.frame = PETZVAL_FRAME_PBRT, options.near_mm = 900, options.far_mm = infinity;
  const CameraHandle camera = camera_of(lens, options);
  ASSERT_EQ(petzval_camera_set_focus(camera.get(), 1000, 1500), PETZVAL_OK) << petzval_message();
  std::size_t length = 0;
  ASSERT_EQ(petzval_camera_write(camera.get(), nullptr, 0, &length), PETZVAL_OK);
  std::string bytes(length, 0);
  EXPECT_EQ(petzval_camera_write(camera.get(), bytes.data(), length - 1, nullptr), PETZVAL_TOO_SMALL);
  ASSERT_EQ(petzval_camera_write(camera.get(), bytes.data(), length, nullptr), PETZVAL_OK);
  petzval_camera* again = nullptr;
  ASSERT_EQ(petzval_camera_read(bytes.data(), length, &again), PETZVAL_OK) << petzval_message();
  const CameraHandle copy(again);
  for (petzval_sample at : samples(300, 0.4)) {
    at.wavelength_nm = 500;
    const petzval_ray one = sample(camera.get(), at), two = sample(again, at);
    EXPECT_EQ(std::memcmp(&one, &two, sizeof one), 0);
  }
  for (const char* const wrong : {"", "{", "{}", "[1]", R"({"format": "petzval-camera 2"})"}) {
    EXPECT_EQ(petzval_camera_read(wrong, std::strlen(wrong), &again), PETZVAL_REFUSED) << wrong;
    EXPECT_EQ(again, nullptr);
  }
}

TEST(CInterface, LensesOpenAndCloseAndRefusalsChangeNothing) {
  const LensHandle lens = read(double_gauss);
  const auto f_number = [&] {
    petzval_lens_info info = petzval_lens_info_init();
    EXPECT_EQ(petzval_lens_get_info(lens.get(), &info), PETZVAL_OK);
    return info.f_number;
  };
  const double wide = f_number();
  ASSERT_EQ(petzval_lens_set_f_number(lens.get(), 8), PETZVAL_OK);
  EXPECT_NEAR(f_number(), 8, 1e-9);
  ASSERT_EQ(petzval_lens_set_f_number(lens.get(), 4), PETZVAL_OK);
  EXPECT_NEAR(f_number(), 4, 1e-9);
  for (const double wrong : {wide / 1.1, 0.0, -2.0, nan, infinity}) {
    EXPECT_EQ(petzval_lens_set_f_number(lens.get(), wrong), PETZVAL_REFUSED) << wrong;
    EXPECT_NEAR(f_number(), 4, 1e-9);
  }
  EXPECT_EQ(petzval_lens_set_focus(lens.get(), 20, PETZVAL_FROM_FILM), PETZVAL_REFUSED);
  EXPECT_EQ(petzval_lens_set_focus(lens.get(), 2000, 9), PETZVAL_BAD_ARGUMENT);
  EXPECT_EQ(petzval_lens_set_iris(lens.get(), 2, 0, 0), PETZVAL_REFUSED);
}

TEST(CInterface, FittedFilmsMakePointsSharp) {
  const LensHandle lens = focused();
  const std::array<petzval_focus_point, 3> points{
      {{{-300, -200, -1500}, 0, 1}, {{400, -150, -2500}, 0, 1}, {{0, 500, -4000}, 0, 1}}};
  petzval_film film = petzval_film_init();
  petzval_film_fit fit = petzval_film_fit_init();
  ASSERT_EQ(petzval_lens_fit_film(lens.get(), points.data(), 3, 0.35, &film, &fit), PETZVAL_OK) << petzval_message();
  EXPECT_NE(film.tilt_rad, 0);
  EXPECT_EQ(fit.upright, 0);
  const double tilted = fit.rms_mm;
  film = petzval_film_init();
  ASSERT_EQ(petzval_lens_fit_film(lens.get(), points.data(), 3, 0, &film, &fit), PETZVAL_OK);
  EXPECT_EQ(film.tilt_rad, 0);
  EXPECT_EQ(film.has_z, 1);
  EXPECT_GT(fit.rms_mm, 5 * tilted);
  EXPECT_EQ(petzval_lens_fit_film(lens.get(), nullptr, 0, 0.35, &film, &fit), PETZVAL_REFUSED);
}

TEST(CInterface, ImagesOfPointsContainTheThroughput) {
  const CameraHandle camera = camera_of(focused());
  const std::array<double, 3> point{0, 250, -2200};
  petzval_psf_options options = petzval_psf_options_init();
  options.pixels = 32, options.samples = 1 << 14;
  petzval_psf psf = petzval_psf_init();
  std::vector<float> image(32 * 32);
  ASSERT_EQ(petzval_camera_point_image(camera.get(), point.data(), &options, &psf, image.data(), image.size()),
            PETZVAL_OK)
      << petzval_message();
  double sum = 0;
  for (const float value : image) sum += value;
  EXPECT_NEAR(sum, psf.throughput, 1e-5);
  std::array<double, 2> raster;
  ASSERT_EQ(petzval_camera_project(camera.get(), 1, point.data(), 0, 0, raster.data(), nullptr), PETZVAL_OK);
  EXPECT_NEAR(psf.centroid_mm[1], (raster[1] - 200) * 24 / 400, 0.2);
  EXPECT_LT(psf.centroid_mm[1], -5);
  EXPECT_EQ(petzval_camera_point_image(camera.get(), point.data(), &options, &psf, image.data(), 100),
            PETZVAL_TOO_SMALL);
}

TEST(CInterface, GhostsEqualTheLibrary) {
  const LensHandle lens = focused();
  petzval_film film = petzval_film_init();
  film.columns = 60, film.rows = 40;
  petzval_camera_options mitsuba = petzval_camera_options_init();
  mitsuba.frame = PETZVAL_FRAME_MITSUBA;
  const CameraHandle camera = create_camera(lens, &film, &mitsuba);
  const petzval::Camera same = same_camera();
  const petzval::ScenePoint light{{200, 300, -2000}, true};
  petzval::Film small = same.film();
  small.columns = 60, small.rows = 40;
  const auto expected = petzval::ghost_pairs(same.lens(), light, {.tolerance = 1e-2}).pairs;
  const petzval::Wavelength primary[1];
  std::vector<float> irradiance(60 * 40), picture(60 * 40, -1);
  petzval::add_ghosts(same.lens(), light, small, primary, irradiance);

  // Mitsuba looks along +z with +x to the left.
  const std::array<double, 3> point{-200, 300, 2000};
  petzval_ghosts_options options = petzval_ghosts_options_init();
  options.distant = 1, options.tolerance = 1e-2, options.threads = 2;
  std::array<petzval_ghost, 4> pairs;
  std::size_t count = 0;
  const auto ghosts = [&](std::size_t floats) {
    return petzval_ghosts(camera.get(), point.data(), &options, pairs.data(), pairs.size(), &count, picture.data(),
                          floats);
  };
  ASSERT_EQ(ghosts(picture.size()), PETZVAL_OK) << petzval_message();
  ASSERT_EQ(count, expected.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(pairs[i].first), expected[i].first);
    EXPECT_EQ(static_cast<std::size_t>(pairs[i].second), expected[i].second);
    EXPECT_NEAR(pairs[i].energy / expected[i].energy, 1, 1e-9);
    EXPECT_NEAR(pairs[i].centre_mm[0], expected[i].centre.x, 1e-6);
  }
  const float most = *std::ranges::max_element(irradiance);
  EXPECT_GT(most, 0);
  for (std::size_t i = 0; i < picture.size(); ++i) EXPECT_NEAR(picture[i], irradiance[i], 1e-5f * most);

  EXPECT_EQ(ghosts(picture.size() - 1), PETZVAL_TOO_SMALL);
  EXPECT_EQ(count, 0u);
  EXPECT_EQ(picture[0], 0);
  options.film_reflectance = 2;
  EXPECT_EQ(ghosts(picture.size()), PETZVAL_REFUSED);
}

TEST(CInterface, ChosenModelMeetsTheRequirements) {
  const LensHandle lens = focused();
  petzval_requirements wanted = petzval_requirements_init();
  wanted.max_px = 0.5, wanted.pupil_shape = 0.1;
  petzval_choice choice = petzval_choice_init();
  ASSERT_EQ(petzval_lens_choose_model(lens.get(), nullptr, &wanted, &choice), PETZVAL_OK) << petzval_message();
  EXPECT_LE(choice.max_px, 0.5);
  EXPECT_LE(choice.pupil_shape, 0.1);
  EXPECT_TRUE(petzval::model_named(choice.model)) << choice.model;
  EXPECT_GT(std::strlen(choice.reasons), 10u);
}

TEST(CInterface, StructsOfOtherVersionsAreUnderstoodOrRefused) {
  const LensHandle lens = focused();
  petzval_camera* camera = nullptr;
  struct Newer {
    petzval_film film;
    double added;
  } newer{petzval_film_init(), 0};
  newer.film.size = sizeof newer;
  newer.film.columns = 100;
  ASSERT_EQ(petzval_camera_create(lens.get(), &newer.film, nullptr, &camera), PETZVAL_OK) << petzval_message();
  petzval_camera_free(camera);
  newer.added = 1;
  EXPECT_EQ(petzval_camera_create(lens.get(), &newer.film, nullptr, &camera), PETZVAL_BAD_ARGUMENT);
  EXPECT_EQ(camera, nullptr);
  petzval_film older = petzval_film_init();
  older.size = offsetof(petzval_film, shift_x_mm), older.shift_x_mm = 1e6;  // not part of the older struct
  EXPECT_EQ(petzval_camera_create(lens.get(), &older, nullptr, &camera), PETZVAL_OK) << petzval_message();
  petzval_camera_free(camera);
  for (const std::size_t wrong : {std::size_t{0}, std::size_t{3}, std::size_t{12}, static_cast<std::size_t>(-1)}) {
    petzval_film film = petzval_film_init();
    film.size = wrong;
    EXPECT_EQ(petzval_camera_create(lens.get(), &film, nullptr, &camera), PETZVAL_BAD_ARGUMENT) << wrong;
  }
  petzval_lens_info info = petzval_lens_info_init();
  info.size = offsetof(petzval_lens_info, f_number), info.f_number = -7;
  EXPECT_EQ(petzval_lens_get_info(lens.get(), &info), PETZVAL_OK);
  EXPECT_EQ(info.f_number, -7);  // beyond the older struct
  EXPECT_NEAR(info.focal_length_mm, 100.7, 0.1);
  for (const int version : {0, -1, PETZVAL_C_VERSION + 1}) {
    EXPECT_EQ(petzval_check_version(version), PETZVAL_BAD_ARGUMENT);
  }
}

TEST(CInterface, BadArgumentsGiveAStatusAndAMessage) {
  const LensHandle lens = focused();
  const CameraHandle camera = camera_of(lens);
  petzval_camera* made = nullptr;
  petzval_lens* opened = nullptr;
  petzval_ray ray;
  const petzval_sample at{};
  EXPECT_EQ(petzval_camera_sample(nullptr, &at, &ray), PETZVAL_BAD_HANDLE);
  EXPECT_EQ(petzval_camera_sample(camera.get(), nullptr, &ray), PETZVAL_BAD_ARGUMENT);
  EXPECT_EQ(petzval_camera_sample(camera.get(), &at, nullptr), PETZVAL_BAD_ARGUMENT);
  // A handle of another kind: a language without types cannot detect it.
  EXPECT_EQ(petzval_camera_sample(reinterpret_cast<const petzval_camera*>(lens.get()), &at, &ray), PETZVAL_BAD_HANDLE);
  EXPECT_EQ(petzval_lens_read(nullptr, nullptr, &opened), PETZVAL_BAD_ARGUMENT);
  EXPECT_EQ(petzval_lens_read("missing.json", nullptr, &opened), PETZVAL_REFUSED);
  EXPECT_NE(std::string(petzval_message()).find("missing.json"), std::string::npos);
  EXPECT_EQ(petzval_lens_read("missing.json", nullptr, nullptr), PETZVAL_BAD_ARGUMENT);
  EXPECT_EQ(petzval_camera_create(nullptr, nullptr, nullptr, &made), PETZVAL_BAD_HANDLE);
  EXPECT_EQ(petzval_glasses_count(nullptr), 0u);
  const auto refused = [&](auto change) {
    petzval_camera_options options = petzval_camera_options_init();
    change(options);
    const petzval_status status = petzval_camera_create(lens.get(), nullptr, &options, &made);
    petzval_camera_free(made);
    return status != PETZVAL_OK && made == nullptr;
  };
  EXPECT_TRUE(refused([](auto& o) { o.model = "best"; }));
  EXPECT_TRUE(refused([](auto& o) { o.frame = 7; }));
  EXPECT_TRUE(refused([](auto& o) { o.frame = PETZVAL_FRAME_PBRT, o.units_per_mm = nan; }));
  EXPECT_TRUE(refused([](auto& o) { o.origin = PETZVAL_FROM_FILM; }));  // of the lens frame
  EXPECT_TRUE(refused([](auto& o) { o.normalisation = -1; }));
  EXPECT_TRUE(refused([](auto& o) { o.threads = -3; }));
  EXPECT_TRUE(refused([](auto& o) { o.clamp_wavelengths = 2; }));
  EXPECT_TRUE(refused([](auto& o) { o.near_mm = 5000, o.far_mm = 100; }));
  EXPECT_TRUE(refused([](auto& o) { o.near_mm = nan, o.far_mm = 100; }));
  EXPECT_TRUE(refused([](auto& o) { o.weight_distribution = nan, o.weight_strength = 0.5; }));
  const petzval_sample not_finite{nan, 100, 0.5, 0.5, 0, 0}, no_time{300, 200, 0.5, 0.5, 0, nan};
  EXPECT_EQ(sample(camera.get(), not_finite).weight, 0);
  EXPECT_GT(sample(camera.get(), no_time).weight, 0);  // as 0
  const std::array<double, 3> nowhere{nan, infinity, 0}, zero{0, 0, 0};
  petzval_importance importance;
  EXPECT_EQ(petzval_camera_importance(camera.get(), 1, nowhere.data(), zero.data(), nullptr, nullptr, &importance),
            PETZVAL_OK);
  EXPECT_EQ(importance.fate, PETZVAL_FATE_INVALID);
  petzval_connection connection;
  EXPECT_EQ(
      petzval_camera_connect(camera.get(), 1, nowhere.data(), &nowhere[0], &nowhere[1], nullptr, nullptr, &connection),
      PETZVAL_OK);
  EXPECT_EQ(connection.pdf, 0);
  std::array<double, 2> raster;
  EXPECT_EQ(petzval_camera_project(camera.get(), 1, nowhere.data(), 0, 0, raster.data(), nullptr), PETZVAL_OK);
  EXPECT_TRUE(std::isnan(raster[0]));
  petzval_lens_free(nullptr), petzval_camera_free(nullptr), petzval_glasses_free(nullptr);
}

TEST(CInterface, TextsTellWarningsAndThePrescription) {
  const LensHandle lens = read(double_gauss);
  std::size_t length = 0;
  ASSERT_EQ(petzval_lens_get_text(lens.get(), PETZVAL_TEXT_PRESCRIPTION, 0, nullptr, 0, &length), PETZVAL_OK);
  std::string text(length, 0);
  ASSERT_EQ(petzval_lens_get_text(lens.get(), PETZVAL_TEXT_PRESCRIPTION, 0, text.data(), length, nullptr), PETZVAL_OK);
  petzval_lens* again = nullptr;
  ASSERT_EQ(petzval_lens_parse(text.c_str(), length - 1, "memory", nullptr, &again), PETZVAL_OK) << petzval_message();
  const LensHandle same(again);
  petzval_surface one = petzval_surface_init(), two = one;
  ASSERT_EQ(petzval_lens_get_surface(lens.get(), 3, &one), PETZVAL_OK);
  ASSERT_EQ(petzval_lens_get_surface(again, 3, &two), PETZVAL_OK);
  EXPECT_EQ(std::memcmp(&one, &two, sizeof one), 0);
  EXPECT_EQ(petzval_lens_get_surface(again, 99, &two), PETZVAL_BAD_ARGUMENT);
  std::array<char, 4> small{};
  EXPECT_EQ(petzval_lens_get_text(lens.get(), PETZVAL_TEXT_NAME, 0, small.data(), 4, nullptr), PETZVAL_TOO_SMALL);
  EXPECT_EQ(petzval_lens_get_text(lens.get(), PETZVAL_TEXT_WARNING, 0, small.data(), 4, &length), PETZVAL_OK);
  EXPECT_EQ(length, 0u);
  EXPECT_EQ(petzval_lens_get_text(lens.get(), 77, 0, small.data(), 4, &length), PETZVAL_BAD_ARGUMENT);
}

TEST(CInterface, ReportsEqualTheReportOfTheLensInFocus) {
  const LensHandle lens = focused();
  const auto focused_lens = petzval::with_focus(
      petzval::with_f_number(petzval::compile(petzval::read_prescription(double_gauss)), 2.8), 2000);
  const std::string expected =
      petzval::to_json(petzval::lens_report(focused_lens, {.subject_z = -2000, .fields_deg = {0, 5}, .threads = 2}));
  const std::array fields{0.0, 5.0};
  std::vector<char> text(1 << 20);
  std::size_t length = 0;
  ASSERT_EQ(petzval_lens_report(lens.get(), fields.data(), 2, 0, text.data(), text.size(), &length), PETZVAL_OK);
  EXPECT_EQ(length, expected.size() + 1);
  EXPECT_EQ(std::string(text.data()), expected);
  EXPECT_EQ(petzval_lens_report(lens.get(), nullptr, 0, 0, text.data(), 4, &length), PETZVAL_TOO_SMALL);
  EXPECT_GT(length, 4u);
  EXPECT_EQ(petzval_lens_report(lens.get(), nullptr, 2, 0, nullptr, 0, &length), PETZVAL_BAD_ARGUMENT);
  EXPECT_EQ(petzval_lens_report(lens.get(), nullptr, 0, -1, nullptr, 0, &length), PETZVAL_REFUSED);
}

}  // namespace
