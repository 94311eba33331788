// SPDX-License-Identifier: Apache-2.0
// The plugins of examples/hosts, compiled as C++17 with stand-ins that have the declarations of pbrt and Mitsuba: lamps
// appear where they are, and light tracing has the light of path tracing.
#include <gtest/gtest.h>

#include <mitsuba/render/sensor.h>
#include <pbrt/cameras.h>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>

#include "hosts/mitsuba/petzval_sensor.cpp"

namespace {

using Vec = std::array<double, 3>;
constexpr int columns = 36, rows = 24;
const std::string lens_file = std::string(PETZVAL_TEST_DATA) + "/lenses/double_gauss_100mm_f2.0.json";

struct HostRay {
  Vec origin{}, direction{0, 0, 1};
  double weight = 0;
};
struct Connection {
  Vec direction{0, 0, 1};
  double we = 0, pdf = 0, x = 0, y = 0;
};
/// A camera of a host in its camera space, in metres: +z forward, +y up, +x to the right or left.
struct HostCamera {
  std::function<HostRay(double x, double y, double u, double v)> ray;
  std::function<Connection(const Vec& point, double u, double v)> connect;
  /// Importance of a ray that leaves the camera, and the product of its densities; 0 if the host has no densities.
  std::function<std::array<double, 2>(const Vec& origin, const Vec& direction)> importance;
  double right = 1;
};

float number(double value) { return static_cast<float>(value); }

HostCamera pbrt_camera(float dispersion = 0) {
  pbrt::ParameterDictionary parameters;
  parameters.strings["lensfile"] = lens_file;
  parameters.numbers = {{"fnumber", 2.8f}, {"focusdistance", 3.f}, {"dispersion", dispersion}};
  const pbrt::FileLoc loc;
  const std::shared_ptr<pbrt::PetzvalCamera> camera(pbrt::PetzvalCamera::Create(parameters, {}, {}, {}, &loc));
  const auto vec = [](const auto& v) { return Vec{v.x, v.y, v.z}; };
  HostCamera host;
  host.ray = [=](double x, double y, double u, double v) {
    pbrt::SampledWavelengths lambda;
    const auto ray = camera->GenerateRay({{number(x), number(y)}, {number(u), number(v)}, 0.5f, 1}, lambda);
    EXPECT_EQ(lambda.terminated, dispersion != 0);
    return ray ? HostRay{vec(ray->ray.o), vec(ray->ray.d), ray->weight[0]} : HostRay{};
  };
  host.connect = [=](const Vec& p, double u, double v) {
    pbrt::SampledWavelengths lambda;
    const pbrt::Interaction at({number(p[0]), number(p[1]), number(p[2])}, pbrt::Normal3f({0, 0, -1}), 0.25f, {});
    const auto found = camera->SampleWi(at, {number(u), number(v)}, lambda);
    if (!found) return Connection{};
    return Connection{vec(found->wi), found->Wi[0], found->pdf, found->pRaster.x, found->pRaster.y};
  };
  host.importance = [=](const Vec& o, const Vec& d) {
    const pbrt::Ray ray({number(o[0]), number(o[1]), number(o[2])}, {number(d[0]), number(d[1]), number(d[2])}, 0.25f);
    pbrt::SampledWavelengths lambda;
    float position, direction;
    camera->PDF_We(ray, &position, &direction);
    return std::array<double, 2>{camera->We(ray, lambda)[0], double{position} * direction};
  };
  return host;
}

HostCamera mitsuba_sensor() {
  mitsuba::Properties properties;
  properties.strings["lens"] = lens_file;
  properties.numbers = {{"f_number", 2.8f}, {"focus_distance", 3.f}};
  const auto sensor = std::make_shared<mitsuba::PetzvalSensor<float, mitsuba::Color>>(properties);
  const auto vec = [](const mitsuba::Vector3& v) { return Vec{v.x(), v.y(), v.z()}; };
  HostCamera host;
  host.right = -1;
  host.ray = [=](double x, double y, double u, double v) {
    const auto [ray, weight] =
        sensor->sample_ray(0, 0, {number(x / columns), number(y / rows)}, {number(u), number(v)}, true);
    return HostRay{vec(ray.o), vec(ray.d), weight.value};
  };
  host.connect = [=](const Vec& p, double u, double v) {
    mitsuba::Interaction at;
    at.p = mitsuba::Point3(number(p[0]), number(p[1]), number(p[2]));
    const auto [found, weight] = sensor->sample_direction(at, {number(u), number(v)}, true);
    return Connection{vec(found.d), double{weight.value} * found.pdf, found.pdf, found.uv.x(), found.uv.y()};
  };
  host.importance = [=](const Vec& o, const Vec& d) {
    mitsuba::SurfaceInteraction at;
    at.p = mitsuba::Point3(number(o[0]), number(o[1]), number(o[2]));
    at.wi = mitsuba::Vector3(number(d[0]), number(d[1]), number(d[2]));
    return std::array<double, 2>{sensor->eval(at, true).value, 0};
  };
  return host;
}

struct Sums {
  double light = 0, x = 0, y = 0;
};

/// The light of a disc of radiance 1, facing the camera, by camera rays and by connections from points on the disc:
/// mean irradiance of the picture and the centre of the disc's image.
std::array<Sums, 2> picture_of(const HostCamera& host, const Vec& centre, double radius) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Sums paths, light;
  constexpr int samples = 400000;
  const auto in_view = [](double x, double y) { return x >= 0 && y >= 0 && x < columns && y < rows; };
  for (int i = 0; i < samples; ++i) {
    const double x = columns * uniform(random), y = rows * uniform(random);
    const HostRay ray = host.ray(x, y, uniform(random), uniform(random));
    const double t = (centre[2] - ray.origin[2]) / ray.direction[2];
    const double dx = ray.origin[0] + t * ray.direction[0] - centre[0];
    const double dy = ray.origin[1] + t * ray.direction[1] - centre[1];
    if (!(t > 0 && dx * dx + dy * dy < radius * radius)) continue;
    paths.light += ray.weight, paths.x += ray.weight * x, paths.y += ray.weight * y;
  }
  for (int i = 0; i < samples / 4; ++i) {
    const double r = radius * std::sqrt(uniform(random)), angle = 6.283185307179586 * uniform(random);
    const Vec point{centre[0] + r * std::cos(angle), centre[1] + r * std::sin(angle), centre[2]};
    const Connection found = host.connect(point, uniform(random), uniform(random));
    if (found.pdf == 0 || !in_view(found.x, found.y)) continue;
    const double one = -found.direction[2] * found.we / found.pdf * 3.141592653589793 * radius * radius * 4;
    light.light += one, light.x += one * found.x, light.y += one * found.y;
  }
  for (Sums* sums : {&paths, &light}) {
    sums->x /= sums->light, sums->y /= sums->light, sums->light /= samples;
  }
  return {paths, light};
}

