// SPDX-License-Identifier: Apache-2.0
// Rays of petzval_camera.h from the table of a camera, and rays of the library.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/petzval_camera.h"

namespace petzval {
namespace {

using testing::expect_error;

constexpr double eps = std::numeric_limits<float>::epsilon();

/// A film that a lens covers, off its centre.
Film film_of(const Lens& lens) {
  const double back = std::abs(lens.film_z() - lens.surfaces().back().vertex_z), half = std::min(18.0, 0.6 * back);
  return {.width_mm = 2 * half, .height_mm = 1.2 * half, .shift_x_mm = 0.05 * half, .margin_mm = 0.01 * half};
}
double size_of(const Lens& lens) {
  double size = std::abs(lens.surfaces().back().vertex_z) + 1;
  for (const LensSurface& s : lens.surfaces()) size = std::max(size, s.semi_diameter < 1e6 ? s.semi_diameter : 0);
  return size;
}
double largest(const Vec3<double>& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
Vec3<double> vec(const pz_vector& v) { return {v.x, v.y, v.z}; }

struct Samples {
  explicit Samples(const Film& film, unsigned seed = 1) : random(seed), film_(film) {}
  std::mt19937 random;

  float number() { return std::uniform_real_distribution<float>()(random); }
  CameraSample operator()(Wavelength wavelength = {}) {
    const float x = static_cast<float>((number() - 0.5) * film_.width_mm + film_.shift_x_mm);
    const float y = static_cast<float>((number() - 0.5) * film_.height_mm + film_.shift_y_mm);
    const float u = number(), v = number();
    return {{x, y}, u, v, wavelength};
  }

 private:
  Film film_;
};

pz_ray ray_of(const std::vector<float>& table, const CameraSample& s, double nm) {
  return pz_sample(table.data(), static_cast<float>(s.film.x), static_cast<float>(s.film.y),
                   static_cast<float>(s.pupil_u), static_cast<float>(s.pupil_v), static_cast<float>(nm));
}
float primary_nm(const Lens& lens) { return static_cast<float>(lens.wavelengths_nm()[lens.primary_wavelength()]); }

/// Errors of rays that pass, in units of eps: positions relative to the size of the lens, directions in radians.
struct Errors {
  double library = 0, header = 0, between = 0, weight = 0;
  int lit = 0, other_fates = 0;
};
Errors errors_of(const Lens& lens, ModelKind model, int count) {
  const Film film = film_of(lens);
  const Camera camera(lens, film, {.model = model});
  const Camera exact(lens, film, {.model = model == ModelKind::exact_float ? ModelKind::exact_double : model});
  const std::vector<float> table = camera_table(camera);
  EXPECT_TRUE(pz_valid(table.data(), static_cast<int>(table.size())));
  const double size = size_of(lens);
  Samples samples(film);
  std::vector<CameraSample> all;
  std::array<std::vector<float>, 4> in;
  for (int i = 0; i < count; ++i) {
    const CameraSample s = all.emplace_back(samples());
    const std::array values{s.film.x, s.film.y, s.pupil_u, s.pupil_v};
    for (std::size_t k = 0; k < 4; ++k) in[k].push_back(static_cast<float>(values[k]));
  }
  std::array<std::vector<float>, 7> out;
  for (auto& values : out) values.resize(all.size());
  std::vector<RayFate> fates(all.size());
  camera.sample<float>(all.size(), {in[0].data(), in[1].data(), in[2].data(), in[3].data()},
                       {{out[0].data(), out[1].data(), out[2].data(), out[3].data(), out[4].data(), out[5].data()},
                        out[6].data(),
                        fates.data()});
  Errors found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const CameraRay twice = exact.sample(all[i]);
    const pz_ray ray = ray_of(table, all[i], primary_nm(lens));
    found.other_fates += (fates[i] == RayFate::transmitted) != (ray.fate == 0);
    if (fates[i] != RayFate::transmitted || !twice || ray.fate != 0) continue;
    ++found.lit;
    const auto error = [&](const Ray<double>& a, const Ray<double>& b) {
      return std::max(largest(a.origin - b.origin) / size, largest(a.direction - b.direction)) / eps;
    };
    const Ray<double> own{vec(ray.origin), vec(ray.direction)};
    const Ray<double> single{{out[0][i], out[1][i], out[2][i]}, {out[3][i], out[4][i], out[5][i]}};
    found.library = std::max(found.library, error(single, twice.ray));
    found.header = std::max(found.header, error(own, twice.ray));
    found.between = std::max(found.between, error(own, single));
    found.weight = std::max(found.weight, std::abs(double{ray.weight} / double{out[6][i]} - 1) / eps);
  }
  return found;
}

class CameraTableOfData : public ::testing::TestWithParam<int> {};

TEST_P(CameraTableOfData, RaysEqualTheLibrary) {
  for (const Prescription& prescription : testing::data_prescriptions()) {
    SCOPED_TRACE(prescription.name);
    const Lens round = compile(prescription);
    const int blades = GetParam();
    const Lens lens = blades ? with_iris(round, {.blades = blades, .roundness = 0.4, .rotation_rad = 0.3}) : round;
    const Errors found = errors_of(lens, ModelKind::exact_float, 3000);
    EXPECT_GT(found.lit, 1200);
    EXPECT_LE(found.other_fates, 1);
    // As accurate as the library: 8 eps for most lenses, more where float loses digits in the library as well.
    EXPECT_LE(found.between, std::max(8.0, 2.4 * found.library));
    EXPECT_LE(found.header, std::max(10.0, 3 * found.library));
    EXPECT_LT(found.weight, 500);
  }
}

INSTANTIATE_TEST_SUITE_P(Camera, CameraTableOfData, ::testing::Values(0, 7));

TEST(CameraTable, PolynomialsEqualTheLibrary) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "fisheye_16mm_f2.8", "anamorphic_60mm_2x"}) {
    SCOPED_TRACE(id);
    const Errors found = errors_of(testing::data_lens(id), ModelKind::polynomial(7), 2000);
    EXPECT_GT(found.lit, 1500);
    EXPECT_LE(found.other_fates, 2);
    EXPECT_LT(found.between, 40);
  }
}

