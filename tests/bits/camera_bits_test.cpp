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
    {"double_gauss_100mm_f2.0", ModelKind::pinhole, 0xf343a642a33c9159, 0xea670e2294698fd6},
    {"double_gauss_100mm_f2.0", ModelKind::thin, 0xa81fd0aa96ae6fd5, 0xe50d8db79d64e6d3},
    {"double_gauss_100mm_f2.0", ModelKind::thin_two_disc, 0x4d94c69694f48595, 0xe89c180f2bcc0e5a},
    {"double_gauss_100mm_f2.0", ModelKind::thick, 0x1e20884293a2af59, 0xd7c6298057c8d482},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(3), 0x913b3ce3a50edfab, 0x35cf263f550b886f},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(5), 0x102ed86a35e51948, 0x81b2968ab1559d3f},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(7), 0x6ab5739b9cf8df0f, 0x3d7c8a01a42d2e2a},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(9), 0x2e328b128c401f9c, 0xf935f96a9ae94d63},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(11), 0x791f1361f4c1e952, 0x8aa275051fdb7eef},
    {"double_gauss_100mm_f2.0", ModelKind::exact_float, 0xbb5a23402910c6bf, 0x63c5e4df42cfa731},
    {"double_gauss_100mm_f2.0", ModelKind::exact_double, 0x5f6ab72095f6777, 0xb2dcfe2cbfa1b890},
    {"phone_5.6mm_f3.5", ModelKind::pinhole, 0x27fc7f6624df5fe8, 0x23869076d31fea2f},
    {"phone_5.6mm_f3.5", ModelKind::thin, 0xc1c3753d6a469749, 0xf3aee9a120cf4ad8},
    {"phone_5.6mm_f3.5", ModelKind::thin_two_disc, 0x39b81e9ce94f54d3, 0x7c6d9d9f1a87ba9},
    {"phone_5.6mm_f3.5", ModelKind::thick, 0x726cba3851148498, 0xca476b821149a333},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(3), 0xd9ec542bbdad9991, 0x222546030d54482b},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(5), 0xe439c8a7e37da231, 0x32ded5f2ee0401ff},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(7), 0xb96a39ba3beacbea, 0x2c197fa862d5306e},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(9), 0x3cf95e6fe35794c0, 0xc48f1dd68875745c},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(11), 0x666e33637851d21c, 0xf7f8b058760918ee},
    {"phone_5.6mm_f3.5", ModelKind::exact_float, 0x45f6d3665f147836, 0xa51d0382be3ae14e},
    {"phone_5.6mm_f3.5", ModelKind::exact_double, 0xf117654de803c03d, 0x219839ec8fa163b3},
    {"mirror_newton_200mm_f8", ModelKind::pinhole, 0x217ab6702e56632d, 0xcab01e859232460f},
    {"mirror_newton_200mm_f8", ModelKind::thin, 0x93e46845acb06425, 0x581d20d8442d95bb},
    {"mirror_newton_200mm_f8", ModelKind::thin_two_disc, 0x1cf7e3062033258c, 0xc871fce4c93c4b93},
    {"mirror_newton_200mm_f8", ModelKind::thick, 0x93e46845acb06425, 0x581d20d8442d95bb},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(3), 0xd4ad8e98d56eff5, 0xdddcfe068f3808fa},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(5), 0x30dbd79b6ecf5a3c, 0x3dd6451466c14022},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(7), 0x8a71b5f0878d144d, 0x77c5e29f67271491},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(9), 0x3b7aa9467d3f87d8, 0x751090de5a035cd},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(11), 0x8b45d025086b9269, 0x751090de5a035cd},
    {"mirror_newton_200mm_f8", ModelKind::exact_float, 0xb4bb4822bb1f51b3, 0x35b621c9dc077884},
    {"mirror_newton_200mm_f8", ModelKind::exact_double, 0x30b3ec0f3bdf7f76, 0xa76f0f1f31891cfa},
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
