// SPDX-License-Identifier: Apache-2.0
// All models have the exposure of the exact lens.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "camera/make_model.hpp"
#include "petzval/core/error.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace exposure_test {

constexpr std::array pupil_models{ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::thick,
                                  ModelKind::polynomial(3)};

/// Irradiance of a film point through a pupil, estimated from camera samples.
double exposure(const Lens& lens, const FilmPupilTable& pupils, const FilmPoint& film) {
  const double depth = pupils.space().depth(), n = lens.index(lens.surface_count());
  constexpr int count = 2048;
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    const PupilSample s = pupils.sample(film, std::fmod(i * std::numbers::phi, 1.0), (i + 0.5) / count);
    const double length2 = std::pow(s.x - film.x, 2) + std::pow(s.y - film.y, 2) + depth * depth;
    sum += s.area * depth * depth / (length2 * length2);
  }
  return n * n * sum / count;
}

/// nullopt if the lens does not have the f-number.
std::optional<Lens> stopped(const Lens& lens, double f_number) {
  if (f_number == 0) return lens;
  try {
    return with_f_number(lens, f_number);
  } catch (const Error&) {
    return {};
  }
}

TEST(Exposure, EveryModelIsExactOnTheAxis) {
  int checked = 0;
  for (const Prescription& prescription : testing::data_prescriptions()) {
    const Lens open = compile(prescription);
    const bool cylinders = !open.rotationally_symmetric();
    const double radius = testing::declared_radius(prescription, open);
    for (const double f_number : {0.0, 4.0, 16.0}) {
      const auto lens = stopped(open, f_number);
      if (!lens || first_order(*lens, {}, Meridian::x).afocal || first_order(*lens).afocal) continue;
      const double exact = film_irradiance(*lens, {});
      for (const ModelKind model : pupil_models) {
        if (cylinders && (model == ModelKind::pinhole || model == ModelKind::thin_two_disc)) continue;
        // Pupils with more than two components along a line cannot be tabulated as polygons.
        const bool in_parts = prescription.name.starts_with("Ball lens");
        if (in_parts && (model == ModelKind::thin_two_disc || model == ModelKind::polynomial(3))) continue;
        const FilmPupilTable pupils = camera_detail::make_model(model, *lens, radius)->pupils();
        EXPECT_NEAR(exposure(*lens, pupils, {}) / exact, 1, 5e-3)
            << prescription.name << " f/" << f_number << ' ' << name(model);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 700);
}

// thin_two_disc and polynomials use pupils fitted to the exact lens.
TEST(Exposure, ModelsWithExactPupilsAreExactOverTheField) {
  for (const char* id :
       {"double_gauss_100mm_f2.0", "modern_58mm_f0.95", "tessar_100mm_f2.8", "retrofocus_100mm_f2.8",
        "telephoto_200mm_f1.8", "fisheye_10mm_f4", "zoom_14-30mm_f4:wide", "phone_5.6mm_f3.5", "anamorphic_60mm_2x"}) {
    const Prescription prescription = testing::data_prescription(id);
    const Lens open = compile(prescription);
    const double radius = testing::declared_radius(prescription, open);
    for (const double f_number : {0.0, 4.0, 16.0}) {
      const auto lens = stopped(open, f_number);
      if (!lens) continue;
      const double axis = film_irradiance(*lens, {});
      for (const ModelKind model : {ModelKind::thin_two_disc, ModelKind::polynomial(3)}) {
        if (model == ModelKind::thin_two_disc && !open.rotationally_symmetric()) continue;
        const FilmPupilTable pupils = camera_detail::make_model(model, *lens, radius)->pupils();
        for (const double part : {0.3, 0.5, 0.7, 0.85, 0.97}) {
          const FilmPoint film{0.6 * part * radius, 0.8 * part * radius};
          const double exact = film_irradiance(*lens, film);
          if (exact < 0.05 * axis) continue;  // edge of the image circle
          EXPECT_NEAR(exposure(*lens, pupils, film) / exact, 1, 0.02)
              << id << " f/" << f_number << ' ' << name(model) << " at " << part;
        }
      }
    }
  }
}

TEST(Exposure, IrisWithEdgesIsExact) {
  for (const char* id : {"double_gauss_100mm_f2.0", "tessar_100mm_f2.8", "modern_58mm_f0.95"}) {
    for (const double f_number : {2.9, 8.0}) {
      const Lens lens = with_iris(with_f_number(testing::data_lens(id), f_number),
                                  {.blades = 6, .roundness = -0.6, .rotation_rad = 0.1});
      for (const ModelKind model : {ModelKind::pinhole, ModelKind::thin, ModelKind::thick}) {
        const FilmPupilTable pupils = camera_detail::make_model(model, lens, 10)->pupils();
        EXPECT_NEAR(exposure(lens, pupils, {}) / film_irradiance(lens, {}), 1, 5e-3) << id << ' ' << name(model);
      }
    }
  }
}

}  // namespace exposure_test
}  // namespace petzval