TEST(CameraTable, OddTermsEqualTheLibrary) {
  for (const int orders : {1, 2}) {
    Prescription prescription = testing::data_prescription("double_gauss_100mm_f2.0");
    auto& terms = prescription.surfaces.front().aspheric;
    terms = {{3, 2e-7}, {4, 1e-9}};
    if (orders == 2) terms.push_back({5, -1e-10});
    const Errors found = errors_of(compile(prescription), ModelKind::exact_float, 1000);
    EXPECT_GT(found.lit, 400);
    EXPECT_LE(found.other_fates, 1);
    EXPECT_LE(found.between, std::max(8.0, 2.4 * found.library));
  }
}

TEST(CameraTable, WavelengthsBetweenTheCompiledOnesEqualTheLibrary) {
  const Lens lens = compile(testing::data_prescription("double_gauss_100mm_f2.0"), std::array{450.0, 550.0, 650.0});
  const Film film = film_of(lens);
  const Camera camera(lens, film, {.model = ModelKind::exact_float});
  const std::vector<float> table = camera_table(camera);
  Samples samples(film);
  int lit = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto nm = static_cast<float>(440 + 220 * samples.number());
    const CameraSample s = samples(Wavelength::nm(nm));
    const CameraRay wanted = camera.sample(s);
    const pz_ray ray = ray_of(table, s, nm);
    const bool inside = nm >= 450 && nm <= 650;
    EXPECT_EQ(ray.fate == 0, static_cast<bool>(wanted)) << nm;
    EXPECT_EQ(ray.fate == 8, !inside) << nm;
    if (ray.fate != 0 || !wanted) continue;
    ++lit;
    EXPECT_LT(largest(vec(ray.direction) - wanted.ray.direction), 8 * eps);
    EXPECT_LT(largest(vec(ray.origin) - wanted.ray.origin), 8 * eps * size_of(lens));
    EXPECT_NEAR(ray.weight / wanted.weight, 1, 2e-6);
  }
  EXPECT_GT(lit, 1500);
}

