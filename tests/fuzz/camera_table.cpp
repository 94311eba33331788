// SPDX-License-Identifier: Apache-2.0
// Camera tables with changed numbers: no function of petzval_camera.h reads outside of a table that pz_valid() accepts.
#include <array>
#include <cmath>
#include <vector>

#include "bytes.hpp"
#include "fixed_lenses.hpp"
#include "laws.hpp"
#include "petzval/camera/camera.hpp"

namespace {

std::vector<float> table;
/// A number of the table. The form of petzval_camera.h for shaders reads the table by a macro.
float number_at(int i) {
  petzval::fuzz::require(i >= 0 && static_cast<std::size_t>(i) < table.size(), "numbers lie within the table");
  return table[static_cast<std::size_t>(i)];
}
using std::sqrt;
#define PETZVAL_GLSL
#define PETZVAL_TABLE(i) number_at(i)
#include "petzval/petzval_camera.h"

using namespace petzval;
using fuzz::Bytes;

std::vector<std::vector<float>> tables() {
  const auto of = [](const Lens& lens, ModelKind model = ModelKind::exact_float) {
    return camera_table(Camera(lens, {.width_mm = 6, .height_mm = 4, .margin_mm = 1}, {.model = model}));
  };
  const Iris iris{.blades = 5, .roundness = 0.2, .rotation_rad = 0.3};
  const Lens usual = fuzz::coloured("double_gauss_100mm_f2.0"), flat = fuzz::coloured("anamorphic_60mm_2x");
  return {of(usual),
          of(with_iris(usual, iris)),
          of(usual, ModelKind::polynomial(5)),
          of(flat),
          of(with_iris(flat, iris)),
          of(flat, ModelKind::polynomial(3)),
          of(fuzz::coloured("catadioptric_mangin_1000mm_f7.5")),
          of(compile(testing::data_prescription("phone_5.6mm_f3.5")))};
}

/// Changes a number, mostly of the head.
void change(Bytes& bytes) {
  const int low = bytes.byte(), high = bytes.byte();
  const auto most = static_cast<int>(table.size()) - 1;
  const int at = high < 200 && most >= PZ_HEAD ? low % PZ_HEAD : (high * 65536 + low * 256 + bytes.byte()) % (most + 1);
  float& number = table[static_cast<std::size_t>(at)];
  switch (bytes.count(0, 5)) {
    case 0: number = static_cast<float>(bytes.count(0, 255)); break;
    case 1: number += static_cast<float>(bytes.count(-2, 2)); break;
    case 2: number = static_cast<float>(most - bytes.count(0, 255)); break;
    case 3: number *= static_cast<float>(bytes.count(-2, 4)); break;
    case 4: number = table[static_cast<std::size_t>(bytes.byte()) % table.size()]; break;
    default: number = static_cast<float>(bytes.wild());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto all = tables();
  Bytes bytes(data, size);
  const auto& whole = all[bytes.byte() % all.size()];
  table.assign(whole.begin(), whole.end() - (bytes.one_in(16) ? 1 + bytes.count(0, 255) : 0));
  if (bytes.one_in(2)) table[1] = static_cast<float>(table.size());
  const int changes = bytes.count(0, 3);
  for (int i = 0; i < changes; ++i) change(bytes);
  table.shrink_to_fit();
  const bool valid = pz_valid(static_cast<int>(table.size()));
  fuzz::require(valid || changes > 0 || table.size() < whole.size(), "a table of a camera is valid");
  if (!valid) return 0;
  const auto number = [&](double least, double most) { return static_cast<float>(bytes.number(least, most)); };
  for (int i = 0; i < 4; ++i) {
    const float nm = i == 0 ? whole[static_cast<std::size_t>(whole[PZ_WAVELENGTHS])] : number(400, 700);
    const float x = number(-5, 5), y = number(-4, 4), u = number(0, 1), v = number(0, 1);
    const pz_point film = i < 2 ? pz_xy(x, y) : pz_film_point(number(-20, 2000), number(-20, 1500));
    const pz_ray_differential ray = pz_sample_differential(film.x, film.y, u, v, nm);
    pz_sample(film.x, film.y, u, v, nm);
    const pz_vector origin = ray.ray.fate == 0 ? ray.ray.origin : pz_xyz(x, y, number(-9, 0));
    const pz_vector out = ray.ray.fate == 0 ? ray.ray.direction : pz_xyz(0, 0, -1), in = pz_xyz(-out.x, -out.y, -out.z);
    pz_raster(pz_importance(origin, in, nm).film);
    pz_raster(pz_ghost_of(origin, in, static_cast<int>(nm) % 8 - 1, static_cast<int>(nm) % 9, nm).film);
    const pz_vector from = pz_along(origin, number(0, 5000), out);
    const pz_connection c = pz_connect(from, u, v, nm);
    pz_pdf(from, c.direction, nm);
  }
  return 0;
}
