// SPDX-License-Identifier: Apache-2.0
// Calls of the C interface with null handles, structs of any size and any numbers: each call returns a status, with a
// message unless it succeeds, and rays are finite.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "laws.hpp"
#include "petzval/petzval.h"

namespace {

using petzval::fuzz::Bytes;
using petzval::fuzz::require;

struct Free {
  void operator()(petzval_lens* lens) const { petzval_lens_free(lens); }
  void operator()(petzval_camera* camera) const { petzval_camera_free(camera); }
};
using LensHandle = std::unique_ptr<petzval_lens, Free>;
using CameraHandle = std::unique_ptr<petzval_camera, Free>;

petzval_status checked(petzval_status status) {
  require(status >= PETZVAL_OK && status <= PETZVAL_TOO_SMALL, "a status is one of the list");
  require(status == PETZVAL_OK || *petzval_message() != 0, "a failed call has a message");
  return status;
}

/// Sets members of a struct, and sometimes its size, to any values.
template <class T>
T* spoilt(T& value, Bytes& bytes) {
  for (int i = bytes.count(0, 3); i > 0; --i) {
    const std::size_t at = static_cast<std::size_t>(bytes.byte()) * 8 % (sizeof value - 8) / 8 * 8 + 8;
    const double number = bytes.wild();
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    const std::int32_t pair[2] = {bytes.one_in(16) ? most : bytes.count(-3, 200), bytes.count(-3, 9)};
    std::memcpy(reinterpret_cast<char*>(&value) + at, bytes.one_in(2) ? static_cast<const void*>(&number) : pair, 8);
  }
  // At most the size of the struct, which the caller promises to be readable.
  if (bytes.one_in(20)) value.size = static_cast<std::size_t>(bytes.byte()) % (sizeof value + 1);
  return bytes.one_in(20) ? nullptr : &value;
}

const petzval_lens* shared_lens() {
  static const LensHandle lens = [] {
    petzval_lens_options options = petzval_lens_options_init();
    static const std::array<double, 3> nm{450, 550, 650};
    options.wavelengths_nm = nm.data(), options.wavelength_count = nm.size();
    petzval_lens* made = nullptr;
    const std::string file = std::string(PETZVAL_TEST_DATA) + "/lenses/double_gauss_100mm_f2.0.json";
    require(petzval_lens_read(file.c_str(), &options, &made) == PETZVAL_OK, "the lens is read");
    return LensHandle(made);
  }();
  return lens.get();
}

LensHandle changed_lens(Bytes& bytes) {
  petzval_lens* copy = nullptr;
  checked(petzval_lens_copy(bytes.one_in(30) ? nullptr : shared_lens(), &copy));
  if (bytes.one_in(2)) checked(petzval_lens_set_f_number(copy, bytes.number(1.5, 64)));
  if (bytes.one_in(4)) {
    const int blades = bytes.count(-2, 40);
    const double roundness = bytes.number(-1.5, 1.5), rotation = bytes.number(-7, 7);
    checked(petzval_lens_set_iris(copy, blades, roundness, rotation));
  }
  if (bytes.one_in(2)) {
    const double distance = bytes.number(50, 1e5);
    checked(petzval_lens_set_focus(copy, distance, bytes.count(-1, 4)));
  }
  petzval_lens_info info = petzval_lens_info_init();
  checked(petzval_lens_get_info(copy, spoilt(info, bytes)));
  return LensHandle(copy);
}

void sampled(const petzval_camera* camera, Bytes& bytes) {
  petzval_sample at{};
  at.raster_x = bytes.number(-10, 50), at.raster_y = bytes.number(-10, 50);
  at.pupil_u = bytes.number(0, 1), at.pupil_v = bytes.number(0, 1);
  at.wavelength_nm = bytes.number(300, 900), at.time = bytes.number(0, 1);
  petzval_ray ray;
  petzval_ray_differential differential;
  if (checked(petzval_camera_sample(camera, &at, &ray)) == PETZVAL_OK) {
    double sum = ray.weight + ray.pdf_film + ray.pdf_pupil + ray.pdf_direction;
    for (int k = 0; k < 3; ++k) sum += ray.origin[k] + ray.direction[k];
    require(std::isfinite(sum) && ray.weight >= 0, "a ray is finite");
  }
  checked(petzval_camera_sample_differential(camera, &at, &differential));
  const std::array<double, 3> nm{bytes.number(300, 900), bytes.number(300, 900), bytes.number(300, 900)};
  std::array<petzval_path_wavelength, 3> path;
  if (checked(petzval_camera_sample_path(camera, &at, static_cast<std::size_t>(bytes.count(0, 3)), nm.data(), &ray,
                                         path.data())) == PETZVAL_OK) {
    require(std::isfinite(path[0].weight), "a weight is finite");
  }
  std::array<double, 6> place;
  for (double& number : place) number = bytes.number(-1000, 1000);
  std::array<petzval_importance, 2> importance;
  std::array<petzval_connection, 2> connection;
  const std::size_t count = static_cast<std::size_t>(bytes.count(0, 2));
  std::array<double, 2> u{bytes.number(0, 1), bytes.number(0, 1)}, raster;
  checked(petzval_camera_importance(camera, count, place.data(), place.data(), nullptr, nullptr, importance.data()));
  if (checked(petzval_camera_connect(camera, count, place.data(), u.data(), u.data(), nullptr, u.data(),
                                     connection.data())) == PETZVAL_OK &&
      count > 0) {
    require(std::isfinite(connection[0].pdf + connection[0].importance.we), "a connection is finite");
  }
  double pdf = 0;
  checked(petzval_camera_connect_distant(camera, place.data(), u[0], u[1], nm[0], u[0], connection.data()));
  checked(petzval_camera_connection_pdf(camera, place.data(), place.data() + 3, nm[0], bytes.count(-1, 2), &pdf));
  checked(petzval_camera_project(camera, 1, place.data(), nm[0], u[0], raster.data(), nullptr));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const LensHandle lens = changed_lens(bytes);
  petzval_film film = petzval_film_init();
  film.columns = 36, film.rows = 24;
  petzval_camera_options options = petzval_camera_options_init();
  constexpr std::array models{"thin", "exact_float", "thick", "pinhole", "polynomial_3", "", "?"};
  if (bytes.one_in(4)) options.near_mm = bytes.number(200, 2000), options.far_mm = bytes.number(1000, 1e5);
  petzval_camera_options* own = spoilt(options, bytes);
  options.model = models[static_cast<std::size_t>(bytes.count(0, 6))];
  options.threads = options.threads > 2 ? 2 : options.threads;
  petzval_camera* made = nullptr;
  checked(petzval_camera_create(lens.get(), spoilt(film, bytes), own, &made));
  const CameraHandle camera(made);
  if (bytes.one_in(3)) {
    const double opens = bytes.number(200, 1e5);
    checked(petzval_camera_set_focus(made, opens, bytes.number(200, 1e5)));
  }
  for (int i = 0; i < 3 && !bytes.empty(); ++i) sampled(made, bytes);
  if (!bytes.one_in(8)) return 0;
  std::size_t length = 0;
  checked(petzval_camera_write(made, nullptr, 0, &length));
  std::string text(length, 0);
  if (length == 0 || checked(petzval_camera_write(made, text.data(), length, nullptr)) != PETZVAL_OK) return 0;
  petzval_camera* again = nullptr;
  require(checked(petzval_camera_read(text.data(), length, &again)) == PETZVAL_OK, "a written camera can be read");
  petzval_camera_free(again);
  return 0;
}
