// SPDX-License-Identifier: Apache-2.0
// Cameras with a ray model of the renderer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "camera/exact_model.hpp"
#include "camera/make_model.hpp"
#include "camera/paraxial_model.hpp"
#include "camera/polynomial_model.hpp"
#include "camera/ray_model.hpp"
#include "camera_parts.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace custom_model_test {

using testing::expect_error;
using testing::random_samples;

/// A thin lens in air as a renderer would write it: rays are refracted in the rear principal plane and leave from the
/// front principal plane. The pupil is a disc that gives the centre of the film the irradiance of the exact lens.
class OwnThinLens {
 public:
  static constexpr bool linear_in_slopes = true;

  OwnThinLens(const Lens& lens, const testing::CardinalPoints& points, double film_radius)
      : front_z_(points.front_principal_z),
        focal_length_(points.focal_length),
        depth_(two_planes(lens).depth()),
        to_lens_(points.rear_principal_z - lens.film_z()),
        pupils_(disc(lens, film_radius)) {}

  const FilmPupilTable& pupils() const noexcept { return pupils_; }

  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths&, const RayArrays<T>& rays,
                RayFate* fates) const noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      const double slope_x = (lines.pupil_x[i] - lines.film_x[i]) / depth_;
      const double slope_y = (lines.pupil_y[i] - lines.film_y[i]) / depth_;
      const double x = lines.film_x[i] + slope_x * to_lens_, y = lines.film_y[i] + slope_y * to_lens_;
      const Vec3<double> d = -glm::normalize(Vec3<double>(slope_x + x / focal_length_, slope_y + y / focal_length_, 1));
      rays.x[i] = static_cast<T>(x), rays.y[i] = static_cast<T>(y), rays.z[i] = static_cast<T>(front_z_);
      rays.dx[i] = static_cast<T>(d.x), rays.dy[i] = static_cast<T>(d.y), rays.dz[i] = static_cast<T>(d.z);
      fates[i] = RayFate::transmitted;
    }
  }
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths&,
               const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      const bool arrives = rays.dz[i] > 0;
      const double slope_x = rays.dx[i] / rays.dz[i], slope_y = rays.dy[i] / rays.dz[i], way = front_z_ - rays.z[i];
      const double x = rays.x[i] + slope_x * way, y = rays.y[i] + slope_y * way;
      const double behind_x = slope_x - x / focal_length_, behind_y = slope_y - y / focal_length_;
      lines.film_x[i] = arrives ? x - behind_x * to_lens_ : 0;
      lines.film_y[i] = arrives ? y - behind_y * to_lens_ : 0;
      lines.pupil_x[i] = arrives ? lines.film_x[i] + behind_x * depth_ : 0;
      lines.pupil_y[i] = arrives ? lines.film_y[i] + behind_y * depth_ : 0;
      fates[i] = arrives ? RayFate::transmitted : RayFate::missed_surface;
    }
  }

 private:
  /// A disc in the rear principal plane of the paraxial lens, projected into the plane of the pupils.
  static FilmPupilTable disc(const Lens& lens, double film_radius) {
    const TwoPlanes planes = two_planes(lens);
    const double part = (first_order(lens).rear_principal_z - planes.film_z) / planes.depth();
    const double sine2 = film_irradiance(lens, {}) / std::numbers::pi;
    const double shift = (part - 1) / part, radius = std::abs(planes.depth()) * std::sqrt(sine2 / (1 - sine2));
    const PupilImage disc{{shift, shift}, {radius, radius}};
    return FilmPupilTable::of_iris(planes, {}, {&disc, 1}, film_radius, lens.primary_wavelength());
  }

  double front_z_, focal_length_, depth_, to_lens_;
  FilmPupilTable pupils_;
};

/// A square hole of 2 by 2 mm in a screen 50 mm in front of the film, without a lens; the model clips its rays.
class Hole {
 public:
  static constexpr bool clips_at_apertures = true;

  Hole(double film_z, double film_radius)
      : pupils_(FilmPupilTable::of_discs({.film_z = film_z, .pupil_z = film_z - 50},
                                         std::array{std::vector<PupilDisc>{{0, 2}}}, film_radius)) {}
  const FilmPupilTable& pupils() const noexcept { return pupils_; }

  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths&, const RayArrays<T>& rays,
                RayFate* fates) const noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      const T dx = lines.pupil_x[i] - lines.film_x[i], dy = lines.pupil_y[i] - lines.film_y[i];
      const T length = std::sqrt(dx * dx + dy * dy + T(2500));
      rays.x[i] = lines.pupil_x[i], rays.y[i] = lines.pupil_y[i], rays.z[i] = static_cast<T>(pupils_.space().pupil_z);
      rays.dx[i] = dx / length, rays.dy[i] = dy / length, rays.dz[i] = T(-50) / length;
      fates[i] = passes(lines.pupil_x[i], lines.pupil_y[i]) ? RayFate::transmitted : RayFate::vignetted;
    }
  }
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths&,
               const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept {
    const auto& [film_z, hole_z] = pupils_.space();
    for (std::size_t i = 0; i < count; ++i) {
      const double slope_x = rays.dx[i] / rays.dz[i], slope_y = rays.dy[i] / rays.dz[i];
      lines.film_x[i] = rays.x[i] + slope_x * (film_z - rays.z[i]);
      lines.film_y[i] = rays.y[i] + slope_y * (film_z - rays.z[i]);
      lines.pupil_x[i] = rays.x[i] + slope_x * (hole_z - rays.z[i]);
      lines.pupil_y[i] = rays.y[i] + slope_y * (hole_z - rays.z[i]);
      fates[i] = passes(lines.pupil_x[i], lines.pupil_y[i]) ? RayFate::transmitted : RayFate::vignetted;
    }
  }

 private:
  static bool passes(double x, double y) noexcept { return std::abs(x) <= 1 && std::abs(y) <= 1; }

  FilmPupilTable pupils_;
};