void expect_lamps_in_place(const HostCamera& host) {
  const double image_mm_per_m = 1000 * 103.4 / 2862;  // f + extension over the object's distance, thick lens
  const double at = host.right * 0.3;
  for (const Vec& lamp : {Vec{at, 0, 3}, Vec{0, 0.2, 3}, Vec{0, 0, 3}, Vec{0.1 * host.right, 0.05, 6}}) {
    const auto [paths, light] = picture_of(host, lamp, 0.06);
    EXPECT_NEAR(light.light / paths.light, 1, 0.03);
    EXPECT_NEAR(light.x, paths.x, 0.05);
    EXPECT_NEAR(light.y, paths.y, 0.05);
    if (lamp[2] > 3) continue;
    EXPECT_NEAR(paths.x - columns / 2., host.right * lamp[0] * image_mm_per_m, 0.2);
    EXPECT_NEAR(paths.y - rows / 2., -lamp[1] * image_mm_per_m, 0.2);
  }
  // The whole picture sees a large disc.
  const auto [paths, light] = picture_of(host, {0, 0, 5}, 2.5);
  EXPECT_NEAR(light.light / paths.light, 1, 0.02);
}

void expect_importance_of_samples(const HostCamera& host, bool densities) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 200; ++i) {
    const HostRay ray = host.ray(columns * uniform(random), rows * uniform(random), uniform(random), uniform(random));
    if (ray.weight == 0) continue;
    const auto [we, density] = host.importance(ray.origin, ray.direction);
    EXPECT_GT(we, 0);
    if (densities) EXPECT_NEAR(we / density / ray.weight, 1, 2e-3);
  }
}

TEST(Pbrt, LightTracingHasTheLightOfPathTracing) { expect_lamps_in_place(pbrt_camera()); }
TEST(Pbrt, DensitiesOfSamplesGiveTheirWeights) { expect_importance_of_samples(pbrt_camera(), true); }
TEST(Pbrt, DispersionEndsTheOtherWavelengths) { expect_importance_of_samples(pbrt_camera(1), false); }

