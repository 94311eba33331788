// SPDX-License-Identifier: Apache-2.0
// Optical paths, wavefront errors and Zernike coefficients.
#include "petzval/analysis/wavefront.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "analysis/optical_path.hpp"
#include "analysis/pupil_nodes.hpp"
#include "petzval/analysis/aberrations.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace wavefront_test {

constexpr double far = -std::numeric_limits<double>::infinity();
constexpr double wave_mm = d_line_nm * 1e-6;

Lens compiled(std::vector<SurfaceRow> surfaces) {
  Prescription p;
  p.name = "test";
  p.surfaces = std::move(surfaces);
  return compile(p);
}

Wavefront at(const Lens& lens, double field_deg, PupilCoordinates coordinates = PupilCoordinates::stop,
             std::size_t directions = 48) {
  const auto result = wavefront(lens, {.field_rad = radians(field_deg), .z = far}, {}, coordinates, directions);
  EXPECT_TRUE(result);
  return result.value_or(Wavefront{});
}

/// Zernike sum of a wavefront at one of its points.
double polynomials(const Wavefront& front, const Vec2<double>& pupil) {
  double sum = 0;
  for (std::size_t k = 0; k < zernike_terms; ++k) sum += front.zernike[k] * zernike_fringe(k, pupil);
  return sum;
}

TEST(ZernikeFringe, HasThePublishedPolynomials) {
  const Vec2<double> p{0.3, 0.6};
  const double r2 = 0.45, r = std::sqrt(r2), c = 0.3 / r, s = 0.6 / r, c2 = c * c - s * s, s2 = 2 * s * c;
  const std::array expected{1.0,
                            0.3,
                            0.6,
                            2 * r2 - 1,
                            r2 * c2,
                            r2 * s2,
                            (3 * r2 - 2) * 0.3,
                            (3 * r2 - 2) * 0.6,
                            6 * r2 * r2 - 6 * r2 + 1,
                            r2 * r * (c2 * c - s2 * s),
                            r2 * r * (s2 * c + c2 * s),
                            (4 * r2 - 3) * r2 * c2,
                            (4 * r2 - 3) * r2 * s2,
                            (10 * r2 * r2 - 12 * r2 + 3) * 0.3,
                            (10 * r2 * r2 - 12 * r2 + 3) * 0.6,
                            20 * r2 * r2 * r2 - 30 * r2 * r2 + 12 * r2 - 1};
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(zernike_fringe(k, p), expected[k], 1e-14) << k + 1;
  const double r4 = r2 * r2, r8 = r4 * r4;
  EXPECT_NEAR(zernike_fringe(36, p),
              924 * r8 * r4 - 2772 * r8 * r2 + 3150 * r8 - 1680 * r4 * r2 + 420 * r4 - 42 * r2 + 1, 1e-12);
  testing::expect_error([] { zernike_fringe(37, {}); }, {"term", 37, 36});
}

TEST(Wavefront, OfAParabolicMirrorIsPerfectOnTheAxis) {
  SurfaceRow mirror{.radius = -200, .thickness = -100, .semi_diameter = 40, .conic = -1, .stop = true, .mirror = true};
  const Lens lens = compiled({mirror});
  const Wavefront front = at(lens, 0);
  EXPECT_LT(front.peak_to_valley_waves, 1e-8);
  EXPECT_NEAR(front.strehl.value(), 1, 1e-12);
  EXPECT_NEAR(front.reference_radius, 100, 1e-9);
  EXPECT_EQ(front.points.size(), 48u * 17u);
}

TEST(Wavefront, OfADefocusedFilmIsTheDifferenceOfTwoSpheres) {
  SurfaceRow mirror{.radius = -200, .thickness = -100, .semi_diameter = 20, .conic = -1, .stop = true, .mirror = true};
  const Lens sharp = compiled({mirror});
  constexpr double shift = 0.01;
  const Wavefront front = at(with_film(sharp, sharp.film_z() - shift), 0);
  // A ray of slope angle a is longer by the shift times 1 - cos(a) than the axial ray, up to terms of shift^2.
  for (const auto& [pupil, waves, weight] : front.points) {
    const double height = 20 * std::hypot(pupil.x, pupil.y), a = 2 * std::atan(height / 200);
    EXPECT_NEAR(waves * wave_mm, shift * (1 - std::cos(a)), shift * shift * 1e-3);
  }
  EXPECT_GT(front.zernike[3], 0);
  // Strehl ratio of defocus: sinc^2 of half of the range of the phase.
  const double half = std::numbers::pi * front.peak_to_valley_waves;
  EXPECT_NEAR(front.strehl.value(), std::pow(std::sin(half) / half, 2), 0.01);
  EXPECT_FALSE(at(with_film(sharp, sharp.film_z() - 1), 0).strehl);
}