static_assert(RayModel<OwnThinLens> && RayModel<Hole> && RayModel<AnyRayModel> && RayModel<PolynomialModel>);
static_assert(RayModel<camera_detail::ParaxialModel>);
static_assert(RayModel<camera_detail::ExactModel<float>> && RayModel<camera_detail::ExactModel<double>>);

void expect_same_line(const Ray<double>& a, const Ray<double>& b, double tolerance) {
  EXPECT_NEAR(glm::length(a.direction - b.direction), 0, tolerance);
  EXPECT_NEAR(glm::length(glm::cross(a.origin - b.origin, b.direction)), 0, 100 * tolerance);
}

class CustomModel : public ::testing::TestWithParam<Film> {
 protected:
  const Lens lens_ = with_focus(testing::data_lens("double_gauss_100mm_f2.0"), 2000);
  const double radius_ =
      std::max(upright_radius(lens_, GetParam()), upright_radius(lens_, GetParam(), ModelKind::thin));
  const AnyRayModel thin_ = camera_detail::make_model(ModelKind::thin, lens_, radius_);
  const Camera built_in_ = camera_with(lens_, GetParam(), thin_);
  const Camera own_ =
      camera_with(lens_, GetParam(), AnyRayModel(OwnThinLens(lens_, testing::cardinal_points(thin_), radius_)));
};

TEST_P(CustomModel, SamplesEqualBuiltInModel) {
  EXPECT_EQ(own_.model(), ModelKind::custom);
  auto samples = random_samples(GetParam(), 200), same = samples;
  samples.run(own_);
  same.run(built_in_);
  int passed = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CameraRay one = own_.sample(samples.one(i)), wanted = built_in_.sample(samples.one(i));
    ASSERT_EQ(one.fate, wanted.fate);
    EXPECT_EQ(samples.fates[i], same.fates[i]);
    EXPECT_NEAR(one.weight, wanted.weight, 1e-9 * wanted.weight);
    EXPECT_NEAR(samples.weights[i], same.weights[i], 1e-9 * same.weights[i]);
    EXPECT_NEAR(one.pdf_direction, wanted.pdf_direction, 1e-9 * wanted.pdf_direction);
    expect_same_line(one.ray, wanted.ray, 1e-12);
    expect_same_line(samples.ray(i), same.ray(i), 1e-12);
    passed += one.weight > 0;
  }
  EXPECT_GT(passed, 150);
}

TEST_P(CustomModel, DifferentialsEqualBuiltInModel) {
  const auto samples = random_samples(GetParam(), 50);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CameraRayDifferential own = own_.sample_differential(samples.one(i));
    const CameraRayDifferential wanted = built_in_.sample_differential(samples.one(i));
    EXPECT_NEAR(glm::length(own.by_film_x.direction - wanted.by_film_x.direction), 0, 1e-9);
    EXPECT_NEAR(glm::length(own.by_film_y.direction - wanted.by_film_y.direction), 0, 1e-9);
  }
}

