// SPDX-License-Identifier: Apache-2.0
// Distances at which images are sharp: all models of a focused lens agree.
#include "petzval/focus/focus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace focus_test {

/// Blur of the centre of the film over the planes of the scene, from weighted camera samples.
///
/// Rays cross the plane of the entrance pupil at p with slopes s. At the distance `away` from this plane they miss the
/// axis by the angle s + p / away. The mean square is a parabola over 1 / away.
struct Blur {
  double pupil_z = 0;
  double ss = 0, ps = 0, pp = 0;

  double rms(double away) const { return std::sqrt(std::max(0.0, ss + 2 * ps / away + pp / (away * away))); }
  double sharpest() const { return -pp / ps; }
  /// Half the depth over which the blur grows by 5 %, in 1 / away.
  double half_depth() const { return std::sqrt(std::max(0.0, (1.05 * 1.05 - 1) * (ss - ps * ps / pp) / pp)); }
};

Blur blur(const Camera& camera, std::size_t wavelength = 0) {
  Blur blur{.pupil_z = pupils(camera.lens()).entrance.z};
  double total = 0;
  constexpr int count = 16384;
  for (int i = 0; i < count; ++i) {
    const double u = std::fmod(i * 0.7548776662466927, 1), v = std::fmod(i * 0.5698402909980532, 1);
    const CameraRay r = camera.sample({.film = {}, .pupil_u = u, .pupil_v = v, .wavelength = wavelength});
    if (!r) continue;
    const auto& [o, d] = r.ray;
    const double sx = d.x / d.z, sy = d.y / d.z, up = blur.pupil_z - o.z;
    const double x = o.x + up * sx, y = o.y + up * sy;
    total += r.weight;
    blur.ss += r.weight * (sx * sx + sy * sy);
    blur.ps += r.weight * (sx * x + sy * y);
    blur.pp += r.weight * (x * x + y * y);
  }
  blur.ss /= total, blur.ps /= total, blur.pp /= total;
  return blur;
}

TEST(CameraFocus, EveryModelFocusesAtTheSetDistance) {
  constexpr double distance = 3000;
  for (const char* id : {"double_gauss_100mm_f2_28deg", "modern_58mm_f0.95", "telephoto_200mm_f1.8", "biogon_35mm_f2.8",
                         "tessar_100mm_f2.8", "soft_85mm_f2.8", "retrofocus_100mm_f2"}) {
    for (const double f_number : {0.0, 4.0}) {
      const Lens whole = testing::data_lens(id);
      const Lens lens =
          with_focus(f_number > 0 ? with_f_number(whole, f_number) : whole, distance, {.origin = DistanceOrigin::film});
      const double film_z = lens.film_z();
      const auto in_focus = [&](const Blur& b) { return film_z - (b.pupil_z + b.sharpest()); };
      const Blur exact = blur(Camera(lens, {}, {.model = ModelKind::exact_double}));
      const double wanted = 1 / (film_z - distance - exact.pupil_z);
      SCOPED_TRACE(std::string(id) + (f_number > 0 ? " at f/4" : " wide open") + ": exact " +
                   std::to_string(in_focus(exact)) + " mm");
      EXPECT_NEAR(1 / exact.sharpest(), wanted, exact.half_depth());
      // A scan of planes has its minimum at the same distance.
      for (const double off : {-2.0, -1.5, 1.5, 2.0}) {
        EXPECT_GT(exact.rms(1 / (wanted + off * exact.half_depth())), exact.rms(1 / wanted)) << off;
      }
      for (const ModelKind model : models()) {
        const Blur b = blur(Camera(lens, {}, {.model = model}));
        if (model == ModelKind::pinhole) {
          EXPECT_LT(b.pp, 1e-20);  // sharp everywhere
          continue;
        }
        EXPECT_NEAR(1 / b.sharpest(), wanted, exact.half_depth()) << name(model) << " " << in_focus(b);
      }
    }
  }
}

// For any film position and wavelength, first-order models are sharp in the plane of the smallest blur of exact rays.
TEST(CameraFocus, FirstOrderModelsFocusWithExactRays) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  for (const char* id : {"double_gauss_100mm_f2_28deg", "modern_58mm_f0.95", "catadioptric_mangin_1000mm_f7.5",
                         "mirror_newton_200mm_f8", "eye_gullstrand_le_grand", "fisheye_10mm_f4"}) {
    SCOPED_TRACE(id);
    const Prescription prescription = testing::data_prescription(id);
    const bool coloured = std::string(id).starts_with("double_gauss");
    const Lens lens = coloured ? compile(prescription, std::array{486.1, 587.5618, 656.3},
                                         {.glasses = &glasses, .missing_glass = MissingGlass::abbe})
                               : compile(prescription);
    const double rear_focal_z = first_order(lens).rear_focal_z, f = first_order(lens).effective_focal_length;
    for (const double film_z : {rear_focal_z, rear_focal_z + 0.03 * f, rear_focal_z - 0.01 * f}) {
      const Film film{.width_mm = 2, .height_mm = 2, .z_mm = film_z};
      for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
        const Blur exact = blur(Camera(lens, film, {.model = ModelKind::exact_double}), w);
        for (const ModelKind model : {ModelKind::thin_two_disc, ModelKind::thick}) {
          const Blur b = blur(Camera(lens, film, {.model = model}), w);
          EXPECT_NEAR(1 / b.sharpest(), 1 / exact.sharpest(), 0.01 * exact.half_depth() + 1e-9 / f)
              << name(model) << " " << film_z;
          EXPECT_LT(b.rms(b.sharpest()), 1e-6);
        }
      }
    }
  }
}

}  // namespace focus_test
}  // namespace petzval
