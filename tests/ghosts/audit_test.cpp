// SPDX-License-Identifier: Apache-2.0
// The fates of all light of a lens add up, and pairs of surfaces hold the light of split rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval {
namespace ghost_audit_test {

/// Cases 0 to 3: a far light on the axis and at half the field, without and with coatings.
/// @param noise of the ghosts of split rays, relative
void expect_sum_of_one(const Prescription& p, const std::vector<int>& cases, std::size_t rays, double noise) {
  const Lens bare = compile(p);
  const double half = declared_half_field(p, bare).value_or(radians(10));
  for (const int number : cases) {
    SCOPED_TRACE(p.id + ", case " + std::to_string(number));
    const Lens lens = number / 2 == 1 ? with_coating(bare, Coating::quarter_wave()) : bare;
    const double field = number % 2 == 1 ? half / 2 : 0;
    const ScenePoint light = scene_point(lens, {.field_rad = field, .z = -std::numeric_limits<double>::infinity()});
    const GhostAudit audit = ghost_audit(lens, light, {.tolerance = 0.01}, rays);
    // Pairs and split rays find the ghosts independently; the rest of the split rays adds up by itself.
    EXPECT_NEAR(audit.sum, 1, std::min(noise * audit.ghosts + 2e-4, 0.002));
    for (const double part :
         {audit.image, audit.ghosts, audit.higher_order, audit.absorbed, audit.stopped, audit.back_out}) {
      EXPECT_GE(part, -1e-12);
    }
    EXPECT_GT(audit.image, 0);
    const bool mirrors = std::ranges::all_of(bare.surfaces(), &LensSurface::mirror);
    EXPECT_EQ(audit.back_out > 0, !mirrors);
    EXPECT_LT(audit.absorbed, 1e-9);  // no medium of these lenses absorbs
    EXPECT_LT(audit.ghosts, number / 2 == 1 ? 0.01 : 0.1);
  }
}

TEST(GhostAudit, SmallLensesSumToOne) {
  int number = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    if (p.surfaces.size() <= 10) expect_sum_of_one(p, {number++ % 4}, 256, 0.04);
  }
  EXPECT_GT(number, 20);
}

TEST(EveryGhostAudit, SumsToOne) {
  for (const Prescription& p : testing::data_prescriptions()) expect_sum_of_one(p, {0, 1, 2, 3}, 512, 0.03);
}

// The image of a fisheye takes 0.06 % of the light of its front surface.
TEST(GhostAudit, FewRaysFindTheImageOfAFisheye) {
  const Lens lens = testing::data_lens("fisheye_8mm_f2.8");
  const ScenePoint light{{0, 0, -1}, true};
  const double image = ghost_audit(lens, light, {.tolerance = 1}, 4096).image;
  EXPECT_GT(image, 1e-4);
  EXPECT_NEAR(ghost_audit(lens, light, {.tolerance = 1}).image, image, 0.05 * image);
}

TEST(GhostAudit, CountsTheFilmAndTheCoatings) {
  Prescription p = testing::data_prescription("singlet_50mm_biconvex");
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
  const GhostAudit threads = ghost_audit(lens, light, {.threads = 3});
  EXPECT_EQ(threads.sum, dark.sum);
  EXPECT_EQ(threads.image, dark.image);
}

}  // namespace ghost_audit_test
}  // namespace petzval
