// SPDX-License-Identifier: Apache-2.0
// The camera conformance kit, run with this renderer and all models of three lenses: README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "renderer/frame.hpp"
#include "renderer/luminance.hpp"
#include "renderer/render.hpp"
#include "renderer/scene_json.hpp"
#include "support/files.hpp"

namespace renderer {
namespace {

using examples::Json;
using petzval::Camera;
using petzval::Lens;
using petzval::ModelKind;
using petzval::Normalisation;
using petzval::Vec3;

const std::filesystem::path kit = PETZVAL_TEST_CONFORMANCE;

/// Description of a lens in the kit.
struct Setting {
  std::string lens;
  double width_mm, height_mm;
};
std::ostream& operator<<(std::ostream& out, const Setting& setting) { return out << setting.lens; }
const std::array settings{Setting{"double_gauss_100mm_f2_28deg", 36, 24}, Setting{"fisheye_16mm_f2.8", 30, 20},
                          Setting{"anamorphic_60mm_2x", 22, 18.6}};
constexpr double focus_mm = 1000;  // from the film

bool is_first_order(ModelKind model) {
  return model == ModelKind::pinhole || model == ModelKind::thin || model == ModelKind::thick;
}

Json table() {
  static const Json json = Json::parse(examples::read_text(kit / "expected.json"));
  return json;
}

class Conformance : public testing::TestWithParam<Setting> {
 protected:
  Conformance() : lens_(focused(0)) {}

  Lens focused(double f_number) const {
    const Lens lens = petzval::testing::data_lens(GetParam().lens);
    return petzval::with_focus(f_number > 0 ? petzval::with_f_number(lens, f_number) : lens, focus_mm,
                               {.origin = petzval::DistanceOrigin::film});
  }
  petzval::Film film(int columns) const {
    const auto& [lens, width, height] = GetParam();
    return {.width_mm = width,
            .height_mm = height,
            .columns = columns,
            .rows = static_cast<int>(std::lround(columns * height / width))};
  }
  /// nullopt if the lens does not have the model.
  std::optional<LensCamera> camera(const Lens& lens, ModelKind model, const petzval::Film& f, const Pose& pose = {},
                                   Normalisation normalisation = Normalisation::unity_on_axis) const {
    try {
      return LensCamera(Camera(lens, f, {.model = model, .normalisation = normalisation}), pose);
    } catch (const petzval::Error&) {
      EXPECT_FALSE(lens.rotationally_symmetric()) << petzval::name(model);
      return {};
    }
  }
  Json expected() const { return table().at("lenses").at(GetParam().lens); }

