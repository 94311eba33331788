// SPDX-License-Identifier: Apache-2.0
// Fits of real lenses, compared with exact rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "lines.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace fit_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_tokens;
using testing::Lines;
using testing::lines_through;

struct Case {
  std::string id;
  double f_number, film_radius;  ///< f-number 0: wide open
};
const std::array<Case, 7> cases{{{"double_gauss_100mm_f2.0", 0, 40},
                                 {"double_gauss_100mm_f2.0", 4, 40},
                                 {"fisheye_6.3mm_f2.8", 0, 11.7},
                                 {"compact_31mm_f2.1", 0, 13.6},
                                 {"catadioptric_maksutov_1280mm_f14.4", 0, 5.6},
                                 {"anamorphic_60mm_2x", 0, 14.4},
                                 {"anamorphic_60mm_2x", 8, 14.4}}};

Lens lens_of(const Case& c) {
  const Lens lens = data_lens(c.id);
  return c.f_number > 0 ? with_f_number(lens, c.f_number) : lens;
}

/// The exact ray of a line; starts in the plane of the last vertex.
TracedRay<double> exact(const Lens& lens, const TwoPlanes& space, const Lines<double>& lines, std::size_t i,
                        std::size_t wavelength = 0) {
  const Vec3<double> film(lines.film_x[i], lines.film_y[i], space.film_z);
  const Vec3<double> along = Vec3<double>(lines.pupil_x[i], lines.pupil_y[i], space.pupil_z) - film;
  const double against_light = signed_index(lens, lens.surface_count()) > 0 ? -1 : 1;
  const Vec3<double> start = film + along * ((lens.surfaces().back().vertex_z - space.film_z) / along.z);
  return trace<double>(lens, {start, glm::normalize(along) * (against_light * along.z > 0 ? 1.0 : -1.0)},
                       {.travel = Travel::to_scene, .wavelength = wavelength});
}

struct Errors {
  double rms_rad = 0, max_rad = 0, rms_mm = 0, max_mm = 0;
  double share = 0;  ///< fraction of the lines that pass
};

/// Errors of the direction and of the offset from the reference point.
template <class T>
Errors errors(const Lens& lens, const RayPolynomial& polynomial, const Lines<T>& rays, const Lines<double>& lines,
              std::size_t wavelength = 0) {
  Errors result;
  double passed = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(rays.fates[i], RayFate::transmitted);
    const TracedRay<double> ray = exact(lens, polynomial.domain().space, lines, i, wavelength);
    if (!ray.transmitted()) continue;
    ++passed;
    const double rad = glm::length(rays.direction(i) - ray.ray.direction);
    const Vec3<double> reference(0, 0, polynomial.domain().reference_z);
    const Vec3<double> apart = ray.ray.origin - reference;
    const Vec3<double> foot = apart - glm::dot(apart, ray.ray.direction) * ray.ray.direction;
    const double mm = glm::length(rays.origin(i) - reference - foot);
    result.rms_rad += rad * rad, result.max_rad = std::max(result.max_rad, rad);
    result.rms_mm += mm * mm, result.max_mm = std::max(result.max_mm, mm);
  }
  result.rms_rad = std::sqrt(result.rms_rad / passed);
  result.rms_mm = std::sqrt(result.rms_mm / passed);
  result.share = passed / static_cast<double>(lines.size());
  return result;
}