// An infinite radius of the reference sphere: the stop lies in the front focal plane.
TEST(Wavefront, OfATelecentricImageSpaceHasAnInfiniteSphere) {
  const Lens singlet = compiled({{.radius = 50, .thickness = 4, .medium = {.nd = 1.5}, .semi_diameter = 15},
                                 {.radius = -50, .thickness = 50, .semi_diameter = 15}});
  const double front_focus = first_order(singlet).front_focal_distance;
  const Lens lens = compiled({{.radius = 0, .thickness = -front_focus, .semi_diameter = 2, .stop = true},
                              {.radius = 50, .thickness = 4, .medium = {.nd = 1.5}, .semi_diameter = 15},
                              {.radius = -50, .thickness = 50, .semi_diameter = 15}});
  const Lens focused = with_film(lens, paraxial_image_z(lens, far));
  const Wavefront front = at(focused, 3);
  EXPECT_GT(std::abs(front.reference_radius), 1e9);
  EXPECT_LT(front.rms_waves, 1);
  EXPECT_GT(front.rms_waves, 1e-3);
}

// Third order: W = S1/8 r^4 + S2/2 y r^2 + S3/2 y^2 + (S3 + S4)/4 r^2, in waves of small apertures and fields.
TEST(Wavefront, HasTheSeidelTermsOfSmallAperturesAndFields) {
  const Lens open = testing::data_lens("cooke_triplet_50mm_f5");
  const Lens lens = with_film(with_f_number(open, 40), paraxial_image_z(open, far));
  constexpr double field_deg = 1.5;
  const SeidelTerms sums = seidel_sums(lens, {.field_rad = radians(field_deg)}).sums;
  const Wavefront axis = at(lens, 0), front = at(lens, field_deg);
  EXPECT_NEAR(6 * axis.zernike[8] * wave_mm / (sums.s1 / 8), 1, 0.01);
  // The chief ray of the sums rises: its point lies at -y.
  EXPECT_NEAR(-3 * front.zernike[7] * wave_mm / (sums.s2 / 2), 1, 0.02);
  // cos 2a is taken from +x, the field lies along y: y^2 = (r^2 - r^2 cos 2a) / 2.
  EXPECT_NEAR(-2 * front.zernike[4] * wave_mm / (sums.s3 / 2), 1, 0.02);
  // y^2 holds half of r^2.
  const double defocus = 2 * (front.zernike[3] - axis.zernike[3]) * wave_mm;
  EXPECT_NEAR(defocus / (sums.s3 / 4 + (sums.s3 + sums.s4) / 4), 1, 0.02);
}

/// Path of a ray through spherical surfaces and to the reference sphere, in long double, by formulas of its own.
class LongPath {
 public:
  using L = long double;
  struct V {
    L x, y, z;
  };
  explicit LongPath(const Lens& lens) : lens_(lens) {}

  /// From a plane wavefront through the origin point of the chief ray; `start` is in front of the lens.
  L operator()(V p, const V& direction, const V& wavefront_point, const V& image, L radius) const {
    V d = direction;
    L path = dot(minus(p, wavefront_point), d) * index(0);
    for (std::size_t i = 0; i < lens_.surface_count(); ++i) {
      const L c = lens_.surfaces()[i].curvature, z = lens_.surfaces()[i].vertex_z;
      const V q{p.x, p.y, p.z - z};
      // c |q + t d|^2 = 2 (q + t d)_z
      const L a = c, b = c * dot(q, d) - d.z, e = c * dot(q, q) - 2 * q.z;
      const L t = e / (-b + std::sqrt(b * b - a * e));
      p = {p.x + t * d.x, p.y + t * d.y, p.z + t * d.z};
      path += index(i) * t;
      V n{-c * p.x, -c * p.y, 1 - c * (p.z - z)};
      const L ratio = index(i) / index(i + 1), cosine = dot(n, d);
      const L k = std::sqrt(1 - ratio * ratio * (1 - cosine * cosine)) - ratio * cosine;
      d = {ratio * d.x + k * n.x, ratio * d.y + k * n.y, ratio * d.z + k * n.z};
    }
    const V from = minus(p, image);
    const L along = dot(from, d), square = dot(from, from);
    return path + index(lens_.surface_count()) * (-along - std::sqrt(radius * radius - square + along * along));
  }