  Lens lens_;
};

/// An image, rendered on one thread.
PictureSums picture(const Scene& scene, const LensCamera& lens, Integrator integrator, std::uint32_t samples,
                    std::uint64_t seed = 1) {
  static const PathColourSource colours(ColourMode::d);
  PictureSums sums(lens.film().columns, lens.film().rows);
  std::vector<std::size_t> tiles(sums.tiles());
  for (std::size_t t = 0; t < tiles.size(); ++t) tiles[t] = t;
  const UnitTracer tracer(scene, lens, colours, integrator, seed);
  render(tracer, sums, tiles, {.samples = samples, .seconds = {}}, 1, [] {});
  return sums;
}

double luminance_at(const petzval::RgbImage& image, int x, int y) {
  const float* const p = image.pixel(x, y);
  return static_cast<double>(luminance({p[0], p[1], p[2]}));
}

SceneDescription light_at(const glm::vec3& place, float radius, float radiance = 1) {
  SceneDescription scene;
  scene.objects.push_back({"light", Sphere{place, radius}, Diffuse{}, Rgb(radiance)});
  return scene;
}

/// World positions of lights at a distance (mm) from the front of the lens. Their chief rays meet the film at these
/// fractions of the diagonal from centre to corner.
constexpr std::array<double, 8> shares{0.02, 0.15, 0.28, 0.42, 0.56, 0.7, 0.8, 0.9};
std::vector<glm::vec3> light_places(const LensCamera& lens, double distance_mm) {
  std::vector<glm::vec3> places;
  LensCamera::Batch batch;
  batch.resize(shares.size(), false);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    batch.raster_x[i] = static_cast<float>((1 + shares[i]) / 2 * lens.film().columns);
    batch.raster_y[i] = static_cast<float>((1 - shares[i]) / 2 * lens.film().rows);
    batch.u[i] = 0.25f, batch.v[i] = 0;  // the centre of the pupil
  }
  lens.sample(batch);
  for (const WorldRay& ray : batch.rays) {
    places.push_back(glm::round(ray.origin + static_cast<float>(distance_mm) * ray.direction));
  }
  return places;
}

/// The entry of a lens in expected.json; CONFORMANCE_OUT=FILE writes a new file.
Json measured(const Setting& setting, const Lens& lens, const std::vector<Lens>& stopped, const LensCamera& exact) {
  Json sky = Json::array(), exposure = Json::array(), lights = Json::array(), blurs = Json::array();
  const double axis = petzval::film_irradiance(lens, {0, 0});
  for (const double share : {0.0, 0.25, 0.5, 0.75, 0.95}) {
    const petzval::FilmPoint point{share * setting.width_mm / 2, share * setting.height_mm / 2};
    sky.push_back({{"film_mm", {point.x, point.y}}, {"over_axis", petzval::film_irradiance(lens, point) / axis}});
  }
  for (const Lens& l : stopped) {
    exposure.push_back({{"f_number", petzval::real_f_number(l)}, {"irradiance", petzval::film_irradiance(l, {0, 0})}});
  }
  for (const glm::vec3& place : light_places(exact, 900)) {
    const auto seen = exact.project(place);
    if (!seen) continue;
    lights.push_back({{"world_mm", {place.x, place.y, place.z}},
                      {"raster", {seen.raster.x / exact.film().columns, seen.raster.y / exact.film().rows}}});
  }
  for (const double mm : {600.0, 800.0, 1500.0, 4000.0}) {
    const petzval::FieldPoint light{.field_rad = 0, .z = -mm};
    blurs.push_back(
        {{"from_front_vertex_mm", mm},
         {"rms_radius_mm", petzval::point_image(lens, light, {.samples = 1u << 14, .pixels = 1}).size.rms_radius}});
  }
  return {{"film_mm", {setting.width_mm, setting.height_mm}},
          {"focus_from_film_mm", focus_mm},
          {"sky", sky},
          {"exposure", exposure},
          {"lights", lights},
          {"blur", blurs}};
}

bool alike(const Json& a, const Json& b) {
  if (a.is_number())
    return b.is_number() && std::abs(a.get<double>() - b.get<double>()) < 2e-3 * std::abs(b.get<double>()) + 1e-4;
  if (a.is_structured()) {
    if (a.size() != b.size()) return false;
    for (auto i = a.begin(), k = b.begin(); i != a.end(); ++i, ++k) {
      if (!alike(*i, *k)) return false;
    }
    return true;
  }
  return a == b;
}

TEST_P(Conformance, TheTableEqualsTheLibrary) {
  std::vector<Lens> stopped;
  for (const double f_number : {4.0, 5.6, 8.0, 16.0}) stopped.push_back(focused(f_number));
  const auto exact = camera(lens_, ModelKind::exact_double, film(900));
  const Json found = measured(GetParam(), lens_, stopped, *exact);
  if (const char* const out = std::getenv("CONFORMANCE_OUT")) {
    Json all = std::filesystem::exists(out) ? Json::parse(examples::read_text(out)) : Json{{"lenses", Json::object()}};
    all["lenses"][GetParam().lens] = found;
    examples::write_text(out, all.dump(1) + '\n');
    return;
  }
  EXPECT_TRUE(alike(found, expected())) << found.dump(1);
}

TEST_P(Conformance, UniformSkyEqualsQuadrature) {
  const Scene scene(read_scene(kit / "scenes/sky.json"));
  for (const ModelKind model : petzval::models()) {
    const auto lens = camera(lens_, model, film(60));
    if (!lens) continue;
    const petzval::RgbImage image = picture(scene, *lens, Integrator::path, 64).picture();
    const Json sky = expected()["sky"];
    for (const Json& point : sky) {
      const petzval::FilmPoint at{point["film_mm"][0], point["film_mm"][1]};
      const double over_axis = point["over_axis"];
      // First-order models have their own pupils; only their irradiance on the axis equals the exact lens.
      if (is_first_order(model) && at.x > 0) continue;
      const petzval::Vec2<double> raster = lens->film().raster(at);
      const int x = std::clamp(static_cast<int>(raster.x), 0, image.width - 1);
      const int y = std::clamp(static_cast<int>(raster.y), 0, image.height - 1);
      const bool fitted = model != ModelKind::exact_float && model != ModelKind::exact_double;
      EXPECT_NEAR(luminance_at(image, x, y), over_axis, (fitted ? 0.03 : 0.015) + 0.02 * over_axis)
          << petzval::name(model) << " at " << at.x;
    }
  }
}

TEST_P(Conformance, FilmAndSceneSideAgreeForAnEmitter) {
  const petzval::Film f = film(48);
  const auto exact = camera(lens_, ModelKind::exact_double, f);
  const auto places = light_places(*exact, 900);
  int seen = 0;
  for (const ModelKind model : petzval::models()) {
    const auto lens = camera(lens_, model, f);
    if (!lens) continue;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (model != ModelKind::exact_float && i % 3 != 1) continue;
      const Scene scene(light_at(places[i], 12));
      const Estimate by_film = picture(scene, *lens, Integrator::path, 96).mean()[1];
      const Estimate by_scene = picture(scene, *lens, Integrator::light, 32).mean()[1];
      if (by_film.mean == 0 && by_scene.mean == 0) continue;  // outside the field of this model
      EXPECT_NEAR(by_film.mean, by_scene.mean,
                  0.002 * by_scene.mean + 4 * std::hypot(by_film.standard_error, by_scene.standard_error))
          << petzval::name(model) << " light " << i;
      seen += by_scene.mean > 0;
    }
  }
  EXPECT_GT(seen, 15);
}