TEST(PolynomialFit, ErrorsFallWithTheDegreeAndEqualTheStatedErrors) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.id);
    const Lens lens = lens_of(c);
    const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, c.film_radius);
    const Lines<double> lines = lines_through<double>(pupils, 10000, 1);
    double last = std::numeric_limits<double>::infinity();
    for (int degree = 3; degree <= 11; degree += 2) {
      SCOPED_TRACE(degree);
      const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, degree);
      ASSERT_EQ(polynomial.fits().size(), 1u);
      const RayPolynomial::Fit& fit = polynomial.fits()[0];
      Lines<double> rays = lines;
      const Errors found = errors(lens, polynomial, rays.through(polynomial), lines);
      EXPECT_GT(found.share, 0.99);
      EXPECT_NEAR(found.rms_rad, fit.rms_rad, 0.1 * fit.rms_rad);
      EXPECT_NEAR(found.rms_mm, fit.rms_mm, 0.1 * fit.rms_mm);
      EXPECT_LT(found.max_rad, fit.max_rad);
      EXPECT_LT(found.max_mm, fit.max_mm);
      // With cylinders few film points have the largest errors; see LargestErrorsHoldToTheCornerOfTheFilm.
      if (lens.rotationally_symmetric()) {
        EXPECT_GT(found.max_rad, 0.6 * fit.max_rad);
      }
      EXPECT_LT(found.rms_rad, last / 2.5);
      last = found.rms_rad;
    }
  }
}

// Half of the test rays come from the whole film, half from its corner, where errors have narrow peaks.
TEST(PolynomialFit, LargestErrorsHoldToTheCornerOfTheFilm) {
  struct Focused {
    const char* id;
    double f_number, distance, film_radius;
  };
  for (const auto& [id, f_number, distance, film_radius] :
       {Focused{"modern_58mm_f0.95", 1, 700, 21.63}, Focused{"modern_58mm_f0.95", 0, 3000, 21.63},
        Focused{"double_gauss_100mm_f2.0", 0, 3000, 40}, Focused{"double_gauss_100mm_f2_28deg", 0, 3000, 21.63},
        Focused{"fisheye_6.3mm_f2.8", 0, 3000, 11.7}, Focused{"biogon_35mm_f2.8", 0, 3000, 21.63},
        Focused{"tessar_100mm_f2.8", 4, 1000, 21.63}, Focused{"modern_41mm_f1.45", 0, 3000, 21.63},
        Focused{"zoom_14-30mm_f4:wide", 0, 1000, 21.63}, Focused{"compact_31mm_f2.1", 0, 3000, 13.6},
        Focused{"phone_5.6mm_f3.5", 0, 1000, 3.5}, Focused{"anamorphic_60mm_2x", 0, 3000, 14.4},
        Focused{"anamorphic_60mm_2x", 4, 3000, 14.4}, Focused{"anamorphic_60mm_2x", 16, 700, 10},
        Focused{"cylinder_3.9mm", 0, 300, 1}, Focused{"cylinder_3.9mm", 4, 300, 1}}) {
    const Lens whole = data_lens(id);
    const Lens lens = with_focus(f_number > 0 ? with_f_number(whole, f_number) : whole, distance);
    const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, film_radius);
    Lines<double> lines = lines_through<double>(pupils, 10000, 5);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> one(0, 1);
    for (int i = 0; i < 10000; ++i) {
      const double turn = lens.rotationally_symmetric() ? 0 : 2 * std::numbers::pi * one(random);
      const FilmPoint corner{film_radius * std::sin(turn), film_radius * std::cos(turn)};
      const PupilSample at = pupils.sample(corner, one(random), i % 2 == 0 ? 1 : one(random));
      if (at.area > 0) lines.add(corner.x, corner.y, at.x, at.y);
    }
    for (int degree = 3; degree <= 11; degree += 2) {
      SCOPED_TRACE(std::string(id) + " by degree " + std::to_string(degree));
      const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, degree);
      Lines<double> rays = lines;
      const Errors found = errors(lens, polynomial, rays.through(polynomial), lines);
      EXPECT_LT(found.max_rad, polynomial.fits()[0].max_rad);
      EXPECT_LT(found.max_mm, polynomial.fits()[0].max_mm);
      EXPECT_GT(found.max_rad, 0.6 * polynomial.fits()[0].max_rad);
    }
  }
}