TEST(CameraTable, DifferentialsEqualTheLibrary) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "phone_5.6mm_f3.5", "fisheye_16mm_f2.8", "anamorphic_60mm_2x",
                               "mirror_ritchey_chretien_57.6m_f24"}) {
    for (const ModelKind model : {ModelKind::exact_double, ModelKind::polynomial(5)}) {
      SCOPED_TRACE(id);
      const Lens lens = testing::data_lens(id);
      const Film film = film_of(lens);
      const Camera camera(lens, film, {.model = model});
      const std::vector<float> table = camera_table(camera);
      Samples samples(film, 3);
      int lit = 0;
      for (int i = 0; i < 300; ++i) {
        const CameraSample s = samples();
        const CameraRayDifferential wanted = camera.sample_differential(s);
        const pz_ray_differential found =
            pz_sample_differential(table.data(), static_cast<float>(s.film.x), static_cast<float>(s.film.y),
                                   static_cast<float>(s.pupil_u), static_cast<float>(s.pupil_v), primary_nm(lens));
        if (!wanted.sample || found.ray.fate != 0) continue;
        ++lit;
        const auto near = [&](const pz_vector& a, const Vec3<double>& b, double scale) {
          const double bound = (model == ModelKind::exact_double ? 1e-4 : 4e-3) * scale;
          EXPECT_LT(largest(vec(a) - b), bound) << i << ' ' << b.x << ' ' << b.y << ' ' << b.z;
        };
        const double turn = glm::length(wanted.by_film_x.direction) + glm::length(wanted.by_film_y.direction);
        const double shift = glm::length(wanted.by_film_x.origin) + glm::length(wanted.by_film_y.origin) + 1;
        near(found.direction_by_x, wanted.by_film_x.direction, turn);
        near(found.direction_by_y, wanted.by_film_y.direction, turn);
        near(found.origin_by_x, wanted.by_film_x.origin, shift);
        near(found.origin_by_y, wanted.by_film_y.origin, shift);
      }
      EXPECT_GT(lit, 150);
    }
  }
}

TEST(CameraTable, ConnectionsEqualTheLibrary) {
  int with_light = 0;
  for (const Prescription& prescription : testing::data_prescriptions()) {
    SCOPED_TRACE(prescription.name);
    const Lens lens = compile(prescription);
    const Film film = film_of(lens);
    const Camera camera(lens, film, {.model = ModelKind::exact_float});
    const std::vector<float> table = camera_table(camera);
    const double size = size_of(lens);
    Samples samples(film, 5);
    int lit = 0, other_fates = 0, grazing = 0;
    std::vector<double> errors;
    for (int i = 0; i < 1000; ++i) {
      const float field = 1.2f * samples.number(), turn = 6.28f * samples.number();
      const auto distance = static_cast<float>(size * std::exp(8 * samples.number() - 0.5));
      const pz_vector point{distance * std::sin(field) * std::sin(turn), distance * std::sin(field) * std::cos(turn),
                            -distance * std::cos(field)};
      const float u = samples.number(), v = samples.number();
      const ImportanceSample wanted = camera.sample_importance(vec(point), u, v);
      const pz_connection found = pz_connect(table.data(), point, u, v, primary_nm(lens));
      ASSERT_EQ(found.pdf > 0, wanted.pdf > 0) << distance;
      if (!(wanted.pdf > 0)) continue;
      EXPECT_LT(largest(vec(found.direction) - wanted.direction), 16 * eps);
      EXPECT_NEAR(found.pdf / wanted.pdf, 1, 2e-4);
      grazing += !(std::abs(found.distance - wanted.distance) <= 1e-5 * (wanted.distance + size));
      const bool passes = wanted.importance.fate == RayFate::transmitted;
      other_fates += passes != (found.arrival.fate == 0);
      if (!passes || found.arrival.fate != 0) continue;
      ++lit, ++with_light;
      EXPECT_NEAR(found.arrival.we / wanted.importance.we, 1, 1e-6);
      EXPECT_NEAR(found.arrival.pdf_position / wanted.importance.pdf_position, 1, 1e-6);
      EXPECT_NEAR(found.arrival.pdf_direction / wanted.importance.pdf_direction, 1, 3e-4);
      errors.push_back(
          std::hypot(found.arrival.film.x - wanted.importance.film.x, found.arrival.film.y - wanted.importance.film.y) /
          std::hypot(film.width_mm, film.height_mm));
    }
    EXPECT_LE(other_fates, 1);
    // A line that touches the sphere of the front meets it at an uncertain place: 5 of 20,000 lines of the worst lens.
    EXPECT_LE(grazing, 1);
    // A millionth of the film; rays from near the lens through long focal lengths lose more digits.
    EXPECT_LT(lit > 0 ? *std::ranges::max_element(errors) : 0, 5e-5);
  }
  EXPECT_GT(with_light, 10000);
}

