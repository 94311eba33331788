// SPDX-License-Identifier: Apache-2.0
// The adapters of examples/hosts with stand-ins for the types of pbrt and Mitsuba: three coloured lamps, placed in the
// camera space of the host, appear at the expected pixels.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <petzval/petzval.hpp>

#include "core/low_discrepancy.hpp"

namespace pbrt {

using Float = float;
struct Point2f {
  Float x = 0, y = 0;
};
struct Vector3f {
  Vector3f() = default;
  Vector3f(Float x_, Float y_, Float z_) : x(x_), y(y_), z(z_) {}
  Float x = 0, y = 0, z = 0;
};
struct Point3f : Vector3f {
  using Vector3f::Vector3f;
};
struct Ray {
  Ray() = default;
  Ray(Point3f o_, Vector3f d_, Float time_) : o(o_), d(d_), time(time_) {}
  Point3f o;
  Vector3f d;
  Float time = 0;
};
struct RayDifferential : Ray {
  explicit RayDifferential(const Ray& ray) : Ray(ray) {}
  bool hasDifferentials = false;
  Point3f rxOrigin, ryOrigin;
  Vector3f rxDirection, ryDirection;
};
struct SampledSpectrum {
  explicit SampledSpectrum(Float c) : value(c) {}
  Float value;
};
struct CameraSample {
  Point2f pFilm, pLens;
  Float time = 0;
};
struct CameraRay {
  Ray ray;
  SampledSpectrum weight{1};
};
struct CameraRayDifferential {
  RayDifferential ray;
  SampledSpectrum weight{1};
};
struct CameraTransform {
  template <class R>
  R RenderFromCamera(const R& ray) const {
    return ray;
  }
};

}  // namespace pbrt

#include "hosts/mitsuba_sensor.hpp"
#include "hosts/pbrt_camera.hpp"

namespace petzval {
namespace {

/// Mitsuba's types have coordinates as functions.
struct Mitsuba {
  using Float = float;
  struct Point2f {
    float first, second;
    float x() const { return first; }
    float y() const { return second; }
  };
  struct Vector3f {
    Vector3f(float x, float y, float z) : at{x, y, z} {}
    std::array<float, 3> at;
  };
  struct Point3f : Vector3f {
    using Vector3f::Vector3f;
  };
  struct Ray3f {
    Ray3f(const Point3f& origin, const Vector3f& direction, float when) : o(origin), d(direction), time(when) {}
    Point3f o;
    Vector3f d;
    float time;
  };
  struct Transform4f {
    template <class P>
    P operator*(const P& p) const {
      return p;
    }
  };
};

constexpr int columns = 36, rows = 24, samples = 64;

Camera camera_at_3m() {
  const Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json"));
  return Camera(with_focus(lens, 3000, {.origin = DistanceOrigin::film}),
                {.width_mm = 36, .height_mm = 24, .columns = columns, .rows = rows});
}

/// Image position of a lamp: the mean raster position of its light. ray_at(x, y, u, v): a ray in host space and its
/// weight.
template <class RayAt>
Vec2<double> place_of(const Vec3<double>& lamp, double radius, const RayAt& ray_at) {
  const core_detail::Kronecker<4> points;
  Vec2<double> sum{0, 0};
  double light = 0;
  for (int i = 0; i < columns * rows * samples; ++i) {
    const auto [x, y, u, v] = points(static_cast<std::size_t>(i));
    const auto [origin, direction, weight] = ray_at(columns * x, rows * y, u, v);
    const Vec3<double> to = lamp - origin;
    const bool hit = glm::length(glm::cross(to, direction)) < radius && glm::dot(to, direction) > 0;
    if (!hit) continue;
    sum += weight * Vec2<double>(columns * x, rows * y);
    light += weight;
  }
  return sum / light;
}

struct HostRay {
  Vec3<double> origin, direction;
  double weight;
};

/// Lamps 0.3 m to the right of the axis, 0.2 m above it, and on the axis, all 3 m in front of the film. right:
/// direction in host space.
template <class RayAt>
void expect_lamps_in_place(double right, const RayAt& ray_at) {
  const double image_mm_per_m = 1000 * 103.4 / 2862;  // f + extension over the object's distance, thick lens
  const Vec2<double> middle{columns / 2., rows / 2.};
  const Vec2<double> red = place_of({0.3 * right, 0, 3}, 0.03, ray_at), green = place_of({0, 0.2, 3}, 0.03, ray_at),
                     blue = place_of({0, 0, 3}, 0.03, ray_at);
  EXPECT_NEAR(red.x - middle.x, 0.3 * image_mm_per_m, 0.2);
  EXPECT_NEAR(red.y - middle.y, 0, 0.1);
  EXPECT_NEAR(green.x - middle.x, 0, 0.1);
  EXPECT_NEAR(green.y - middle.y, -0.2 * image_mm_per_m, 0.2);
  EXPECT_NEAR(blue.x - middle.x, 0, 0.1);
  EXPECT_NEAR(blue.y - middle.y, 0, 0.1);
}

TEST(HostAdapters, OfPbrtHaveRedOnTheRightAndGreenAbove) {
  const hosts::PbrtCamera camera(camera_at_3m(), {}, 0, 0.5f);
  const auto sample = [](double x, double y, double u, double v) {
    const auto number = [](double value) { return static_cast<float>(value); };
    return pbrt::CameraSample{{number(x), number(y)}, {number(u), number(v)}, 0.5f};
  };
  const auto vector = [](const pbrt::Vector3f& v) { return Vec3<double>(v.x, v.y, v.z); };
  expect_lamps_in_place(1, [&](double x, double y, double u, double v) {
    const auto ray = camera.GenerateRay(sample(x, y, u, v));
    return ray ? HostRay{vector(ray->ray.o), vector(ray->ray.d), ray->weight.value} : HostRay{{}, {0, 0, 1}, 0};
  });
  const auto ray = camera.GenerateRay(sample(18, 12, 0.4, 0.3));
  ASSERT_TRUE(ray);
  EXPECT_EQ(ray->ray.time, 0.25f);

  // Differential rays equal the rays of the samples one pixel to the right and one pixel down.
  const auto differential = camera.GenerateRayDifferential(sample(20, 10, 0.4, 0.3));
  const auto right = camera.GenerateRay(sample(21, 10, 0.4, 0.3)), below = camera.GenerateRay(sample(20, 11, 0.4, 0.3));
  ASSERT_TRUE(differential && differential->ray.hasDifferentials && right && below);
  EXPECT_NEAR(differential->ray.rxDirection.x, right->ray.d.x, 2e-4);
  EXPECT_NEAR(differential->ray.ryDirection.y, below->ray.d.y, 2e-4);
  EXPECT_GT(differential->ray.rxDirection.x, differential->ray.d.x);
  EXPECT_LT(differential->ray.ryDirection.y, differential->ray.d.y);
}

TEST(HostAdapters, OfMitsubaHaveRedOnTheRightAndGreenAbove) {
  const hosts::MitsubaSensor<Mitsuba> sensor(camera_at_3m(), {});
  const auto vector = [](const Mitsuba::Vector3f& v) { return Vec3<double>(v.at[0], v.at[1], v.at[2]); };
  expect_lamps_in_place(-1, [&](double x, double y, double u, double v) {
    const auto number = [](double value) { return static_cast<float>(value); };
    const auto [ray, weight] = sensor.sample_ray(0, 0, {number(x / columns), number(y / rows)}, {number(u), number(v)});
    return HostRay{vector(ray.o), vector(ray.d), weight};
  });
}

}  // namespace
}  // namespace petzval
