// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/lens_rays.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <stop_token>
#include <tuple>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"

namespace lens_rays_test {

using petzval::testing::expect_error;

using namespace petzval;

constexpr double in_focus = 1 / 2000.0;

Lens double_gauss() { return with_focus(petzval::testing::data_lens("double_gauss_52mm_f1.8"), 2000.0); }
/// The light of a raster position, from many samples.
double irradiance(const Camera& camera, double column, double row, int samples) {
  double sum = 0;
  for (const PupilPoint& p : vogel_points(samples)) {
    sum += camera.sample({.film = camera.film().point(column, row), .pupil_u = p.u, .pupil_v = p.v}).weight;
  }
  return sum / samples;
}

const Film film{.width_mm = 36, .height_mm = 24, .columns = 480, .rows = 320};

double light_of(const std::vector<LayerRay>& rays) {
  double sum = 0;
  for (const LayerRay& ray : rays) sum += ray.weight;
  return sum;
}

LayerCamera small_camera() { return layer_camera(320, 240, radians(30)); }

TEST(VogelPoints, AreUniform) {
  // The mean of u-periodic and of radial functions.
  const std::vector<PupilPoint> points = vogel_points(1000);
  double wave = 0, share = 0;
  for (const PupilPoint& p : points) wave += std::cos(2 * std::numbers::pi * p.u) / 1000, share += p.v / 1000;
  EXPECT_NEAR(wave, 0, 2e-3);
  EXPECT_NEAR(share, 0.5, 1e-12);
  expect_error([] { vogel_points(0); }, {"points", 0});
}

TEST(ThinLensRays, MeetInThePlaneOfFocus) {
  const LensRays rays = LensRays::thin(small_camera(), {.radius_mm = 20, .inverse_focus = in_focus}, vogel_points(64));
  EXPECT_TRUE(rays.shift_invariant());
  EXPECT_LT(rays.interpolation_error_px(), 1e-3);
  EXPECT_NEAR(rays.largest_slope(), 20 * rays.camera().focal_px, 0.07 * 20 * rays.camera().focal_px);
  std::vector<LayerRay> found(rays.count());
  rays.at(0, 17, 201, found);
  for (const LayerRay& ray : found) {
    const Vec2<double> place = ray.position + ray.slope * in_focus;
    EXPECT_NEAR(place.x, 17.5, 1e-3);
    EXPECT_NEAR(place.y, 201.5, 1e-3);
  }
}

TEST(ThinLensRays, BlurEqualsTheFormula) {
  // A disc of radius |w - 1 / focus| x E / 2 x (rows / 2) / tan(fov / 2).
  const std::vector<PupilPoint> rim{{0, 1}, {0.25, 1}, {0.5, 1}, {0.75, 1}};
  const LensRays rays = LensRays::thin(small_camera(), {.radius_mm = 20, .inverse_focus = in_focus}, rim);
  std::vector<LayerRay> found(rays.count());
  rays.at(0, 100, 100, found);
  for (const double w : {0.0, 1 / 1000.0, 1 / 9000.0}) {
    for (const LayerRay& ray : found) {
      const Vec2<double> off = ray.position + ray.slope * w - Vec2<double>{100.5, 100.5};
      EXPECT_NEAR(std::hypot(off.x, off.y), std::abs(w - in_focus) * 20 * 120 / std::tan(radians(15)), 1e-3);
    }
  }
  // u = 0 is up; beyond the focus, rays of the upper half of the pupil point down.
  EXPECT_LT(found[0].slope.y, 0);
  EXPECT_GT(found[1].slope.x, 0);
}

TEST(ThinLensRays, FollowAFocusPerPixel) {
  const ThinLens tilted{.radius_mm = 20, .focus = [](const Vec2<double>& raster) {
                          return FocusAt{(1 + raster.x / 320) / 2000.0, 0.5};
                        }};
  const LensRays rays = LensRays::thin(small_camera(), tilted, vogel_points(32));
  EXPECT_FALSE(rays.shift_invariant());
  EXPECT_LT(rays.interpolation_error_px(), 1e-2);  // linear in the raster, so that interpolation is exact
  EXPECT_NEAR(rays.largest_slope(), 0.5 * 20 * rays.camera().focal_px, 0.04 * 20 * rays.camera().focal_px);
}

TEST(ThinLensRays, KeepTheLightOfWeights) {
  for (const EdgeWeight& edge : {EdgeWeight{4, 0.8}, EdgeWeight{-3, 0.5}, EdgeWeight{100, 0.9}}) {
    const LensRays rays =
        LensRays::thin(small_camera(), {.radius_mm = 9, .iris = {.blades = 6}, .edge = edge}, vogel_points(512));
    std::vector<LayerRay> found(rays.count());
    rays.at(0, 0, 0, found);
    EXPECT_NEAR(light_of(found) / 512, 1, 0.03);
  }
}

TEST(ThinLensRays, RefuseInvalidLenses) {
  const auto says = [](const ThinLens& lens, const std::vector<petzval::testing::Token>& tokens) {
    expect_error([&] { LensRays::thin(small_camera(), lens, vogel_points(4)); }, tokens);
  };
  says({.radius_mm = -1}, {"radius", -1});
  says({.radius_mm = 100, .inverse_focus = 0.01}, {"depth", "lens"});
  says({.radius_mm = 1, .inverse_focus = -0.01}, {-0.01});
  says({.radius_mm = 1, .inverse_focus = std::numeric_limits<double>::quiet_NaN()}, {"nan"});
  says({.radius_mm = 1,
        .focus =
            [](const Vec2<double>&) {
              return FocusAt{std::numeric_limits<double>::infinity(), 1};
            }},
       {});
}

/// RMS error of the fraction of points on one side of lines through the pupil.
double half_plane_error(std::span<const PupilPoint> points) {
  constexpr int lines = 400;
  double squares = 0;
  for (int i = 0; i < lines; ++i) {
    const double turn = 2 * std::numbers::pi * 0.7548776662466927 * i, s = 2 * (i + 0.5) / lines - 1;
    const double area = 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi;
    const auto below = std::count_if(points.begin(), points.end(), [&](const PupilPoint& p) {
      return std::sqrt(p.v) * std::cos(2 * std::numbers::pi * p.u - turn) < s;
    });
    squares += std::pow(static_cast<double>(below) / static_cast<double>(points.size()) - area, 2) / lines;
  }
  return std::sqrt(squares);
}

TEST(VogelSets, CoverThePupilEachAndTogether) {
  for (const auto& [sets, count, together, alone] :
       {std::tuple(4, 64, 0.0057, 0.0124), std::tuple(16, 100, 0.0013, 0.0088)}) {
    const std::vector<PupilPoint> points = vogel_sets(count, sets);
    ASSERT_EQ(points.size(), static_cast<std::size_t>(sets * count));
    EXPECT_NEAR(half_plane_error(points), together, 0.1 * together);
    for (int set = 0; set < sets; ++set) {
      EXPECT_LT(half_plane_error(
                    std::span(points).subspan(static_cast<std::size_t>(set * count), static_cast<std::size_t>(count))),
                1.2 * alone);
    }
  }
  const std::vector<PupilPoint> one = vogel_sets(9, 1), spiral = vogel_points(9);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].v, spiral[i].v);
  expect_error([] { vogel_sets(0, 4); }, {"points", 0});
  expect_error([] { vogel_sets(1 << 19, 4); }, {4, 1 << 19});
}