TEST_P(Conformance, TinyLightLiesOnItsChiefRay) {
  const petzval::Film f = film(120);
  for (const ModelKind model : {ModelKind::exact_float, ModelKind::polynomial(7)}) {
    const auto lens = camera(lens_, model, f);
    ASSERT_TRUE(lens);
    const Json lights = expected()["lights"];
    for (const Json& light : lights) {
      const glm::vec3 place{light["world_mm"][0], light["world_mm"][1], light["world_mm"][2]};
      const petzval::RgbImage image =
          picture(Scene(light_at(place, 0.5f, 1000)), *lens, Integrator::light, 4).picture();
      double sum = 0, x_sum = 0, y_sum = 0;
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
          const double value = luminance_at(image, x, y);
          sum += value, x_sum += value * (x + 0.5), y_sum += value * (y + 0.5);
        }
      }
      ASSERT_GT(sum, 0);
      // The tolerance is a pixel, because the centroid of a comatic blur is not on the chief ray.
      EXPECT_NEAR(x_sum / sum, light["raster"][0].get<double>() * image.width, 1.2) << place.x;
      EXPECT_NEAR(y_sum / sum, light["raster"][1].get<double>() * image.height, 1.2) << place.x;
    }
  }
}

/// Differences of two estimates in standard errors. Over many settings a small bias adds up.
class Differences {
 public:
  void add(const Estimate& a, const Estimate& b) {
    const double error = std::hypot(a.standard_error, b.standard_error);
    if (error > 0) sum_ += (a.mean - b.mean) / error, ++count_;
  }
  /// About 1 without a bias.
  double together() const { return std::abs(sum_) / std::sqrt(static_cast<double>(count_)); }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// Number of tiles whose means differ by more than 3 standard errors. With 16 rounds, differences follow Student's t
/// with about 25 degrees of freedom: 0.6 % of the tiles exceed 3.
int tiles_beyond(const PictureSums& a, const PictureSums& b) {
  int beyond = 0;
  for (std::size_t t = 0; t < a.tiles(); ++t) {
    const Estimate x = a.luminance(t), y = b.luminance(t);
    beyond += std::abs(x.mean - y.mean) > 3 * std::hypot(x.standard_error, y.standard_error) + 1e-3 * x.mean;
  }
  return beyond;
}

TEST_P(Conformance, ThreeIntegratorsAgreeInARoom) {
  const SceneDescription room = read_scene(kit / "scenes/room.json");
  const Scene scene(room);
  Differences by_light, by_both;
  for (const ModelKind model : petzval::models()) {
    const bool main = model == ModelKind::exact_float;
    const auto lens = camera(lens_, model, film(main ? 96 : 48), room.pose);
    if (!lens) continue;
    const std::uint32_t samples = main ? 128 : 64;
    const std::uint64_t seed =
        10 * static_cast<std::uint64_t>(model.family()) + static_cast<std::uint64_t>(model.degree());
    const PictureSums path = picture(scene, *lens, Integrator::path, samples, seed);
    const PictureSums light = picture(scene, *lens, Integrator::light, samples, seed + 1);
    const PictureSums both = picture(scene, *lens, Integrator::bidirectional, samples / 2, seed + 2);
    const Estimate a = path.mean()[1], b = light.mean()[1], c = both.mean()[1];
    EXPECT_NEAR(a.mean, b.mean, 0.001 * a.mean + 3.5 * std::hypot(a.standard_error, b.standard_error))
        << petzval::name(model);
    EXPECT_NEAR(b.mean, c.mean, 0.001 * a.mean + 3.5 * std::hypot(b.standard_error, c.standard_error))
        << petzval::name(model);
    by_light.add(a, b), by_both.add(a, c);
    const auto allowed = static_cast<int>(2 + 0.02 * static_cast<double>(path.tiles()));
    EXPECT_LE(tiles_beyond(path, light), allowed) << petzval::name(model);
    EXPECT_LE(tiles_beyond(light, both), allowed) << petzval::name(model);
  }
  EXPECT_LT(by_light.together(), 4) << by_light.together();
  EXPECT_LT(by_both.together(), 4);
}

TEST_P(Conformance, ExposureFollowsTheStop) {
  const Scene scene(read_scene(kit / "scenes/sky.json"));
  petzval::Film small{.width_mm = 0.5, .height_mm = 0.5, .columns = 4, .rows = 4};
  const Json exposure = expected()["exposure"];
  for (const Json& stop : exposure) {
    const Lens lens = focused(stop["f_number"]);
    for (const ModelKind model : petzval::models()) {
      const auto c = camera(lens, model, small, {}, Normalisation::irradiance);
      if (!c) continue;
      const double irradiance = picture(scene, *c, Integrator::path, 64).mean()[1].mean;
      EXPECT_NEAR(irradiance / stop["irradiance"].get<double>(), 1, 0.02) << petzval::name(model) << stop.dump();
    }
  }
}

TEST_P(Conformance, BlursEqualExactRays) {
  double widest = 0;
  const Json blurs = expected()["blur"];
  for (const Json& blur : blurs) widest = std::max(widest, blur["rms_radius_mm"].get<double>());
  const petzval::Film f{.width_mm = 10 * widest, .height_mm = 10 * widest, .columns = 240, .rows = 240};
  const double entrance_z = petzval::pupils(lens_).entrance.z;
  for (const ModelKind model : {ModelKind::exact_float, ModelKind::polynomial(7), ModelKind::thin}) {
    const auto lens = camera(lens_, model, f);
    ASSERT_TRUE(lens);
    for (const Json& blur : blurs) {
      const double mm = blur["from_front_vertex_mm"];
      const glm::vec3 place{0, 0, -mm - entrance_z};
      const petzval::RgbImage image =
          picture(Scene(light_at(place, 0.05f, 1e5f)), *lens, Integrator::light, 4).picture();
      double sum = 0, squares = 0;
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
          const double value = luminance_at(image, x, y), dx = x + 0.5 - 120, dy = y + 0.5 - 120;
          sum += value, squares += value * (dx * dx + dy * dy);
        }
      }
      ASSERT_GT(sum, 0);
      const double rms = std::sqrt(squares / sum - 1.0 / 6) * f.pixel_mm();  // minus the variance of a pixel
      // A thin lens lacks spherical aberration, which matters near the focus.
      const double wanted = blur["rms_radius_mm"], share = model == ModelKind::thin ? 0.1 : 0.03;
      EXPECT_NEAR(rms, wanted, share * wanted + (model == ModelKind::thin ? 0.2 : 0.01) * widest)
          << petzval::name(model) << ' ' << mm;
    }
  }
}

