// SPDX-License-Identifier: Apache-2.0
// The iris of a batch, compared with the crossings of the rays with the plane of the stop.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "../blades.hpp"
#include "batches.hpp"

namespace batch_iris_test {

using namespace testing_batches;
using petzval::Iris;

/// Straight, hollow and rounded edges, not parallel to the axes.
std::vector<Iris> irises() {
  return {{.blades = 6, .rotation_rad = 0.3},
          {.blades = 4, .roundness = -0.8, .rotation_rad = 0.2},
          {.blades = 5, .roundness = 0.2, .rotation_rad = 0.1}};
}

/// Distance of a ray's crossing of the stop to the nearest edge, above 0 inside; nullopt if the ray misses the stop.
template <class T>
std::optional<double> room_at_the_stop(const Lens& lens, const Ray<T>& ray, Travel travel) {
  std::optional<double> room;
  const auto stop = static_cast<int>(*lens.stop());
  const double radius = lens.surfaces()[*lens.stop()].semi_diameter;
  const Ray<double> exact{petzval::Vec3<double>(ray.origin), petzval::Vec3<double>(ray.direction)};
  petzval::kernel::trace(petzval::kernel::view<double>(lens), petzval::kernel::to_kernel(exact.origin),
                         petzval::kernel::to_kernel(exact.direction), {.travel = travel, .apertures = false},
                         [&](int surface, const petzval::kernel::Vec<double>& p, const petzval::kernel::Vec<double>&) {
                           if (surface != stop) return;
                           const double x = p.x / radius, y = p.y / radius;
                           room = petzval::testing::room_between_blades(lens.iris(), x, y) * radius;
                         });
  return room;
}

template <class T>
class BatchIris : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchIris, Plain);

TYPED_TEST(BatchIris, ClipsRaysOutsideAnEdge) {
  using T = TypeParam;
  const std::vector<Iris> shapes = irises();
  std::size_t turn = 0;
  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_10mm_f4", "modern_58mm_f0.95", "anamorphic_60mm_2x"}) {
    const auto sample = testing_lenses::load(id);
    const int stop = static_cast<int>(sample.lens.stop().value());
    const auto surface = static_cast<std::size_t>(stop);
    const Lens lens =
        petzval::with_semi_diameter(sample.lens, surface, sample.lens.surfaces()[surface].semi_diameter / 2);
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 600);
      for (BatchOptions options : every_batch(travel)) {
        const Iris& iris = shapes[turn++ % shapes.size()];
        const Lens bladed = petzval::with_iris(lens, iris);
        const auto open = traced(lens, rays, options);
        const auto clipped = traced(bladed, rays, options);
        int inside = 0, outside = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          const bool reached = open.fates[i] == RayFate::transmitted ||
                               (travel == Travel::to_film ? open.surfaces[i] > stop : open.surfaces[i] < stop);
          const auto room = reached ? room_at_the_stop(bladed, rays[i], travel) : std::nullopt;
          // Within the error of the crossing either fate is correct.
          if (room && std::abs(*room) < 1000 * std::numeric_limits<T>::epsilon() * sample.size) continue;
          if (room) {
            const auto one = petzval::trace(bladed, rays[i], {.travel = travel});
            ASSERT_EQ(one.fate == RayFate::vignetted && one.surface == stop, *room < 0) << what;
          }
          if (room && *room < 0) {
            ASSERT_EQ(clipped.fates[i], RayFate::vignetted) << what;
            ASSERT_EQ(clipped.surfaces[i], stop) << what;
            ASSERT_TRUE(same_bits(clipped.rays[i], rays[i])) << what;
            ++outside;
          } else {
            ASSERT_TRUE(same_bits(clipped, i, open, i)) << what;
            inside += room.has_value();
          }
        }
        EXPECT_GT(inside, 10) << sample.id << " " << text(options);
        EXPECT_GT(outside, 3) << sample.id << " " << text(options);
      }
    }
  }
}

/// A plane stop of 10 mm between two planes, in air.
petzval::Prescription window() {
  petzval::Prescription p;
  p.name = "window";
  p.surfaces = {{.thickness = 2}, {.thickness = 3, .semi_diameter = 10, .stop = true}, {.thickness = 1}};
  return p;
}

/// Fates of rays parallel to the axis through points of the stop.
template <class T>
std::vector<RayFate> fates_at(const Lens& lens, const std::vector<std::array<T, 2>>& places,
                              const BatchOptions& options) {
  std::vector<Ray<T>> rays;
  for (const auto& [x, y] : places) {
    rays.push_back(options.travel == Travel::to_film ? Ray<T>{{x, y, -1}, {0, 0, 1}} : Ray<T>{{x, y, 9}, {0, 0, -1}});
  }
  return traced(lens, rays, options).fates;
}

TYPED_TEST(BatchIris, EdgesAreInside) {
  using T = TypeParam;
  const Iris square{.blades = 4, .rotation_rad = std::numbers::pi / 4};
  const Lens lens = petzval::with_iris(petzval::compile(window()), square);
  const T edge = static_cast<T>(10 * std::cos(std::numbers::pi / 4)), above = std::nextafter(edge, T(10));
  constexpr auto in = RayFate::transmitted, out = RayFate::vignetted;
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    for (const BatchOptions& options : every_batch(travel)) {
      const auto fates = fates_at<T>(lens, {{0, 0}, {edge, 0}, {above, 0}, {5, 6}, {5, T(7.1)}}, options);
      EXPECT_EQ(fates, (std::vector<RayFate>{in, in, out, in, out})) << text(options);
    }
  }
}

TYPED_TEST(BatchIris, IsIgnoredWithoutApertures) {
  using T = TypeParam;
  const Lens lens = petzval::with_iris(petzval::compile(window()), {.blades = 3});  // down to -5 mm
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    for (BatchOptions options : every_batch(travel)) {
      EXPECT_EQ(fates_at<T>(lens, {{0, -7}}, options), std::vector{RayFate::vignetted});
      options.apertures = false;
      EXPECT_EQ(fates_at<T>(lens, {{0, -7}, {11, 0}}, options),
                (std::vector<RayFate>{RayFate::transmitted, RayFate::transmitted}));
    }
  }
}

TYPED_TEST(BatchIris, RimsAreIgnoredWithoutApertures) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    petzval::Prescription wide = sample.prescription;
    if (std::any_of(wide.surfaces.begin(), wide.surfaces.end(), [](const auto& s) { return !s.aspheric.empty(); })) {
      continue;  // their tables depend on the aperture
    }
    for (auto& s : wide.surfaces) {
      s.semi_diameter = std::numeric_limits<double>::infinity();
      s.obscuration_semi_diameter.reset();
    }
    const Lens open = petzval::compile(wide);
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const auto rays = rays_for<T>(sample, travel, 200);
      for (BatchOptions options : every_batch(travel)) {
        const auto wanted = traced(open, rays, options);
        options.apertures = false;
        const auto found = traced(sample.lens, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          if (wanted.fates[i] == RayFate::vignetted) continue;  // by an edge of an element
          ASSERT_EQ(found.fates[i], wanted.fates[i]) << sample.id << " " << text(options) << " ray " << i;
          ASSERT_EQ(found.surfaces[i], wanted.surfaces[i]) << sample.id << " " << text(options) << " ray " << i;
          ASSERT_NE(found.fates[i], RayFate::vignetted) << sample.id << " " << text(options) << " ray " << i;
        }
      }
    }
  }
}

}  // namespace batch_iris_test