TEST_P(CustomModel, ImportanceEqualsBuiltInModel) {
  int seen = 0, projected = 0;
  for (int i = 0; i < 200; ++i) {
    const double u = std::fmod(i * std::numbers::phi, 1.0), v = (i + 0.5) / 200, turn = 2 * std::numbers::pi * u;
    const Vec3<double> point{400 * v * std::cos(turn), 400 * v * std::sin(turn), -500 - 4000 * u};
    const ImportanceSample own = own_.sample_importance(point, v, u), wanted = built_in_.sample_importance(point, v, u);
    // Entrance pupils are searched to 2e-5 and enlarged by the tolerance of the search, so that rounding of the rays
    // changes their area by up to 6e-4. The estimates are equal for any area that encloses the pupil.
    EXPECT_NEAR(own.pdf, wanted.pdf, 1e-3 * wanted.pdf);
    EXPECT_NEAR(glm::length(own.direction - wanted.direction), 0, 1e-5);
    // A direction on the border of two sectors of the polygon may fall into either; their areas differ by up to 1 %.
    EXPECT_NEAR(own_.pdf_importance(point, wanted.direction), wanted.pdf, 1e-2 * wanted.pdf);
    const Importance a = own_.importance({wanted.on_front, wanted.direction}), b = wanted.importance;
    if (a.fate != b.fate) continue;  // at an edge
    EXPECT_NEAR(a.we, b.we, 1e-9 * b.we);
    EXPECT_NEAR(a.pdf_direction, b.pdf_direction, 1e-6 * b.pdf_direction);
    EXPECT_NEAR(std::hypot(a.film.x - b.film.x, a.film.y - b.film.y), 0, 1e-6);
    seen += a.we > 0;

    const Projection p = own_.project(point), q = built_in_.project(point);
    EXPECT_EQ(p.status, q.status);
    EXPECT_NEAR(std::hypot(p.film.x - q.film.x, p.film.y - q.film.y), 0, 1e-6);
    projected += p.status == ProjectionStatus::converged;
  }
  EXPECT_GT(seen, 50);
  EXPECT_GT(projected, 50);
}

INSTANTIATE_TEST_SUITE_P(Films, CustomModel,
                         ::testing::Values(Film{}, Film{.shift_y_mm = 4, .tilt_rad = 0.2, .swing_rad = -0.1}),
                         [](const auto& test) { return test.param.tilted() ? "tilted" : "upright"; });

/// The mean weight at the film point (6, -8).
double mean_weight(const Camera& camera) {
  testing::Samples<double> samples;
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) samples.add(6, -8, std::fmod(i * std::numbers::phi, 1.0), (i + 0.5) / count);
  samples.run(camera);
  double sum = 0;
  for (const double weight : samples.weights) sum += weight;
  return sum / count;
}

TEST(OwnModel, RefusesPolynomialsOfAnotherLensOrFilm) {
  const Prescription prescription = testing::data_prescription("double_gauss_100mm_f2.0");
  const auto focused = [&](std::vector<double> nm, double distance) {
    return with_focus(compile(prescription, nm, {.missing_glass = MissingGlass::abbe}), distance);
  };
  const Lens lens = focused({587.5618, 450, 650}, 1000);
  const Film film;
  const double radius = upright_radius(lens, film);
  const auto camera = [&](const Lens& fitted, double to) {
    const RayPolynomial polynomial = RayPolynomial::fit(fitted, FilmPupilTable::equal_area(fitted, to), 5);
    const PolynomialModel model(polynomial, FilmPupilTable::equal_area(lens, radius));
    return [=] { camera_with(lens, film, AnyRayModel(model)); };
  };
  EXPECT_NO_THROW(camera(lens, radius)());
  const Lens near = focused({587.5618, 450, 650}, 2000);
  expect_error(camera(near, radius), {lens.name(), "polynomials", near.film_z(), lens.film_z()});
  expect_error(camera(focused({450}, 1000), radius), {lens.name(), "polynomials", "wavelengths", 1, 3});
  expect_error(camera(lens, 5), {lens.name(), "polynomials", 5, radius});
}

TEST(OwnModel, MayClipByItself) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  const Film film{.width_mm = 20, .height_mm = 20};
  const Camera camera = camera_with(lens, film, AnyRayModel(Hole(lens.film_z(), film.radius_mm())));
  // The irradiance of a small hole of 4 mm^2: area cos^4 / 50^2.
  const double square = 2500.0 / (2500 + 100);
  EXPECT_NEAR(mean_weight(camera) / (4 * square * square / 2500), 1, 3e-3);
  const Vec3<double> point{30, 20, -400};
  for (int i = 0; i < 100; ++i) {
    const ImportanceSample s = camera.sample_importance(point, (i + 0.5) / 100, std::fmod(i * std::numbers::phi, 1.0));
    const Vec3<double> hole = point + s.direction * ((lens.film_z() - 50 - point.z) / s.direction.z);
    const bool passes = std::abs(hole.x) <= 1 && std::abs(hole.y) <= 1;
    EXPECT_EQ(bool(s), passes);
  }
}

TEST(OwnModel, AcceptsATiltedFilm) {
  const double tilt = 0.3;
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  const Film film{.width_mm = 20, .height_mm = 20, .tilt_rad = tilt};
  const Camera camera = camera_with(lens, film, AnyRayModel(Hole(lens.film_z(), 30)));
  // The irradiance of the small hole at the film point (6, -8 cos, 50 - 8 sin) with normal (0, -sin, cos).
  const double y = -8 * std::cos(tilt), z = 50 - 8 * std::sin(tilt), length2 = 36 + y * y + z * z;
  const double at_film = y * -std::sin(tilt) + z * std::cos(tilt);
  EXPECT_NEAR(mean_weight(camera) / (4 * z * at_film / (length2 * length2)), 1, 3e-3);
}

}  // namespace custom_model_test
}  // namespace petzval
