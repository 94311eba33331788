// SPDX-License-Identifier: Apache-2.0
// Reproducible batches have the same bits as rays traced one by one, on every instruction set, machine and compiler:
// their hashes are constants. After an intended change of the arithmetic or of a lens in the table, the failing test
// prints the new table:
//
//   build/tests/bits/bits_tests --gtest_filter='BatchBits.*Hash*'
#include <gtest/gtest.h>

#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "../trace/batches.hpp"
#include "hash.hpp"

namespace batch_bits_test {

using namespace testing_batches;

/// Hash of rays, fates and surfaces.
template <class T>
std::uint64_t hash(const Answer<T>& answer) {
  testing_bits::Hash h;
  for (std::size_t i = 0; i < answer.fates.size(); ++i) {
    const Ray<T> ray = answer.rays[i];
    for (int k = 0; k < 3; ++k) {
      h.take(ray.origin[k]);
      h.take(ray.direction[k]);
    }
    h.take(static_cast<std::uint64_t>(answer.fates[i]));
    h.take(static_cast<std::uint64_t>(answer.surfaces[i]));
  }
  return h.value();
}

struct Row {
  const char* lens;
  std::array<std::uint64_t, 4> hashes;  ///< float to_film, float to_scene, double to_film, double to_scene
};

constexpr std::size_t hashed_rays = 1000;

const std::vector<Row> table = {
    {"double_gauss_100mm_f2.0", {0xc5e02db5f1240b8e, 0xd22b3d9d2f9ca39f, 0x93d405d6d7120792, 0x504a7e5e3bac3ef2}},
    {"petzval_100mm_f1.6", {0x5ab8455341502e22, 0xb96df3d34d21a123, 0x0f15356183129bab, 0x299213141d304d54}},
    {"fisheye_6.3mm_f2.8", {0x10438b61e71cb5a8, 0xb9ddc38b8536e52a, 0x63cf586d535ce0fd, 0x2d829b715d156ca7}},
    {"modern_58mm_f0.95", {0x175612261bbbf107, 0x0e8445ca068b06db, 0xe47fda88cbf7f07b, 0x6b2d356c3fae4454}},
    {"phone_5.6mm_f3.5", {0x5af29e2790a5e3b4, 0x6c153b5b97499635, 0x7ccb72d81734954e, 0x4e52f2d05cf3ce28}},
    {"anamorphic_60mm_2x", {0xc17b4a0a7aae0456, 0xb576d0a79ee3f4e5, 0x4b253e29e89f7d45, 0x315bdc102094b21f}},
    {"cylinder_3.9mm", {0x2a55c3d8c3368071, 0x0b409b8712e865ff, 0xad160d3b6a1aadea, 0x47b52add27e8d4fe}},
    {"catadioptric_corrector_25mm_f1.25",
     {0xfda21934721283a9, 0xd9bf0fbc812cedba, 0x11fa3c42f6cdc46e, 0xfa560174f17f3761}},
    {"catadioptric_mangin_1000mm_f7.5",
     {0xb6c05474ed9f3985, 0x5f4f43cbd81f3a9a, 0xfdcac7037017d67d, 0x394cbc04fe165128}},
    {"mirror_ritchey_chretien_57.6m_f24",
     {0xb978909970d9f034, 0xb43f31a5c3bca86a, 0xec1342377a5872bd, 0x3bb8ccae08ddd341}},
    {"mirror_newton_200mm_f8", {0x27ea6f62eae31797, 0xd252f2c35a36fe6a, 0xba895f72eec632af, 0xbd15b31fe8b82adb}},
    {"zoom_14-30mm_f4:wide", {0x2fd09796a6419818, 0x7e6e6e8e33678586, 0x2cb18390cf551e4b, 0xab6ea931a44d3c75}},
    {"analytic_plano_hyperbolic_100mm",
     {0x792f5ee52a42d4ac, 0x19c72fcf9cc203ca, 0x7cb190f5137ae332, 0x9b42f2e6ecc2d51c}},
    {"eye_gullstrand_le_grand", {0x4f32c6bd4f383490, 0xb82239d997ad019f, 0xae3f7721e23be21d, 0x00e777adbb786302}},
};

template <class T>
std::uint64_t hash_of(const testing_lenses::Sample& sample, const BatchOptions& options) {
  return hash(traced(sample.lens, rays_for<T>(sample, options.travel, hashed_rays), options));
}

std::array<std::uint64_t, 4> hashes_of(const testing_lenses::Sample& sample, BatchOptions options) {
  std::array<std::uint64_t, 4> result;
  options.travel = Travel::to_film;
  result[0] = hash_of<float>(sample, options);
  result[2] = hash_of<double>(sample, options);
  options.travel = Travel::to_scene;
  result[1] = hash_of<float>(sample, options);
  result[3] = hash_of<double>(sample, options);
  return result;
}

/// A row formatted as in the table.
std::string text(const Row& row) {
  std::ostringstream line;
  line << "    {\"" << row.lens << "\",\n     {" << std::hex << std::setfill('0');
  for (std::size_t i = 0; i < 4; ++i) line << (i ? ", " : "") << "0x" << std::setw(16) << row.hashes[i];
  line << "}},\n";
  return line.str();
}

TEST(BatchBits, HashesEqualTheTable) {
  std::string found, wanted;
  for (const auto& sample : telling()) {
    found += text({sample.id.c_str(), hashes_of(sample, {.arithmetic = Arithmetic::reproducible})});
  }
  for (const Row& row : table) wanted += text(row);
  EXPECT_TRUE(found == wanted) << "The table is now:\n" << found;
}

template <class T>
void expect_rays_one_by_one(const testing_lenses::Sample& sample, Travel travel) {
  const auto rays = rays_for<T>(sample, travel, 300);
  const auto batch = traced(sample.lens, rays, {.travel = travel, .arithmetic = Arithmetic::reproducible});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto one = petzval::trace(sample.lens, rays[i], {.travel = travel});
    ASSERT_EQ(one.fate, batch.fates[i]) << i;
    ASSERT_EQ(one.surface, batch.surfaces[i]) << i;
    if (!one.transmitted()) continue;
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(bits(one.ray.origin[k]), bits(batch.rays[i].origin[k])) << i;
      ASSERT_EQ(bits(one.ray.direction[k]), bits(batch.rays[i].direction[k])) << i;
    }
  }
}

TEST(BatchBits, EqualSingleRays) {
  for (const auto& sample : testing_lenses::all()) {
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      SCOPED_TRACE(sample.id + (travel == Travel::to_film ? " to_film" : " to_scene"));
      expect_rays_one_by_one<float>(sample, travel);
      expect_rays_one_by_one<double>(sample, travel);
    }
  }
}

TEST(BatchBits, EqualOnEveryInstructionSet) {
  for (const auto& sample : testing_lenses::all()) {
    petzval::limit_batches(petzval::InstructionSet::baseline);
    const auto wanted = hashes_of(sample, {.arithmetic = Arithmetic::reproducible});
    for (const auto set : petzval::instruction_sets()) {
      petzval::limit_batches(set);
      const auto found = hashes_of(sample, {.arithmetic = Arithmetic::reproducible});
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(found[i], wanted[i]) << sample.id << " " << name(set) << (i < 2 ? " float" : " double")
                                       << (i % 2 ? " to_scene" : " to_film");
      }
    }
  }
}

}  // namespace batch_bits_test