TEST(Rays, RefuseInconsistentOptions) {
  const auto says = [](std::vector<PupilPoint> points, const LensRaysOptions& options,
                       const std::vector<petzval::testing::Token>& tokens) {
    expect_error([&] { LensRays::thin(small_camera(), {}, points, options); }, tokens);
  };
  says({}, {}, {"points", 0});
  says(vogel_points(6), {.set_count = 4}, {"points", 6});
  says(vogel_points(6), {.set_count = 2}, {"sets", 2});
  says(vogel_points(6), {.nearest_mm = -1}, {"nearest", -1});
  says({{-5, 1e9}}, {}, {"point", -5, "1e+09"});
  expect_error([] { vogel_points(4, std::nan("")); }, {"vogel_points", "turn", "nan"});
  LayerCamera camera = small_camera();
  camera.axis.x = std::numeric_limits<double>::infinity();
  expect_error([&] { LensRays::thin(camera, {}, vogel_points(4)); }, {"axis"});
  camera = small_camera(), camera.columns = 2000000000;
  expect_error([&] { LensRays::thin(camera, {}, vogel_points(4)); }, {2000000000});
}

// Pencils that vary too fast over the image for any table; each passes its position at the depth in focus.
TEST(Rays, ErrorIsMeasuredAtTheDepthInFocus) {
  const auto source = [](int, const Vec2<double>& raster, std::span<const PupilPoint> points,
                         std::span<LayerRay> found) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double turn = 2 * std::numbers::pi * points[i].u, wide = 2e4 * (1 + std::cos(0.3 * raster.x));
      const Vec2<double> slope{wide * std::cos(turn), wide * std::sin(turn)};
      found[i] = {raster - in_focus * slope, slope, 1};
    }
  };
  const LensRays rays(small_camera(), vogel_points(16), 1, source, {.nearest_mm = 1000});
  EXPECT_LT(rays.interpolation_error_px(), 1e-3);
}