// A cylinder too weak to change the lens.
TEST(PolynomialFit, MirrorSymmetryIsAsAccurateAsRotationalSymmetry) {
  Prescription prescription = data_prescription("double_gauss_100mm_f2.0");
  const Lens lens = compile(prescription);
  SurfaceRow weak = {.radius = 1e12, .thickness = 0.01, .curved_in = Section::x};
  weak.semi_diameter = 1.1 * *prescription.surfaces[0].semi_diameter;
  prescription.surfaces.insert(prescription.surfaces.begin(), weak);
  const Lens mirrors = compile(prescription);
  ASSERT_FALSE(mirrors.rotationally_symmetric());
  const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, 40), own = FilmPupilTable::equal_area(mirrors, 40);
  for (int degree = 3; degree <= 11; degree += 2) {
    const RayPolynomial wanted = RayPolynomial::fit(lens, pupils, degree),
                        found = RayPolynomial::fit(mirrors, own, degree);
    ASSERT_TRUE(found.domain().along_x.has_value());
    EXPECT_NEAR(found.fits()[0].rms_rad, wanted.fits()[0].rms_rad, 0.1 * wanted.fits()[0].rms_rad) << degree;
    EXPECT_LT(found.fits()[0].max_rad, 1.4 * wanted.fits()[0].max_rad) << degree;
  }
}

TEST(PolynomialFit, LensesHaveTheKnownErrors) {
  // RMS angle times focal length, in micrometres: for the double Gauss least squares over uniform samples give 28.6,
  // 6.2, 1.03, 0.144 and 0.019 at f/2 and 12.3, 1.28, 0.132, 0.0124 and 0.0011 at f/4. The fit has denser samples at
  // the edges and keeps the centre of the film in focus.
  struct Known {
    Case of;
    double focal_length;
    std::array<double, 5> limits;
  };
  for (const auto& [of, focal_length, limits] :
       {Known{cases[0], 100, {33, 7.4, 1.2, 0.17, 0.023}}, Known{cases[1], 100, {14, 1.4, 0.15, 0.014, 0.0013}},
        Known{cases[5], 60.55, {42, 7.5, 1.6, 0.33, 0.071}}, Known{cases[6], 60.55, {34, 3.1, 0.32, 0.034, 0.004}}}) {
    const Lens lens = lens_of(of);
    const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, of.film_radius);
    for (int degree = 3; degree <= 11; degree += 2) {
      const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, degree);
      EXPECT_LT(1e3 * focal_length * polynomial.fits()[0].rms_rad, limits[static_cast<std::size_t>(degree - 3) / 2]);
    }
  }
}

TEST(PolynomialFit, RotatesWithTheCylinders) {
  Prescription prescription = data_prescription("anamorphic_60mm_2x");
  const Lens lens = compile(prescription);
  for (SurfaceRow& row : prescription.surfaces) {
    if (row.curved_in == Section::x) row.curved_in = Section::y;
  }
  const Lens turned = compile(prescription);
  const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, 14.4);
  const FilmPupilTable turned_pupils = FilmPupilTable::equal_area(turned, 14.4);
  const TwoPlanes &space = pupils.space(), &turned_space = turned_pupils.space();
  Lines<double> lines = lines_through<double>(pupils, 2000, 7), about;
  // The pupils of the sections lie in different planes.
  const double part = (turned_space.pupil_z - space.film_z) / space.depth();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double fx = lines.film_x[i], fy = lines.film_y[i];
    about.add(fy, fx, fy + part * (lines.pupil_y[i] - fy), fx + part * (lines.pupil_x[i] - fx));
  }
  for (const int degree : {5, 9}) {
    const RayPolynomial one = RayPolynomial::fit(lens, pupils, degree);
    const RayPolynomial other = RayPolynomial::fit(turned, turned_pupils, degree);
    const RayPolynomial::Fit &a = one.fits()[0], &b = other.fits()[0];
    // Both halves of a pupil, at +x and at -x, get equal numbers of samples; turned pupils have other halves.
    EXPECT_NEAR(b.rms_rad, a.rms_rad, 0.15 * a.rms_rad);
    lines.through(one), about.through(other);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (about.fates[i] != RayFate::transmitted) continue;  // on the rim
      const Vec3<double> direction = about.direction(i);
      EXPECT_LT(glm::length(lines.direction(i) - Vec3<double>(direction.y, direction.x, direction.z)),
                a.max_rad + b.max_rad);
    }
    EXPECT_GT(std::count(about.fates.begin(), about.fates.end(), RayFate::transmitted), 1980);
  }
}

