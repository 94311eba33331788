// SPDX-License-Identifier: Apache-2.0
// Single samples of a camera have the same bits on every instruction set and compiler. Batches have constant bits on
// the baseline instruction set (PETZVAL_INSTRUCTION_SET=baseline). Both need a C library whose sines and powers equal
// the results of glibc on a processor with FMA. After an intended change of the arithmetic or of a lens in the table,
// the failing test prints the new table.
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "../camera/camera_samples.hpp"
#include "../data_lenses.hpp"
#include "core/instruction_set.hpp"
#include "hash.hpp"
#include "petzval/focus/focus.hpp"

namespace petzval {
namespace camera_bits_test {

struct Row {
  std::string lens;
  ModelKind model;
  std::uint64_t singles, batches;
};

const std::vector<Row> table = {
    {"double_gauss_100mm_f2.0", ModelKind::pinhole, 0x95de91d481eda100, 0xc44b0068b32fe0b7},
    {"double_gauss_100mm_f2.0", ModelKind::thin, 0x1736bf0784da9b98, 0x9f3362f2df78d60},
    {"double_gauss_100mm_f2.0", ModelKind::thin_two_disc, 0x3e277069aaa2d8ad, 0xf7848868468000c3},
    {"double_gauss_100mm_f2.0", ModelKind::thick, 0xf589b7324d7de2e3, 0x6db5caa3508f105f},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(3), 0x2fc48f6f83529441, 0x9feb484684b57d20},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(5), 0x22c798c65bbb180b, 0x4dfcf8d82bb5231b},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(7), 0x1a8d6eb60e797e0, 0xb649c7ab4439745a},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(9), 0x451f2bc7eb16c87a, 0x4bcef033469a7fc3},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(11), 0xb2e458b831c1c968, 0xe76d5a636208cc48},
    {"double_gauss_100mm_f2.0", ModelKind::exact_float, 0x1c878aa854d3588, 0x48f8d2115686cdf5},
    {"double_gauss_100mm_f2.0", ModelKind::exact_double, 0x4bd53a931fd3823c, 0x18da3e5355bb3948},
    {"phone_5.6mm_f3.5", ModelKind::pinhole, 0x72b3889c8f95d291, 0x769784fa9d9abb73},
    {"phone_5.6mm_f3.5", ModelKind::thin, 0xc7205dda91e5d2db, 0x9b63cd48daa236da},
    {"phone_5.6mm_f3.5", ModelKind::thin_two_disc, 0xaf43c60f99a5097, 0x54c8d1ebeec02706},
    {"phone_5.6mm_f3.5", ModelKind::thick, 0x16501feaba227933, 0xe71e97ff6974618e},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(3), 0x241bd11b5203e9f1, 0x7278b2da00090413},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(5), 0xb11321cead5a7122, 0x461a3f651a82a0fa},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(7), 0xc50e485075a18f65, 0x4f14145b13fe8583},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(9), 0xd1476eb83c628863, 0x5bb47fac4f785664},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(11), 0x9c3434de9370ca9f, 0x4df621ef4e5c24fa},
    {"phone_5.6mm_f3.5", ModelKind::exact_float, 0x82276a9c357d11f, 0xe2146c8418ad257},
    {"phone_5.6mm_f3.5", ModelKind::exact_double, 0x97a18e7496b28ed7, 0x29a20a064f9a9c7b},
    {"mirror_newton_200mm_f8", ModelKind::pinhole, 0x2a87c566541ccc6e, 0x549da2be2709df12},
    {"mirror_newton_200mm_f8", ModelKind::thin, 0x43441fb0ba7afbe, 0xf3cbe8841b3a6514},
    {"mirror_newton_200mm_f8", ModelKind::thin_two_disc, 0xfdac0f6e72ae7066, 0xc871fce4c93c4b93},
    {"mirror_newton_200mm_f8", ModelKind::thick, 0x43441fb0ba7afbe, 0xf3cbe8841b3a6514},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(3), 0xb5c75f9595e6893d, 0xdddcfe068f3808fa},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(5), 0xbc77ffad960a8cea, 0x3dd6451466c14022},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(7), 0x3698ad36522e477b, 0x77c5e29f67271491},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(9), 0xfc28aef783a2e09d, 0x751090de5a035cd},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(11), 0xcfa86ec59c81c090, 0x751090de5a035cd},
    {"mirror_newton_200mm_f8", ModelKind::exact_float, 0xd0ab41fa2e88d08b, 0x35b621c9dc077884},
    {"mirror_newton_200mm_f8", ModelKind::exact_double, 0xec6e7ab49a874c3a, 0xa76f0f1f31891cfa},
};