struct Model {
  ModelKind kind;
};
void PrintTo(const Model& model, std::ostream* out) { *out << name(model.kind); }

class CameraRays : public ::testing::TestWithParam<Model> {};

TEST_P(CameraRays, EqualTheCamera) {
  const Camera camera(double_gauss(), film, {.model = GetParam().kind, .normalisation = Normalisation::unity_on_axis});
  const LayerCamera layers = layer_camera(camera);
  const std::vector<PupilPoint> points = vogel_points(64);
  const LensRays rays = LensRays::of(camera, layers, points, {}, {.nearest_mm = 1000});
  EXPECT_LE(rays.interpolation_error_px(), 0.1);
  const double origin = layer_origin_z(camera);
  std::vector<LayerRay> found(points.size());
  double worst = 0;
  for (const auto& [column, row] : {std::pair{240, 160}, {3, 5}, {400, 77}, {33, 300}}) {
    rays.at(0, column, row, found);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const CameraRay ray =
          camera.sample({.film = film.point(column + 0.5, row + 0.5), .pupil_u = points[i].u, .pupil_v = points[i].v});
      if (!ray) continue;
      // Two points of the ray: raster positions seen by the layers and on the line.
      for (const double depth : {1000.0, 5e4}) {
        const double way = (origin - depth - ray.ray.origin.z) / ray.ray.direction.z;
        const Vec3<double> point = ray.ray.origin + way * ray.ray.direction;
        const Vec2<double> seen = layers.raster({point.x, point.y, depth}),
                           line = found[i].position + found[i].slope / depth;
        worst = std::max({worst, std::abs(seen.x - line.x), std::abs(seen.y - line.y)});
      }
    }
  }
  EXPECT_LT(worst, 0.1);
}

TEST_P(CameraRays, ShowSharpObjectsAtTheirRasterPositions) {
  // The centre of the rays of a pixel in the plane of focus, up to the distortion of the lens.
  const Camera camera(double_gauss(), film, {.model = GetParam().kind});
  const LensRays rays = LensRays::of(camera, layer_camera(camera), vogel_points(256));
  std::vector<LayerRay> found(256);
  const double depth = 2000 - camera.film().z() + layer_origin_z(camera);
  for (const auto& [column, row] : {std::pair{240, 160}, {300, 200}, {100, 100}}) {
    rays.at(0, column, row, found);
    Vec2<double> mean{0, 0};
    for (const LayerRay& ray : found) mean += (ray.position + ray.slope / depth) / 256.0;
    EXPECT_NEAR(mean.x, column + 0.5, 1.5);
    EXPECT_NEAR(mean.y, row + 0.5, 1.5);
  }
}