TEST_P(Conformance, ImagesAreUpright) {
  const SceneDescription colours = read_scene(kit / "scenes/colours.json");
  const Scene scene(colours);
  for (const ModelKind model : petzval::models()) {
    const auto lens = camera(lens_, model, film(60), colours.pose);
    if (!lens) continue;
    for (const Integrator integrator : {Integrator::path, Integrator::light}) {
      const petzval::RgbImage image = picture(scene, *lens, integrator, 32).picture();
      std::array<double, 3> sum{}, x_mean{}, y_mean{};
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
          for (std::size_t c = 0; c < 3; ++c) {
            const auto value = static_cast<double>(image.pixel(x, y)[c]);
            sum[c] += value, x_mean[c] += value * x / image.width, y_mean[c] += value * y / image.height;
          }
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_GT(sum[c], 0) << petzval::name(model);
        x_mean[c] /= sum[c], y_mean[c] /= sum[c];
      }
      EXPECT_GT(x_mean[0], 0.54) << petzval::name(model);
      EXPECT_LT(x_mean[2], 0.46) << petzval::name(model);
      EXPECT_LT(y_mean[1], 0.46) << petzval::name(model);
      EXPECT_NEAR(y_mean[0], 0.5, 0.05) << petzval::name(model);
    }
  }
}

