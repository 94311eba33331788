// SPDX-License-Identifier: Apache-2.0
// Single samples of a camera have the same bits on every instruction set and compiler; its batches have those of a
// constant where the baseline alone is used (PETZVAL_INSTRUCTION_SET=baseline). Both need a C library whose sines and
// powers have the bits of glibc's on a processor with FMA. After an intended change of the arithmetic or of a lens in
// the table, the failing test prints the new table.
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "../camera/camera_samples.hpp"
#include "../data_lenses.hpp"
#include "hash.hpp"
#include "petzval/core/instruction_set.hpp"
#include "petzval/focus/focus.hpp"

namespace petzval {
namespace camera_bits_test {

struct Row {
  std::string lens;
  ModelKind model;
  std::uint64_t singles, batches;
};

const std::vector<Row> table = {
    {"double_gauss_100mm_f2.0", ModelKind::pinhole, 0xdb760af9a9b5b1fa, 0xc44b0068b32fe0b7},
    {"double_gauss_100mm_f2.0", ModelKind::thin, 0xbfdd72ef0031f899, 0x9f3362f2df78d60},
    {"double_gauss_100mm_f2.0", ModelKind::thin_two_disc, 0x5283fe697400361f, 0xdb049b92066eed8},
    {"double_gauss_100mm_f2.0", ModelKind::thick, 0x91021d87d0b628c4, 0x6db5caa3508f105f},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(3), 0x13077ac607f981f1, 0x93a078fff794389f},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(5), 0x96bfca8fe2a4e223, 0xbb3c8389d74151b2},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(7), 0x902cb52972cf759a, 0xdf556b3dcff8530e},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(9), 0xb581fc76f88c7e55, 0xd237532d8c08c902},
    {"double_gauss_100mm_f2.0", ModelKind::polynomial(11), 0x874a051aa19bc509, 0x18c9143195964b0},
    {"double_gauss_100mm_f2.0", ModelKind::exact_float, 0x17789a035af48a62, 0xfbaacaa1e6826248},
    {"double_gauss_100mm_f2.0", ModelKind::exact_double, 0x791bd07cf33911b3, 0x374a5b71adb1720c},
    {"phone_5.6mm_f3.5", ModelKind::pinhole, 0xd6081cbc7be8942, 0x769784fa9d9abb73},
    {"phone_5.6mm_f3.5", ModelKind::thin, 0x52688c5ebbeb4734, 0x9b63cd48daa236da},
    {"phone_5.6mm_f3.5", ModelKind::thin_two_disc, 0x8235b5010a5cd2c4, 0x542c7e9df2d8c9a1},
    {"phone_5.6mm_f3.5", ModelKind::thick, 0x4febf46afc9799d4, 0xe71e97ff6974618e},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(3), 0x6bebd5262422f47c, 0xb6a46ecdb92ee491},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(5), 0xc0a280333386e080, 0x2756008b2e12757c},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(7), 0x71905cb9d105aa06, 0x1e556b0802925a93},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(9), 0x263d4c8d2ed2219f, 0x353303981cbab304},
    {"phone_5.6mm_f3.5", ModelKind::polynomial(11), 0xc7db2e00a18c8ff4, 0x666d8b97760bae0e},
    {"phone_5.6mm_f3.5", ModelKind::exact_float, 0x85e413e975949698, 0x6e97b373f4434786},
    {"phone_5.6mm_f3.5", ModelKind::exact_double, 0x8296b3ecc723a30c, 0x482c98d31512bdd9},
    {"mirror_newton_200mm_f8", ModelKind::pinhole, 0xfd8fdea8a80bb0ce, 0x549da2be2709df12},
    {"mirror_newton_200mm_f8", ModelKind::thin, 0x191493b1b165be89, 0xf3cbe8841b3a6514},
    {"mirror_newton_200mm_f8", ModelKind::thin_two_disc, 0x7a9d0d858e6f4da8, 0x42ceb1e3cb567468},
    {"mirror_newton_200mm_f8", ModelKind::thick, 0x191493b1b165be89, 0xf3cbe8841b3a6514},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(3), 0x1ac4614470c32321, 0x5566db58dd4709b7},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(5), 0xa9fcb55812c025cb, 0xba183b1bb46c9f47},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(7), 0x4756f7dfdcb3826b, 0x82ddd2fcdb2969d8},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(9), 0x9064f662c64a68cf, 0x46bc1f5c787e806b},
    {"mirror_newton_200mm_f8", ModelKind::polynomial(11), 0x20b30eaf1e2e84e2, 0xbe75a7a44c38c9b4},
    {"mirror_newton_200mm_f8", ModelKind::exact_float, 0x77404c34a50379cd, 0xa38318c94522afc4},
    {"mirror_newton_200mm_f8", ModelKind::exact_double, 0xe172f67b6bff2d67, 0xcbc7ea986349ec56},
};

struct Scene {
  const char* lens;
  double side;  ///< of the film, mm
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

/// Lenses, irises and tables are built with these.
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

TEST(CameraBits, AreThoseOfTheTable) {
  if (instruction_sets().size() > 1) GTEST_SKIP() << "wider sets have bits of their own";
  constexpr std::uint64_t of_the_table = 0x4935b4f378316858;
  if (c_library() != of_the_table) GTEST_SKIP() << "this C library has bits of its own: 0x" << std::hex << c_library();
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