TEST(Pbrt, DifferentialsAreTheRaysOfAdjacentPixels) {
  pbrt::ParameterDictionary parameters;
  parameters.strings["lensfile"] = lens_file;
  const pbrt::FileLoc loc;
  const std::shared_ptr<pbrt::PetzvalCamera> camera(pbrt::PetzvalCamera::Create(parameters, {}, {}, {}, &loc));
  pbrt::SampledWavelengths lambda;
  const auto found = camera->GenerateRayDifferential({{20, 10}, {0.4f, 0.3f}, 0.5f, 1}, lambda);
  const auto right = camera->GenerateRay({{21, 10}, {0.4f, 0.3f}, 0.5f, 1}, lambda);
  const auto below = camera->GenerateRay({{20, 11}, {0.4f, 0.3f}, 0.5f, 1}, lambda);
  ASSERT_TRUE(found && found->ray.hasDifferentials && right && below);
  EXPECT_EQ(found->ray.time, 0.25f);
  EXPECT_NEAR(found->ray.rxDirection.x, right->ray.d.x, 2e-4);
  EXPECT_NEAR(found->ray.ryDirection.y, below->ray.d.y, 2e-4);
  EXPECT_GT(found->ray.rxDirection.x, found->ray.d.x);
  EXPECT_LT(found->ray.ryDirection.y, found->ray.d.y);
}

TEST(Pbrt, LostSamplesAreRaysOfWeightZero) {
  pbrt::ParameterDictionary parameters;
  parameters.strings["lensfile"] = lens_file;
  const pbrt::FileLoc loc;
  pbrt::Film film;
  film.diagonal = 0.2f;  // beyond the image circle
  const std::shared_ptr<pbrt::PetzvalCamera> camera(pbrt::PetzvalCamera::Create(parameters, {}, film, {}, &loc));
  int lost = 0;
  for (int i = 0; i < 36; ++i) {
    pbrt::SampledWavelengths lambda;
    const pbrt::CameraSample at{{number(i + 0.5), number(i * 2 / 3.)}, {0.7f, 0.3f}, 0.5f, 1};
    const auto ray = pbrt::Camera(camera.get()).GenerateRay(at, lambda);
    const auto differential = camera->GenerateRayDifferential(at, lambda);
    ASSERT_TRUE(ray && differential);
    EXPECT_EQ(ray->weight[0], differential->weight[0]);
    EXPECT_NEAR(std::hypot(ray->ray.d.x, ray->ray.d.y, ray->ray.d.z), 1, 1e-4);
    EXPECT_NEAR(std::hypot(differential->ray.d.x, differential->ray.d.y, differential->ray.d.z), 1, 1e-4);
    lost += ray->weight[0] == 0;
  }
  EXPECT_GT(lost, 8);
  EXPECT_LT(lost, 36);
}

TEST(Pbrt, MissingLensIsAnErrorOfTheScene) {
  pbrt::ParameterDictionary parameters;
  parameters.strings["lensfile"] = "missing.json";
  const pbrt::FileLoc loc;
  EXPECT_THROW(pbrt::PetzvalCamera::Create(parameters, {}, {}, {}, &loc), std::runtime_error);
}

TEST(Mitsuba, CropWindowsArePartsOfThePicture) {
  using Sensor = mitsuba::PetzvalSensor<float, mitsuba::Color>;
  mitsuba::Properties properties;
  properties.strings["lens"] = lens_file;
  const Sensor whole(properties);
  properties.film.offset = {{9, 4}}, properties.film.crop = {{18, 12}};
  const Sensor crop(properties);
  for (const float u : {0.1f, 0.5f, 0.9f}) {
    // Positions of samples are from 0 to 1 over the window.
    const mitsuba::Point2 pupil(0.3f, u);
    const auto [one, weight] = whole.sample_ray(0, 0, {(9 + 18 * u) / columns, (4 + 12 * u * u) / rows}, pupil, true);
    const auto [two, same] = crop.sample_ray(0, 0, {u, u * u}, pupil, true);
    EXPECT_GT(weight.value, 0);
    EXPECT_NEAR(same.value, weight.value, 1e-5 * weight.value);
    EXPECT_NEAR(two.d.x(), one.d.x(), 1e-5);
    EXPECT_NEAR(two.d.y(), one.d.y(), 1e-5);
    // Splats count from the corner of the window, and importance is divided by its area.
    mitsuba::Interaction at;
    at.p = mitsuba::Point3(0.1f, 0.05f, 3);
    const auto [all, we] = whole.sample_direction(at, pupil, true);
    const auto [part, larger] = crop.sample_direction(at, pupil, true);
    EXPECT_NEAR(part.uv.x(), all.uv.x() - 9, 1e-4);
    EXPECT_NEAR(part.uv.y(), all.uv.y() - 4, 1e-4);
    EXPECT_NEAR(larger.value / we.value, 4, 1e-5);
    mitsuba::SurfaceInteraction arrival;
    arrival.p = one.o, arrival.wi = one.d;
    EXPECT_NEAR(crop.eval(arrival, true).value / whole.eval(arrival, true).value, 4, 1e-5);
  }
}

TEST(Mitsuba, LightTracingHasTheLightOfPathTracing) { expect_lamps_in_place(mitsuba_sensor()); }
TEST(Mitsuba, SampledRaysHaveImportance) { expect_importance_of_samples(mitsuba_sensor(), false); }

}  // namespace