TEST(PolynomialFit, DomainContainsThePupils) {
  for (const Case& c : cases) {
    const Lens lens = lens_of(c);
    const FilmPupilTable pupils = FilmPupilTable::enclosing(lens, c.film_radius);
    const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, 3);
    Lines<float> lines = lines_through<float>(pupils, 5000, 2);
    double unmoved = 0;               // the radius that discs about the axis would need
    for (int i = 0; i < 2000; ++i) {  // rims at all film points and at the edge of the film
      const double turn = 0.1 * i, r = i % 2 == 0 ? c.film_radius : c.film_radius * i / 2000;
      const FilmPoint film{r * std::sin(turn), r * std::cos(turn)};
      const PupilSample sample = pupils.sample(film, 0.618 * i - std::floor(0.618 * i), 1);
      if (sample.area > 0) lines.add(film.x, film.y, sample.x, sample.y);
      unmoved = std::max(unmoved, std::hypot(sample.x, sample.y));
    }
    lines.through(polynomial);
    EXPECT_EQ(std::count(lines.fates.begin(), lines.fates.end(), RayFate::outside_fit), 0) << c.id;
    EXPECT_LT(polynomial.domain().pupil_radius, 1.02 * unmoved) << c.id;
  }
}

TEST(PolynomialFit, FloatAddsLittle) {
  for (const Case& c : cases) {
    const Lens lens = lens_of(c);
    const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, c.film_radius);
    for (const int degree : {3, 7, 11}) {
      const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, degree);
      Lines<float> single = lines_through<float>(pupils, 2000, 4);
      Lines<double> twice;
      for (std::size_t i = 0; i < single.size(); ++i) {
        twice.add(single.film_x[i], single.film_y[i], single.pupil_x[i], single.pupil_y[i]);
      }
      single.through(polynomial), twice.through(polynomial);
      double rad = 0, mm = 0;
      for (std::size_t i = 0; i < single.size(); ++i) {
        ASSERT_EQ(single.fates[i], RayFate::transmitted);
        rad = std::max(rad, glm::length(single.direction(i) - twice.direction(i)));
        mm = std::max(mm, glm::length(single.origin(i) - twice.origin(i)));
      }
      EXPECT_LT(rad, 4e-7) << c.id;
      EXPECT_LT(mm, 3e-5) << c.id;
    }
  }
}

TEST(PolynomialFit, EveryWavelengthHasItsFit) {
  const GlassCatalogue glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const std::array<double, 3> nm{656.2725, 587.5618, 486.1327};
  const Lens lens = compile(data_prescription("double_gauss_100mm_f2_28deg"), nm, {.glasses = &glasses});
  const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, 20);
  const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, 9);
  ASSERT_EQ(polynomial.fits().size(), 3u);
  const double focal_length = first_order(lens).effective_focal_length;
  for (std::size_t w = 0; w < 3; ++w) {
    EXPECT_EQ(polynomial.fits()[w].wavelength_nm, nm[w]);
    const Lines<double> lines = lines_through<double>(pupils, 1000, 5, w);
    Lines<double> rays = lines;
    EXPECT_LT(1e3 * focal_length * errors(lens, polynomial, rays.through(polynomial, {w}), lines, w).rms_rad, 0.1);
    // With the fit of another wavelength the error is the chromatic aberration.
    const std::size_t other = (w + 1) % 3;
    EXPECT_GT(1e3 * focal_length * errors(lens, polynomial, rays.through(polynomial, {other}), lines, w).rms_rad, 1);
  }
}