TEST(CameraTable, ConnectionsOfPolynomialsEqualTheLibrary) {
  for (const char* const id : {"double_gauss_100mm_f2.0", "fisheye_16mm_f2.8", "anamorphic_60mm_2x"}) {
    SCOPED_TRACE(id);
    const Lens lens = testing::data_lens(id);
    const Film film = film_of(lens);
    const Camera camera(lens, film, {.model = ModelKind::polynomial(5)});
    const std::vector<float> table = camera_table(camera);
    Samples samples(film, 8);
    int lit = 0, other_fates = 0;
    for (int i = 0; i < 600; ++i) {
      const CameraSample s = samples();
      const CameraRay ray = camera.sample(s);
      if (!ray) continue;
      const pz_vector point{static_cast<float>(ray.ray.origin.x + 900 * ray.ray.direction.x),
                            static_cast<float>(ray.ray.origin.y + 900 * ray.ray.direction.y),
                            static_cast<float>(ray.ray.origin.z + 900 * ray.ray.direction.z)};
      const float u = samples.number(), v = samples.number();
      const ImportanceSample wanted = camera.sample_importance(vec(point), u, v);
      const pz_connection found = pz_connect(table.data(), point, u, v, primary_nm(lens));
      EXPECT_EQ(found.pdf > 0, wanted.pdf > 0);
      const bool passes = wanted.importance.fate == RayFate::transmitted;
      other_fates += passes != (found.arrival.fate == 0);
      if (!passes || found.arrival.fate != 0) continue;
      ++lit;
      EXPECT_NEAR(found.arrival.film.x, wanted.importance.film.x, 1e-5 * film.width_mm);
      EXPECT_NEAR(found.arrival.film.y, wanted.importance.film.y, 1e-5 * film.width_mm);
      EXPECT_NEAR(found.arrival.pdf_direction / wanted.importance.pdf_direction, 1, 1e-3);
    }
    EXPECT_GT(lit, 250);
    EXPECT_LE(other_fates, 6);
  }
}

TEST(CameraTable, DensitiesOfDirectionsEqualThoseOfSamples) {
  for (const char* const id :
       {"double_gauss_100mm_f2.0", "fisheye_8mm_f2.8", "anamorphic_60mm_2x", "catadioptric_mangin_1000mm_f7.5"}) {
    SCOPED_TRACE(id);
    const Lens lens = testing::data_lens(id);
    const std::vector<float> table = camera_table(Camera(lens, film_of(lens), {.model = ModelKind::exact_float}));
    Samples samples({}, 9);
    int same = 0, count = 0;
    for (int i = 0; i < 500; ++i) {
      const pz_vector point{300 * samples.number(), 200 * samples.number(), -3000};
      const pz_connection c = pz_connect(table.data(), point, samples.number(), samples.number(), primary_nm(lens));
      if (!(c.pdf > 0)) continue;
      ++count;
      // Densities jump between sectors, so that a direction on a border may find the density of the neighbour.
      same += std::abs(pz_pdf(table.data(), point, c.direction, primary_nm(lens)) / c.pdf - 1) < 1e-3;
    }
    EXPECT_GT(count, 400);
    EXPECT_GT(same, 0.97 * count);
  }
}

pz_vector rounded(const Vec3<double>& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Film point of a ray that is reflected twice, for spheres and planes; NaN if the ray is lost.
FilmPoint ghost_of(const Lens& lens, Vec3<double> at, Vec3<double> d, std::size_t first, std::size_t second) {
  const double lost = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0, turns = 0; i < lens.surface_count(); i += turns == 1 ? std::size_t(-1) : 1) {
    const LensSurface& surface = lens.surfaces()[i];
    const bool back = turns == 1;
    // The sphere c r.r = 2 z, where the ray crosses it in the sense of its travel, on the side of the vertex.
    const double c = surface.curvature, sense = back ? -1 : 1;
    const Vec3<double> vertex{0, 0, surface.vertex_z}, o = at - vertex;
    const double half = d.z - c * glm::dot(o, d), free = c * glm::dot(o, o) - 2 * o.z;
    const double root = sense * std::sqrt(half * half - c * free);
    at += d * (half * sense > 0 ? free / (half + root) : (half - root) / c);
    if (!(c * (at.z - vertex.z) < 1 && std::hypot(at.x, at.y) <= std::min(surface.semi_diameter, surface.edge))) {
      return {lost, lost};
    }
    const Vec3<double> normal = sense * glm::normalize(Vec3<double>{0, 0, 1} - c * (at - vertex));
    const double cosine = glm::dot(normal, d),
                 ratio = lens.index(back ? i + 1 : i, {}) / lens.index(back ? i : i + 1, {});
    if (turns < 2 && i == (back ? first : second)) {
      d -= 2 * cosine * normal, ++turns;
    } else {
      d = ratio * d + (std::sqrt(1 - ratio * ratio * (1 - cosine * cosine)) - ratio * cosine) * normal;
    }
  }
  at += d * ((lens.film_z() - at.z) / d.z);
  return {at.x, at.y};
}

