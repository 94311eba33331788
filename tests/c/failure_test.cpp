// SPDX-License-Identifier: Apache-2.0
// Failed calls of the C interface: results are 0 or NULL, set-ups and messages.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "handles.hpp"
#include "petzval/petzval.h"

namespace {

using namespace petzval::testing;

/// N results with bytes as on a used stack.
template <class T, std::size_t n = 1>
struct Filled {
  Filled() {
    std::memset(values.data(), 0xAA, sizeof values);
    if constexpr (requires { values[0].size; }) values[0].size = sizeof(T);
  }
  operator T*() { return values.data(); }
  /// True if all values equal `expected`, or are 0 with the fate PETZVAL_FATE_INVALID.
  bool is_reset(T expected = {}) {
    if constexpr (requires { expected.size; }) expected.size = sizeof(T);
    if constexpr (requires { expected.fate; }) expected.fate = PETZVAL_FATE_INVALID;
    if constexpr (requires { expected.ray.fate; }) expected.ray.fate = PETZVAL_FATE_INVALID;
    if constexpr (requires { expected.importance.fate; }) expected.importance.fate = PETZVAL_FATE_INVALID;
    bool reset = true;
    for (T& value : values) {
      reset = reset && std::memcmp(&value, &expected, sizeof value) == 0;
      std::memset(&value, 0xAA, sizeof value);
      if constexpr (requires { value.size; }) value.size = sizeof(T);
    }
    return reset;
  }
  std::array<T, n> values;
};
#define EXPECT_RESET(call, ...)        \
  do {                                 \
    EXPECT_NE((call), PETZVAL_OK);     \
    EXPECT_TRUE(__VA_ARGS__) << #call; \
  } while (false)

TEST(CFailures, ResultsOfLensesAreReset) {
  const LensHandle lens = read_lens();
  Filled<petzval_glasses*> glasses;
  EXPECT_RESET(petzval_glasses_create("missing.agf", nullptr, glasses), glasses.is_reset());
  Filled<petzval_glass> glass;
  EXPECT_RESET(petzval_glasses_get(nullptr, 0, glass), glass.is_reset());
  petzval_glasses* all = nullptr;
  ASSERT_EQ(petzval_glasses_create(nullptr, nullptr, &all), PETZVAL_OK);
  const std::unique_ptr<petzval_glasses, Free> owner(all);
  EXPECT_RESET(petzval_glasses_get(all, 1u << 30, glass), glass.is_reset());
  Filled<petzval_lens*> opened;
  EXPECT_RESET(petzval_lens_read("missing.json", nullptr, opened), opened.is_reset());
  EXPECT_RESET(petzval_lens_parse("{", 1, nullptr, nullptr, opened), opened.is_reset());
  EXPECT_RESET(petzval_lens_copy(nullptr, opened), opened.is_reset());
  Filled<petzval_lens_info> info;
  EXPECT_RESET(petzval_lens_get_info(nullptr, info), info.is_reset());
  Filled<petzval_surface> surface;
  EXPECT_RESET(petzval_lens_get_surface(nullptr, 0, surface), surface.is_reset());
  EXPECT_RESET(petzval_lens_get_surface(lens.get(), 99, surface), surface.is_reset());
  Filled<char, 4> text;
  Filled<std::size_t> length;
  EXPECT_RESET(petzval_lens_get_text(nullptr, 0, 0, text, 4, length), text.is_reset() && length.is_reset());
  EXPECT_RESET(petzval_lens_get_text(lens.get(), 77, 0, text, 4, length), text.is_reset() && length.is_reset());
  EXPECT_RESET(petzval_lens_report(nullptr, nullptr, 0, 0, text, 4, length), text.is_reset() && length.is_reset());
  EXPECT_EQ(petzval_lens_get_text(lens.get(), PETZVAL_TEXT_NAME, 0, text, 4, length), PETZVAL_TOO_SMALL);
  EXPECT_TRUE(text.is_reset());
  EXPECT_GT(length.values[0], 4u);
  petzval_film film = petzval_film_init();
  film.columns = 77;
  Filled<petzval_film_fit> fit;
  EXPECT_RESET(petzval_lens_fit_film(nullptr, nullptr, 0, 0, &film, fit), fit.is_reset());
  EXPECT_RESET(petzval_lens_fit_film(lens.get(), nullptr, 0, 0, &film, fit), fit.is_reset());
  EXPECT_EQ(film.columns, 77);
  Filled<petzval_choice> choice;
  EXPECT_RESET(petzval_lens_choose_model(nullptr, nullptr, nullptr, choice), choice.is_reset());
  // A size of an older version: members beyond it are the caller's.
  Filled<petzval_lens_info> older;
  older.values[0].size = offsetof(petzval_lens_info, f_number), older.values[0].f_number = -7;
  EXPECT_EQ(petzval_lens_get_info(nullptr, older), PETZVAL_BAD_HANDLE);
  EXPECT_EQ(older.values[0].focal_length_mm, 0);
  EXPECT_EQ(older.values[0].f_number, -7);
}

TEST(CFailures, ResultsOfCamerasAreReset) {
  const LensHandle lens = read_lens();
  const CameraHandle owner = create_camera(lens);
  const petzval_camera* const camera = owner.get();
  Filled<petzval_camera*> made;
  EXPECT_RESET(petzval_camera_create(nullptr, nullptr, nullptr, made), made.is_reset());
  EXPECT_RESET(petzval_camera_read("{}", 2, made), made.is_reset());
  Filled<petzval_camera_info> info;
  EXPECT_RESET(petzval_camera_get_info(nullptr, info), info.is_reset());
  Filled<char, 8> bytes;
  Filled<std::size_t> length;
  EXPECT_RESET(petzval_camera_write(nullptr, bytes, 8, length), bytes.is_reset() && length.is_reset());
  EXPECT_RESET(petzval_camera_write(camera, bytes, 8, nullptr), bytes.is_reset());
  const petzval_sample at{};
  Filled<petzval_ray> ray;
  EXPECT_RESET(petzval_camera_sample(nullptr, &at, ray), ray.is_reset());
  EXPECT_RESET(petzval_camera_sample(camera, nullptr, ray), ray.is_reset());
  Filled<petzval_ray_differential> differential;
  EXPECT_RESET(petzval_camera_sample_differential(nullptr, &at, differential), differential.is_reset());
  EXPECT_RESET(petzval_camera_sample_differential(camera, nullptr, differential), differential.is_reset());
  const std::array<double, 3> place{0, 0, -1000};
  const double nm = 550;
  Filled<petzval_path_wavelength, 65> path;
  const std::vector<double> many(65, nm);
  EXPECT_RESET(petzval_camera_sample_path(nullptr, &at, 65, many.data(), ray, path), ray.is_reset() && path.is_reset());
  EXPECT_RESET(petzval_camera_sample_path(camera, &at, 65, many.data(), ray, path), ray.is_reset() && path.is_reset());
  Filled<petzval_importance, 2> importance;
  EXPECT_RESET(petzval_camera_importance(nullptr, 2, place.data(), place.data(), nullptr, nullptr, importance),
               importance.is_reset());
  EXPECT_RESET(petzval_camera_importance(camera, 2, nullptr, place.data(), nullptr, nullptr, importance),
               importance.is_reset());
  Filled<petzval_connection, 2> connection;
  EXPECT_RESET(petzval_camera_connect(nullptr, 2, place.data(), &nm, &nm, nullptr, nullptr, connection),
               connection.is_reset());
  EXPECT_RESET(petzval_camera_connect(camera, 2, nullptr, &nm, &nm, nullptr, nullptr, connection),
               connection.is_reset());
  Filled<petzval_connection> distant;
  EXPECT_RESET(petzval_camera_connect_distant(camera, nullptr, 0, 0, nm, 0, distant), distant.is_reset());
  Filled<double> pdf;
  EXPECT_RESET(petzval_camera_connection_pdf(camera, place.data(), place.data(), nm, 7, pdf), pdf.is_reset());
  Filled<double, 4> raster;
  Filled<std::uint8_t, 2> visible;
  EXPECT_RESET(petzval_camera_project(nullptr, 2, place.data(), nm, 0, raster, visible),
               raster.is_reset() && visible.is_reset());
  EXPECT_RESET(petzval_camera_project(camera, 2, nullptr, nm, 0, raster, visible),
               raster.is_reset() && visible.is_reset());
  Filled<petzval_psf> psf;
  Filled<float, 5> image;
  EXPECT_RESET(petzval_camera_point_image(nullptr, place.data(), nullptr, psf, image, 5),
               psf.is_reset() && image.is_reset());
  EXPECT_RESET(petzval_camera_point_image(camera, nullptr, nullptr, psf, image, 5), psf.is_reset() && image.is_reset());
}

template <class T, class Samples, class Rays, class Call>
void expect_reset_arrays(const Call& call, const petzval_camera* camera) {
  std::array<Filled<T, 3>, 9> of;
  Filled<std::uint8_t, 3> fates;
  const Samples none{};
  const Rays rays{of[0], of[1], of[2], of[3], of[4], of[5], of[6], fates, of[7], of[8]};
  for (const petzval_camera* const one : {static_cast<const petzval_camera*>(nullptr), camera}) {
    EXPECT_NE(call(one, 3, &none, &rays), PETZVAL_OK);
    for (auto& array : of) EXPECT_TRUE(array.is_reset());
    EXPECT_TRUE(fates.is_reset(PETZVAL_FATE_INVALID));
  }
  EXPECT_EQ(call(nullptr, 3, &none, nullptr), PETZVAL_BAD_HANDLE);
}

TEST(CFailures, ArraysAreReset) {
  const CameraHandle camera = create_camera(read_lens());
  expect_reset_arrays<float, petzval_samples_float, petzval_rays_float>(petzval_camera_sample_float, camera.get());
  expect_reset_arrays<double, petzval_samples_double, petzval_rays_double>(petzval_camera_sample_double, camera.get());
}

std::string written(const petzval_camera* camera) {
  std::size_t length = 0;
  EXPECT_EQ(petzval_camera_write(camera, nullptr, 0, &length), PETZVAL_OK);
  std::string bytes(length, 0);
  EXPECT_EQ(petzval_camera_write(camera, bytes.data(), length, nullptr), PETZVAL_OK);
  return bytes;
}
petzval_status read_back(const std::string& bytes) {
  petzval_camera* camera = nullptr;
  const petzval_status status = petzval_camera_read(bytes.data(), bytes.size(), &camera);
  petzval_camera_free(camera);
  return status;
}

TEST(CFailures, WrittenCamerasAreReadWithAnyUnusedMember) {
  const LensHandle lens = read_lens();
  petzval_film film = petzval_film_init();
  film.columns = 2000000000, film.z_mm = std::numeric_limits<double>::quiet_NaN();  // without has_z
  const CameraHandle camera = create_camera(lens, &film);
  EXPECT_EQ(read_back(written(camera.get())), PETZVAL_OK) << petzval_message();
  petzval_camera_options options = petzval_camera_options_init();
  petzval_camera* made = nullptr;
  options.near_far_origin = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(petzval_camera_create(lens.get(), nullptr, &options, &made), PETZVAL_BAD_ARGUMENT);
}

TEST(CFailures, SetupsWithWrongMembersAreRefusedByName) {
  const CameraHandle camera = create_camera(read_lens());
  const std::string bytes = written(camera.get());
  for (const char* const name : {"width_mm", "columns", "units_per_mm", "configuration", "model"}) {
    for (const char* const wrong : {"{}", "null", "[]", "true"}) {
      const std::string key = '"' + std::string(name) + "\":";
      const std::size_t at = bytes.find(key) + key.size(), end = bytes.find_first_of(",}", at);
      ASSERT_LT(end, bytes.size()) << name;
      EXPECT_NE(read_back(bytes.substr(0, at) + wrong + bytes.substr(end)), PETZVAL_OK) << name << wrong;
      const std::string message = petzval_message();
      EXPECT_NE(message.find(name), std::string::npos) << message;
      EXPECT_EQ(message.find("exception"), std::string::npos) << message;
    }
  }
  for (const char* const wrong : {"1.5", "4294967296"}) {
    const std::size_t at = bytes.find("\"columns\":") + 10;
    EXPECT_EQ(read_back(bytes.substr(0, at) + wrong + bytes.substr(bytes.find(',', at))), PETZVAL_REFUSED) << wrong;
  }
  for (const char* const object : {"film", "camera", "lens", "host"}) {
    const std::size_t at = bytes.find('"' + std::string(object) + "\":");
    EXPECT_EQ(read_back(bytes.substr(0, at) + "\"a\":0,\"b" + bytes.substr(at + 1)), PETZVAL_REFUSED) << object;
    EXPECT_NE(std::string(petzval_message()).find(object), std::string::npos) << petzval_message();
  }
}

TEST(CFailures, DirectionsOfZeroAndTinyUnitsAreRefused) {
  const LensHandle lens = read_lens();
  const std::array<double, 3> zero{0, 0, 0};
  petzval_psf_options how = petzval_psf_options_init();
  how.distant = 1, how.pixels = 8, how.samples = 256;
  petzval_psf psf = petzval_psf_init();
  EXPECT_EQ(petzval_camera_point_image(create_camera(lens).get(), zero.data(), &how, &psf, nullptr, 0),
            PETZVAL_BAD_ARGUMENT);
  EXPECT_NE(std::string(petzval_message()).find("point"), std::string::npos);
  petzval_camera_options options = petzval_camera_options_init();
  petzval_camera* made = nullptr;
  for (const double units : {1e-300, 1e300, -1.0}) {
    options.units_per_mm = units;
    EXPECT_EQ(petzval_camera_create(lens.get(), nullptr, &options, &made), PETZVAL_REFUSED) << units;
    EXPECT_NE(std::string(petzval_message()).find("units_per_mm"), std::string::npos) << petzval_message();
  }
}

}  // namespace