struct Scene {
  const char* lens;
  double side;  ///< side of the film, mm
};
constexpr Scene scenes[] = {{"double_gauss_100mm_f2.0", 24}, {"phone_5.6mm_f3.5", 3}, {"mirror_newton_200mm_f8", 15}};

Camera camera_of(const Scene& scene, ModelKind model) {
  const Lens lens = with_iris(with_focus(testing::data_lens(scene.lens), 20000), {.blades = 7});
  return {lens, {.width_mm = scene.side, .height_mm = scene.side}, {.model = model}};
}

std::uint64_t singles(const Camera& camera) {
  const auto samples = testing::random_samples<double>(camera.film(), 300);
  testing_bits::Hash h;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CameraRay found = camera.sample(samples.one(i));
    for (int k = 0; k < 3; ++k) h.take(found.ray.origin[k]), h.take(found.ray.direction[k]);
    h.take(static_cast<std::uint64_t>(found.fate));
    for (const double value : {found.weight, found.pdf_pupil, found.pdf_direction}) h.take(value);
  }
  return h.value();
}

std::uint64_t batches(const Camera& camera) {
  auto samples = testing::random_samples<float>(camera.film(), 300);
  samples.run(camera);
  testing_bits::Hash h;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    h.take(static_cast<std::uint64_t>(samples.fates[i]));
    for (const auto* column : {&samples.x, &samples.y, &samples.z, &samples.dx, &samples.dy, &samples.dz,
                               &samples.weights, &samples.pdf_pupil, &samples.pdf_direction}) {
      h.take((*column)[i]);
    }
  }
  return h.value();
}

/// Math functions that lenses, irises and tables use.
std::uint64_t c_library() {
  testing_bits::Hash h;
  for (int i = 1; i <= 1000; ++i) {
    const double x = i / 300.0;
    for (const double value : {std::sin(x), std::cos(x), std::tan(x), std::atan(x), std::atan2(x, 0.7), std::exp(x),
                               std::log(x), std::pow(x, 1.7), std::asin(x / 4), std::acos(x / 4), std::hypot(x, 0.7)}) {
      h.take(value);
    }
  }
  return h.value();
}

std::string text(const Row& row) {
  std::ostringstream line;
  line << "    {\"" << row.lens << "\", ModelKind::" << name(row.model) << ", 0x" << std::hex << row.singles << ", 0x"
       << row.batches << "},\n";
  return line.str();
}

TEST(CameraBits, EqualTheTable) {
  if (instruction_sets().size() > 1) GTEST_SKIP() << "wider instruction sets give other bits";
  constexpr std::uint64_t of_the_table = 0x4935b4f378316858;
  if (c_library() != of_the_table) GTEST_SKIP() << "this C library gives other bits: 0x" << std::hex << c_library();
  std::string found, wanted;
  for (const Row& row : table) wanted += text(row);
  for (const Scene& scene : scenes) {
    for (const ModelKind model : models()) {
      const Camera camera = camera_of(scene, model);
      found += text({scene.lens, model, singles(camera), batches(camera)});
    }
  }
  EXPECT_TRUE(found == wanted) << "The table is now:\n" << found;
}

}  // namespace camera_bits_test
}  // namespace petzval