 private:
  static L dot(const V& a, const V& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static V minus(const V& a, const V& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  L index(std::size_t space) const { return lens_.index(space); }

  const Lens& lens_;
};

TEST(Wavefront, EqualsPathsInLongDouble) {
  const Lens lens = with_focus(testing::data_lens("double_gauss_100mm_f1.35"), std::numeric_limits<double>::infinity());
  const Pupil entrance = pupils(lens).entrance;
  const LongPath path(lens);
  for (const double field_deg : {0.0, 6.0, 12.0}) {
    const double field = radians(field_deg);
    const Wavefront front = at(lens, field_deg, PupilCoordinates::entrance);
    // Light travels towards -y: the point lies at +y.
    const LongPath::V direction{0, -std::sin(field), std::cos(field)}, middle{0, 0, entrance.z};
    const LongPath::V image{front.image.x, front.image.y, lens.film_z()};
    const AimedRay chief = chief_ray(lens, {.field_rad = field, .z = far});
    const auto from = [&](const Vec3<double>& on_ray) {
      // 50 mm in front of the lens.
      const long double t = (-50 - on_ray.z) / direction.z;
      return path({on_ray.x + t * direction.x, on_ray.y + t * direction.y, -50}, direction, middle, image,
                  front.reference_radius);
    };
    const long double reference = from(chief.ray.origin);
    double farthest = 0;
    for (const auto& [pupil, waves, weight] : front.points) {
      const double unit = entrance.diameter / 2;
      const long double own = (reference - from({pupil.x * unit, pupil.y * unit, entrance.z})) / wave_mm;
      farthest = std::max(farthest, std::abs(waves - static_cast<double>(own)));
    }
    EXPECT_LT(farthest, 1e-8) << field_deg;
    EXPECT_GT(front.rms_waves, 1);
  }
}

TEST(Wavefront, IsTheSumOfItsPolynomialsAndAResidual) {
  const Wavefront front = at(testing::data_lens("cooke_triplet_50mm_f5"), 10);
  double squares = 0, weights = 0;
  for (const auto& [pupil, waves, weight] : front.points) {
    squares += weight * std::pow(waves - polynomials(front, pupil), 2), weights += weight;
  }
  EXPECT_NEAR(weights, 1, 1e-12);
  EXPECT_NEAR(std::sqrt(squares), front.zernike_residual_waves, 1e-9);
  EXPECT_LT(front.zernike_residual_waves, front.rms_waves / 100);
}

TEST(Wavefront, DiffersFromTenTimesTheRaysByTheStatedError) {
  const Lens lens = with_focus(testing::data_lens("double_gauss_100mm_f1.35"), std::numeric_limits<double>::infinity());
  for (const double field_deg : {0.0, 7.0, 14.0}) {
    const Wavefront few = at(lens, field_deg), many = at(lens, field_deg, PupilCoordinates::stop, 480);
    EXPECT_LE(std::abs(few.rms_waves - many.rms_waves), few.sampling_error_waves + 1e-9) << field_deg;
    EXPECT_LE(few.sampling_error_waves, 0.05 * few.rms_waves + 1e-9) << field_deg;
  }
}

/// Strehl ratio by 64 x 192 rays, at the image point with the smallest RMS.
double converged_strehl(const Lens& lens, const FieldPoint& point) {
  const auto errors = analysis_detail::SphereErrors::of(lens, point, 0);
  const auto nodes = analysis_detail::pupil_nodes<64>(pupil_boundary(lens, point, {}, 192));
  const auto each = [&](const auto& use) {
    for (const auto& node : nodes) {
      const auto ray = errors->paths()(node.position);
      if (ray) use((*errors)(*ray), node.area, glm::dvec3(1, ray->direction.x, ray->direction.y));
    }
  };
  glm::dmat3 products(0);
  glm::dvec3 moments(0);
  double area = 0;
  each([&](double waves, double weight, const glm::dvec3& at) {
    products += weight * glm::outerProduct(at, at), moments += weight * waves * at, area += weight;
  });
  const glm::dvec3 plane = glm::inverse(products) * moments;
  std::complex<double> sum = 0;
  each([&](double waves, double weight, const glm::dvec3& at) {
    sum += std::polar(weight, 2 * std::numbers::pi * (waves - glm::dot(plane, at)));
  });
  return std::norm(sum / area);
}

TEST(Wavefront, StrehlRatioIsConverged) {
  int seen = 0;
  for (const char* name : {"cooke_triplet_50mm_f5", "double_gauss_52mm_f1.8", "telephoto_200mm_f1.8"}) {
    const Lens open = testing::data_lens(name);
    for (const double f_number : {5.6, 8.0}) {
      const Lens lens = with_f_number(open, f_number);
      for (const double field_deg : {0.0, 5.0, 12.0, 18.0}) {
        const auto front = wavefront(lens, {.field_rad = radians(field_deg), .z = far});
        if (!front || !front->strehl) continue;
        ++seen;
        EXPECT_NEAR(*front->strehl, converged_strehl(lens, {.field_rad = radians(field_deg), .z = far}),
                    front->strehl_error + 1e-6)
            << name << " f/" << f_number << ' ' << field_deg;
        EXPECT_LE(front->strehl_error, 1e-3) << name << " f/" << f_number << ' ' << field_deg;
      }
    }
  }
  EXPECT_GT(seen, 5);
}

TEST(Wavefront, TurnsWithTheField) {
  const Lens lens = testing::data_lens("cooke_triplet_50mm_f5");
  const Wavefront up = at(lens, 12), down = at(lens, -12);
  const auto right = wavefront(lens, {.field_rad = radians(12.0), .z = far, .azimuth_rad = std::numbers::pi / 2});
  ASSERT_TRUE(right);
  EXPECT_NEAR(up.rms_waves, down.rms_waves, 1e-9);
  EXPECT_NEAR(up.zernike[7], -down.zernike[7], 1e-8);  // coma along y
  EXPECT_NEAR(up.zernike[7], right->zernike[6], 1e-8);
  EXPECT_NEAR(up.zernike[4], -right->zernike[4], 1e-8);
  EXPECT_NEAR(up.zernike[6], 0, 1e-8);
}

TEST(Wavefront, OfALargerLensIsLarger) {
  const Prescription rows = testing::data_prescription("cooke_triplet_50mm_f5");
  const Wavefront small = at(compile(rows), 8), large = at(compile(scale(rows, 3)), 8);
  EXPECT_NEAR(large.rms_waves / small.rms_waves, 3, 1e-8);
  EXPECT_NEAR(large.reference_radius / small.reference_radius, 3, 1e-9);
}

TEST(RayFans, HaveTheWavefrontErrorsOfTheirRays) {
  const Lens lens = with_f_number(testing::data_lens("cooke_triplet_50mm_f5"), 8);
  constexpr double field_deg = 10;
  const Wavefront front = at(lens, field_deg);
  const std::array fields{radians(field_deg)};
  int seen = 0;
  double largest = 0;
  const Grid<RayFan> fans = ray_fans(lens, far, fields, 21);
  for (const RayFan::Point& point : fans[0][0].points) {
    if (!point.tangential_waves || !point.sagittal_waves) continue;
    ++seen;
    EXPECT_NEAR(*point.tangential_waves, polynomials(front, {0, point.pupil}), 0.01);
    EXPECT_NEAR(*point.sagittal_waves, polynomials(front, {point.pupil, 0}), 0.01);
    largest = std::max(largest, std::abs(*point.tangential_waves));
  }
  EXPECT_EQ(seen, 21);
  EXPECT_GT(largest, 0.5);
}

TEST(Wavefront, NeedsAChiefRayAndAPupil) {
  const Lens lens = testing::data_lens("cooke_triplet_50mm_f5");
  EXPECT_FALSE(wavefront(lens, {.field_rad = radians(80.0), .z = far}));
  testing::expect_error([&] { at(lens, 0, PupilCoordinates::stop, 13); }, {"directions", 13, 12});
  testing::expect_error([&] { wavefront(lens, {}, 5); }, {"wavelength"});
}

}  // namespace wavefront_test
}  // namespace petzval