TEST(CameraTable, GhostsEqualRaysInDouble) {
  for (const char* const id : {"double_gauss_52mm_f1.8", "tessar_100mm_f2.8", "biogon_35mm_f2.8"}) {
    SCOPED_TRACE(id);
    const Lens lens = testing::data_lens(id);
    const auto count = static_cast<int>(lens.surface_count());
    const std::vector<float> table = camera_table(Camera(lens, {.width_mm = 1000, .height_mm = 1000}));
    Samples samples({}, 11);
    int lit = 0, other_fates = 0;
    for (int i = 0; i < 20'000; ++i) {
      const int second = 1 + static_cast<int>(samples.number() * static_cast<float>(count - 1));
      const int first = static_cast<int>(samples.number() * static_cast<float>(second));
      const auto coordinate = [&](double scale) { return scale * (2 * double{samples.number()} - 1); };
      const double rim = lens.surfaces()[0].semi_diameter;
      const pz_vector d = rounded(glm::normalize(Vec3<double>{coordinate(0.3), coordinate(0.3), 1}));
      const pz_vector at = rounded(Vec3<double>{coordinate(rim), coordinate(rim), 0} - 50.0 * vec(d));
      const pz_ghost found = pz_ghost_of(table.data(), at, d, first, second, primary_nm(lens));
      const FilmPoint wanted = ghost_of(lens, vec(at), glm::normalize(vec(d)), static_cast<std::size_t>(first),
                                        static_cast<std::size_t>(second));
      other_fates += (std::max(std::abs(wanted.x), std::abs(wanted.y)) <= 500) != (found.fate == 0);
      if (std::isnan(wanted.x) || found.fate != 0) continue;
      ++lit;
      EXPECT_LT(std::hypot(found.film.x - wanted.x, found.film.y - wanted.y),
                1e-4 * (1 + std::hypot(wanted.x, wanted.y)));
    }
    EXPECT_GT(lit, 1000);
    EXPECT_LT(other_fates, 10);
    EXPECT_EQ(pz_ghost_of(table.data(), {0, 0, -9}, {0, 0, 1}, 3, 3, 587.56f).fate, 7);
    EXPECT_EQ(pz_ghost_of(table.data(), {0, 0, -9}, {0, 0, 1}, 0, count, 587.56f).fate, 7);
    EXPECT_EQ(pz_ghost_of(table.data(), {0, 0, -9}, {0, 0, 2}, 0, 1, 587.56f).fate, 7);
    EXPECT_EQ(pz_ghost_of(table.data(), {0, 0, -9}, {0, 0, 1}, 0, 1, 300).fate, 8);
  }
}

// Planes of incidence, which the header takes as one, change energies by less than 2 %.
TEST(CameraTable, GhostsHaveTheEnergiesOfTheLibrary) {
  for (const char* const id : {"double_gauss_52mm_f1.8", "double_gauss_100mm_f2.0", "anamorphic_60mm_2x",
                               "catadioptric_mangin_1000mm_f7.5", "phone_5.6mm_f3.5"}) {
    const Lens lens = with_iris(testing::data_lens(id), {.blades = 5});
    const Vec3<double> d = glm::normalize(Vec3<double>{0.01, 0.02, 1});
    const std::vector<float> table = camera_table(Camera(lens, {.width_mm = 1e5, .height_mm = 1e5}));
    const Ghosts ghosts = ghost_pairs(lens, {-d, true}, {.tolerance = 1e-2});
    ASSERT_GT(ghosts.pairs.size(), 2u);
    const double rim = 1.2 * lens.surfaces()[0].semi_diameter;
    for (const GhostPair& pair : std::span(ghosts.pairs).first(3)) {
      SCOPED_TRACE(std::string(id) + ' ' + std::to_string(pair.first) + ' ' + std::to_string(pair.second));
      constexpr int side = 300;
      double sum = 0, y = 0;
      for (int i = 0; i < side * side; ++i) {
        const Vec3<double> at{(i % side + 0.5) / side * 2 - 1, (i / side + 0.5) / side * 2 - 1, 0};
        const pz_ghost ghost = pz_ghost_of(table.data(), rounded(rim * at), rounded(d), static_cast<int>(pair.first),
                                           static_cast<int>(pair.second), primary_nm(lens));
        sum += ghost.weight, y += ghost.weight * ghost.film.y;
      }
      const double energy = sum / (side * side) * 4 * rim * rim * d.z / ghosts.entering_mm2;
      EXPECT_NEAR(energy, pair.energy, 0.02 * pair.energy);
      EXPECT_NEAR(y / sum, pair.centre.y, 0.05 * (pair.rms_radius_mm + 0.1));
    }
  }
}