TEST_P(CameraRays, HaveTheIrradianceOfTheCamera) {
  const Camera camera(double_gauss(), film, {.model = GetParam().kind, .normalisation = Normalisation::unity_on_axis});
  const LensRays rays = LensRays::of(camera, layer_camera(camera), vogel_points(64));
  std::vector<LayerRay> found(64);
  for (const auto& [column, row] : {std::pair{240, 160}, {2, 2}, {470, 160}}) {
    rays.at(0, column, row, found);
    EXPECT_NEAR(light_of(found) / 64, irradiance(camera, column + 0.5, row + 0.5, 20000), 0.005);
  }
}
INSTANTIATE_TEST_SUITE_P(Models, CameraRays,
                         ::testing::Values(Model{ModelKind::thin}, Model{ModelKind::thick},
                                           Model{ModelKind::polynomial(7)}, Model{ModelKind::exact_float}),
                         [](const auto& model) { return std::string(name(model.param.kind)); });

TEST(CameraRays, HaveTheIrradianceOfTheCameraInSmallImages) {
  for (const auto& [columns, rows] : {std::array{12, 8}, {36, 24}, {150, 100}}) {
    const Film small{.width_mm = 36, .height_mm = 24, .columns = columns, .rows = rows};
    const Camera camera(double_gauss(), small);
    const LensRays rays = LensRays::of(camera, layer_camera(camera), vogel_points(256));
    std::vector<LayerRay> found(256);
    const double middle = irradiance(camera, 0.5 * columns, 0.5 * rows, 4096);
    double worst = 0;
    for (int row = 0; row < rows; row += std::max(3, rows / 12)) {
      for (int column = 0; column < columns; column += std::max(5, columns / 12)) {
        rays.at(0, column, row, found);
        const double expected = irradiance(camera, column + 0.5, row + 0.5, 4096);
        worst = std::max(worst, std::abs(light_of(found) / 256 - expected) / middle);
      }
    }
    EXPECT_LT(worst, columns < 20 ? 0.04 : 0.01) << columns;  // steps of 16 px give 0.11
  }
}

TEST(CameraRays, PartsOfFilmPixelsEqualAFineFilm) {
  const Film fine{.columns = 2 * film.columns, .rows = 2 * film.rows};
  const Camera camera(double_gauss(), film), of_fine(double_gauss(), fine);
  std::vector<LayerRay> rays[2] = {std::vector<LayerRay>(64), std::vector<LayerRay>(64)};
  LensRays::of(camera, layer_camera(of_fine), vogel_points(64)).at(0, 701, 95, rays[0]);
  LensRays::of(of_fine, layer_camera(of_fine), vogel_points(64)).at(0, 701, 95, rays[1]);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(rays[0][i].position, rays[1][i].position);
}

TEST(CameraRays, RefuseTravellingFilmsOtherImagesAndWavelengths) {
  Film travelling = film;
  travelling.travel_mm = 1;
  const Camera moving(double_gauss(), travelling, {.model = ModelKind::thick}),
      still(double_gauss(), film, {.model = ModelKind::thick});
  const LayerCamera layers = layer_camera(still);
  expect_error([&] { LensRays::of(moving, layers, vogel_points(4)); }, {"travels"});
  expect_error([&] { LensRays::of(still, small_camera(), vogel_points(4)); }, {320, 240});
  for (const double nm : {5.0, 1e4, std::nan("")}) {
    const Wavelength colours[] = {Wavelength{}, Wavelength::nm(nm), Wavelength{}};
    expect_error([&] { LensRays::of(still, layers, vogel_points(4), colours); }, {"wavelength", "nm"});
  }
  const Wavelength seventh[] = {Wavelength(7)};
  expect_error([&] { LensRays::of(still, layers, vogel_points(4), seventh); }, {"wavelength", 7});
}

