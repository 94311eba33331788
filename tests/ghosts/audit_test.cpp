// SPDX-License-Identifier: Apache-2.0
// The fates of all light of a lens add up, and pairs of surfaces hold the light of split rays.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {
namespace ghost_audit_test {

class Audit : public ::testing::TestWithParam<const char*> {};

TEST_P(Audit, SumsToOne) {
  Lens lens = petzval::testing::data_lens(GetParam());
  const ScenePoint light = scene_point(lens, {.field_rad = radians(5), .z = -std::numeric_limits<double>::infinity()});
  for (const bool coated : {false, true}) {
    if (coated) lens = with_coating(lens, Coating::quarter_wave());
    const GhostAudit audit = ghost_audit(lens, light, {.tolerance = 0.01, .threads = 2});
    EXPECT_NEAR(audit.sum, 1, 0.005) << coated;
    EXPECT_GT(audit.image, 0);
    EXPECT_GT(audit.back_out, 0);
    EXPECT_GE(audit.higher_order, 0);
    EXPECT_LT(audit.ghosts, coated ? 0.01 : 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, Audit,
                         ::testing::Values("singlet_50mm_biconvex", "double_gauss_100mm_f2.0", "fisheye_8mm_f2.8",
                                           "phone_5.6mm_f3.5", "anamorphic_60mm_2x",
                                           "catadioptric_maksutov_1280mm_f14.4", "biogon_35mm_f2.8"));

TEST(GhostAudit, CountsTheFilmAndTheCoatings) {
  Prescription p = petzval::testing::data_prescription("singlet_50mm_biconvex");
  p.surfaces[0].coating = Coating{.layers = {{.index = 2, .absorption = 0.5, .thickness_nm = 40}}};
  const Lens lens = compile(p);
  const ScenePoint light{{0, 0, -1}, true};
  const GhostAudit dark = ghost_audit(lens, light), bright = ghost_audit(lens, light, {.film_reflectance = 0.5});
  EXPECT_NEAR(dark.sum, 1, 0.002);
  EXPECT_NEAR(bright.sum, 1, 0.002);
  EXPECT_GT(dark.absorbed, 0.05);
  EXPECT_NEAR(bright.image, dark.image / 2, 1e-9);
  EXPECT_GT(bright.ghosts, dark.ghosts);
  EXPECT_GT(bright.back_out, dark.back_out + 0.05);
}

}  // namespace ghost_audit_test
}  // namespace petzval