TEST(CameraTable, FilmPointsAndRasterEqualTheFilm) {
  const Film film{.width_mm = 24, .height_mm = 16, .columns = 300, .rows = 200, .shift_x_mm = 2, .shift_y_mm = -1};
  const std::vector<float> table =
      camera_table(Camera(testing::data_lens("tessar_100mm_f2.8"), film, {.model = ModelKind::exact_float}));
  const pz_point found = pz_film_point(table.data(), 70, 150);
  const FilmPoint wanted = film.point(70, 150);
  EXPECT_NEAR(found.x, wanted.x, 1e-5);
  EXPECT_NEAR(found.y, wanted.y, 1e-5);
  const pz_point raster = pz_raster(table.data(), found);
  EXPECT_NEAR(raster.x, 70, 1e-4);
  EXPECT_NEAR(raster.y, 150, 1e-4);
}

TEST(CameraTable, InvalidSamplesHaveFates) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  const std::vector<float> table = camera_table(Camera(lens, {}, {.model = ModelKind::exact_float}));
  const float nan = std::numeric_limits<float>::quiet_NaN(), nm = primary_nm(lens);
  EXPECT_EQ(table[0], PZ_FORMAT);
  EXPECT_EQ(table[1], static_cast<float>(table.size()));
  EXPECT_EQ(pz_sample(table.data(), 18.1f, 0, 0.5f, 0.5f, nm).fate, static_cast<int>(RayFate::outside_film));
  EXPECT_EQ(pz_sample(table.data(), nan, 0, 0.5f, 0.5f, nm).fate, static_cast<int>(RayFate::outside_film));
  EXPECT_EQ(pz_sample(table.data(), 1, 2, nan, 0.5f, nm).fate, static_cast<int>(RayFate::vignetted));
  EXPECT_EQ(pz_sample(table.data(), 1, 2, 0.5f, 0.5f, 587.56f).fate, 0);
  EXPECT_EQ(pz_sample(table.data(), 1, 2, 0.5f, 0.5f, 300).fate, static_cast<int>(RayFate::outside_spectrum));
  EXPECT_EQ(pz_sample(table.data(), 1, 2, 0.5f, 0.5f, nan).fate, static_cast<int>(RayFate::outside_spectrum));
  EXPECT_EQ(pz_importance(table.data(), {0, 0, -9}, {0, 0, 2}, nm).fate, static_cast<int>(RayFate::invalid));
  EXPECT_EQ(pz_connect(table.data(), {nan, 0, -900}, 0.5f, 0.5f, nm).pdf, 0);
  EXPECT_EQ(pz_connect(table.data(), {0, 0, 900}, 0.5f, 0.5f, nm).pdf, 0);
}

TEST(CameraTable, IncompleteAndOlderTablesAreNotValid) {
  std::vector<float> table = camera_table(Camera(testing::data_lens("tessar_100mm_f2.8"), {}));
  const auto valid = [&](std::size_t size) { return pz_valid(table.data(), static_cast<int>(size)); };
  EXPECT_TRUE(valid(table.size()));
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, table.size() / 2, table.size() - 1}) {
    EXPECT_FALSE(valid(size)) << size;
    if (size > 1) table[1] = static_cast<float>(size);
    EXPECT_FALSE(valid(size)) << size;
  }
  table[1] = static_cast<float>(table.size());
  table[0] -= 1;
  EXPECT_FALSE(valid(table.size()));
}

TEST(CameraTable, OtherCamerasAreRefused) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  expect_error([&] { camera_table(Camera(lens, {.tilt_rad = 0.1}, {.model = ModelKind::exact_float})); },
               {lens.name(), "tilted"});
  expect_error([&] { camera_table(Camera(lens, {}, {.model = ModelKind::thick})); }, {lens.name(), "thick"});
}

}  // namespace
}  // namespace petzval