TEST(LensRays, SampleFewPositionsIfRaysAreLinear) {
  int places = 0;
  const LensRays::Source source = [&](int, const Vec2<double>& raster, std::span<const PupilPoint> points,
                                      std::span<LayerRay> found) {
    ++places;
    for (std::size_t i = 0; i < points.size(); ++i) {
      found[i] = {raster + Vec2<double>{points[i].u, 0.01 * raster.x}, {1000 * points[i].v, 0}, 1};
    }
  };
  const LensRays rays(layer_camera(512, 512, radians(30)), vogel_points(16), 1, source, {.threads = 1});
  EXPECT_EQ(places, 3 * 3 + 5 * 5);  // nodes in steps of 256 px, and midpoints between nodes
  EXPECT_LT(rays.interpolation_error_px(), 1e-3);
}

TEST(LensRays, StopIfCancelled) {
  std::stop_source stop;
  int nodes = 0;
  const LensRays::Source source = [&](int, const Vec2<double>& raster, std::span<const PupilPoint>,
                                      std::span<LayerRay> found) {
    if (++nodes == 5) stop.request_stop();
    std::fill(found.begin(), found.end(), LayerRay{raster, {1000, 0}, 1});
  };
  EXPECT_THROW(LensRays(small_camera(), vogel_points(4), 1, source, {.stop = stop.get_token()}), Cancelled);
  EXPECT_EQ(nodes, 5);
  const Camera camera(double_gauss(), film);
  EXPECT_THROW(LensRays::of(camera, layer_camera(camera), vogel_points(4), {}, {.stop = stop.get_token()}), Cancelled);
}

TEST(LensRays, RefuseAnEmptySource) {
  expect_error([] { LensRays(small_camera(), vogel_points(4), 1, {}); }, {"lens rays", "source"});
}

// A lens that squeezes the image and leaves the left third dark: rays next to the dark third do not move.
TEST(LensRays, AreNotMovedByDarkAreas) {
  const LayerCamera camera = small_camera();
  const auto source = [&](int, const Vec2<double>& raster, std::span<const PupilPoint> at, std::span<LayerRay> found) {
    const Vec2<double> off = raster - camera.axis;
    const bool dark = raster.x < 100;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const LayerRay lit{
          camera.axis + Vec2<double>{0.5 * off.x, 0.9 * off.y}, {900 * at[i].u + off.x, 900 * at[i].v}, 1};
      found[i] = dark ? LayerRay{raster, {0, 0}, 0} : lit;
    }
  };
  const LensRays rays(camera, vogel_points(8), 1, source);
  EXPECT_LT(rays.interpolation_error_px(), 0.1);
  std::vector<LayerRay> found(rays.count()), exact(rays.count());
  for (int column = 100; column < 320; ++column) {
    rays.at(0, column, 120, found), rays.exact_rays_at(0, column, 120, exact);
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_NEAR(found[i].position.x, exact[i].position.x, 1e-3) << column;
      ASSERT_NEAR(found[i].slope.x, exact[i].slope.x, 1e-2) << column;
    }
  }
}

TEST(LensRays, RefuseNumbersBeyondFloat) {
  for (const double weight : {1e16, 1e300}) {
    const auto source = [&](int, const Vec2<double>& raster, std::span<const PupilPoint>, std::span<LayerRay> found) {
      for (LayerRay& ray : found) ray = {.position = raster, .weight = weight};
    };
    expect_error([&] { LensRays(small_camera(), vogel_points(4), 1, source); }, {weight});
  }
}

TEST(LayerCameras, RefuseFisheyes) {
  const Lens fisheye = petzval::testing::data_lens("fisheye_8mm_f2.8");
  expect_error([&] { layer_camera(Camera(fisheye, film, {.model = ModelKind::exact_float})); }, {"axis"});
  expect_error([] { layer_camera(10, 10, radians(150)); }, {150});
  expect_error([] { layer_camera(0, 10, radians(15)); }, {0, 10});
}

}  // namespace lens_rays_test