// Few modes suffice: their error is below the error of the fits and the rounding of float.
TEST(PolynomialFit, FittedWavelengthsInNmEqualTheirFits) {
  const GlassCatalogue glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const auto even = [](double from, double to, int count) {
    std::vector<double> nm;
    for (int w = 0; w < count; ++w) nm.push_back(from + (to - from) * w / (count - 1));
    return nm;
  };
  // Unequally spaced wavelengths are interpolated linearly, and dispersion is steep at the end of a wide range.
  const std::vector<double> lines{404.6565, 435.8343, 632.8, 643.8469, 656.2725}, close{400, 401, 402, 700};
  for (const auto& nm : {even(400, 700, 13), even(380, 780, 21), lines, close}) {
    SCOPED_TRACE(nm[1]);
    const Lens lens = compile(data_prescription("double_gauss_100mm_f2_28deg"), nm, {.glasses = &glasses});
    const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, 20);
    for (const int degree : {5, 9}) {
      const RayPolynomial polynomial = RayPolynomial::fit(lens, pupils, degree);
      for (std::size_t w = 0; w < nm.size(); ++w) {
        Lines<double> own = lines_through<double>(pupils, 500, 5, w), between = own, shared = own;
        const std::vector<float> each(own.size(), static_cast<float>(nm[w]));
        own.through(polynomial, {w});
        between.through(polynomial, {.each_nm = each.data()});
        shared.through(polynomial, {Wavelength::nm(nm[w])});
        const auto& [fit_rad, fit_mm] = std::pair(polynomial.fits()[w].rms_rad, polynomial.fits()[w].rms_mm);
        double rad2 = 0, mm2 = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
          ASSERT_EQ(between.fates[i], RayFate::transmitted);
          rad2 += glm::dot(between.direction(i) - own.direction(i), between.direction(i) - own.direction(i));
          mm2 += glm::dot(between.origin(i) - own.origin(i), between.origin(i) - own.origin(i));
          ASSERT_LT(glm::length(between.direction(i) - shared.direction(i)), 1e-8);  // nm in float
        }
        const auto count = static_cast<double>(own.size());
        EXPECT_LT(std::sqrt(rad2 / count), 0.05 * fit_rad + 4e-7) << degree << " " << nm[w];
        EXPECT_LT(std::sqrt(mm2 / count), 0.05 * fit_mm + 3e-5) << degree << " " << nm[w];
      }
    }
  }
}

TEST(PolynomialFit, RefusesInvalidLensesAndDegrees) {
  const Lens lens = data_lens("double_gauss_100mm_f2_28deg");
  const FilmPupilTable pupils = FilmPupilTable::equal_area(lens, 20);
  const auto why = [&](const Lens& of, const FilmPupilTable& map, int degree) {
    return testing::message([&] { RayPolynomial::fit(of, map, degree); });
  };
  expect_tokens(why(lens, pupils, 6), {lens.name(), "degree", 6});
  expect_tokens(why(lens, FilmPupilTable::equal_area(lens, 0), 5), {lens.name(), "film", "radius", 0});
  const GlassCatalogue glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const std::array<double, 2> nm{656.2725, 486.1327};
  const Lens coloured = compile(data_prescription("double_gauss_100mm_f2_28deg"), nm, {.glasses = &glasses});
  expect_tokens(why(coloured, pupils, 5), {lens.name(), "wavelengths", 1, 2});
  // The pupils of the open lens do not fit the almost closed lens.
  expect_tokens(why(with_f_number(lens, 200), pupils, 11), {lens.name(), "polynomial"});
}

}  // namespace fit_test
}  // namespace petzval