TEST_P(Conformance, DensitiesOfConnectionsIntegrateToOne) {
  for (const ModelKind model : {ModelKind::thin, ModelKind::polynomial(5), ModelKind::exact_float}) {
    const auto lens = camera(lens_, model, film(60));
    ASSERT_TRUE(lens);
    for (const glm::vec3 place : {glm::vec3{0, 0, -1000}, glm::vec3{100, 60, -1100}}) {
      // Directions within a cone about the entrance pupil, which is at the origin.
      const glm::vec3 towards = glm::normalize(-place);
      const double reach = petzval::pupils(lens_).entrance.diameter / static_cast<double>(glm::length(place));
      const double cosine = 1 / std::sqrt(1 + reach * reach);
      const Frame frame(towards);
      constexpr std::uint32_t count = 1u << 16;
      double sum = 0, samples = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto s = petzval::owen_sobol(i, 5);
        const double z = 1 - s.x * (1 - cosine), r = std::sqrt(1 - z * z), turn = 2 * std::numbers::pi * s.y;
        const glm::vec3 direction = frame.to_world(glm::vec3(r * std::cos(turn), r * std::sin(turn), z));
        sum += lens->pdf_connection(place, glm::normalize(direction), {}) * 2 * std::numbers::pi * (1 - cosine) / count;
        samples += lens->connect(place, static_cast<float>(s.x), static_cast<float>(s.y), {}).pdf > 0;
      }
      EXPECT_NEAR(sum, samples / count, 0.01) << petzval::name(model) << place.x;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, Conformance, testing::ValuesIn(settings), [](const auto& tested) {
  std::string name = tested.param.lens;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

/// A diffuse floor under a lamp with direct light only, through every lens of data/.
TEST(OneBounce, ThreeIntegratorsAgreeForEveryLens) {
  int compared = 0;
  Differences by_light, by_both;
  for (const petzval::Prescription& prescription : petzval::testing::data_prescriptions()) {
    const Lens lens = petzval::compile(prescription);
    const double length = std::abs(petzval::first_order(lens).effective_focal_length);
    if (!std::isfinite(length)) continue;
    const double distance = 15 * length, side = 0.3 * length;
    std::optional<Lens> focused;
    try {
      focused = petzval::with_focus(lens, distance);
    } catch (const petzval::Error&) {
      continue;
    }
    const auto size = static_cast<float>(distance);
    SceneDescription d;
    d.pose.look_at = {0, 0, -distance};
    d.objects.push_back({"wall", Quad{{-size, -size, -1.1f * size}, {2 * size, 0, 0}, {0, 2 * size, 0}}, Diffuse{}});
    d.objects.push_back({"lamp", Sphere{{0.1f * size, 0.25f * size, -0.85f * size}, 0.05f * size},
                         Diffuse{{.colour = Rgb(0)}}, Rgb(30)});
    const Scene scene(d);
    const petzval::Film film{.width_mm = side, .height_mm = side / 1.5, .columns = 24, .rows = 16};
    const LensCamera camera(
        Camera(*focused, film, {.model = ModelKind::exact_float, .normalisation = Normalisation::unity_on_axis}),
        d.pose);
    const std::uint64_t seed = 10 * static_cast<std::uint64_t>(compared);
    const Estimate a = picture(scene, camera, Integrator::path, 64, seed).mean()[1];
    const Estimate b = picture(scene, camera, Integrator::light, 128, seed + 1).mean()[1];
    const Estimate c = picture(scene, camera, Integrator::bidirectional, 64, seed + 2).mean()[1];
    EXPECT_GT(a.mean, 0) << lens.name();
    EXPECT_NEAR(a.mean, b.mean, 0.002 * a.mean + 4 * std::hypot(a.standard_error, b.standard_error)) << lens.name();
    EXPECT_NEAR(a.mean, c.mean, 0.002 * a.mean + 4 * std::hypot(a.standard_error, c.standard_error)) << lens.name();
    by_light.add(a, b), by_both.add(a, c);
    ++compared;
  }
  EXPECT_GT(compared, 65);
  EXPECT_LT(by_light.together(), 4) << by_light.together();
  EXPECT_LT(by_both.together(), 4);
}

}  // namespace
}  // namespace renderer
