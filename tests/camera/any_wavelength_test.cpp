// SPDX-License-Identifier: Apache-2.0
// Cameras at wavelengths that the lens was not compiled for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "camera/polynomial_model.hpp"
#include "camera/ray_model.hpp"
#include "camera_parts.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "settings.hpp"

namespace petzval {
namespace any_wavelength_test {

using testing::compiled;
using testing::eight_wavelengths;

constexpr std::array ids{"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8", "tessar_100mm_f2.8", "telephoto_200mm_f1.8",
                         "catadioptric_mangin_1000mm_f7.5"};

/// A film within the declared field, at most 36 mm wide.
Film film_for(const Prescription& prescription, const Lens& lens) {
  const double width = std::min(36.0, 2 * petzval::testing::declared_radius(prescription, lens) / 1.21);
  return {.width_mm = width, .height_mm = width * 2 / 3, .columns = 1920, .rows = 1280};
}

/// Random camera samples on a film.
class Samples {
 public:
  explicit Samples(const Film& film, std::uint64_t seed = 1) : film_(film), random_(seed) {}
  CameraSample operator()(Wavelength wavelength) {
    return {.film = film_.point(film_.columns * unit_(random_), film_.rows * unit_(random_)),
            .pupil_u = unit_(random_),
            .pupil_v = unit_(random_),
            .wavelength = wavelength};
  }
  double nm() { return 400 + 300 * unit_(random_); }

 private:
  Film film_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

Ray<double> reversed(const Ray<double>& ray) { return {ray.origin, -ray.direction}; }

class AnyWavelength : public ::testing::TestWithParam<const char*> {
 protected:
  const Prescription prescription_ = petzval::testing::data_prescription(GetParam());
  const Lens lens_ = compiled(prescription_, eight_wavelengths());
  const Film film_ = film_for(prescription_, lens_);
};

TEST_P(AnyWavelength, RaysEqualRaysOfACompiledWavelength) {
  // Pixels per mm of a film of 36 mm with 1920 columns.
  const double per_mm = 1920 / 36.0;
  for (const auto& [model, limit] :
       {std::pair(ModelKind::exact_double, 1e-3), std::pair(ModelKind::polynomial(7), 0.05),
        std::pair(ModelKind::thick, 0.05), std::pair(ModelKind::pinhole, 0.05)}) {
    const Camera camera(lens_, film_, {.model = model});
    double worst = 0;
    std::size_t compared = 0;
    for (const double nm : {407.3, 421.4, 464.3, 512.9, 613.2, 677.7}) {
      const Lens own_lens = with_film(compiled(prescription_, {nm}), lens_.film_z());
      const Camera own(own_lens, film_, {.model = model == ModelKind::pinhole ? ModelKind::thick : model});
      Samples samples(film_);
      for (int i = 0; i < 100; ++i) {
        const CameraSample sample = samples(Wavelength::nm(nm));
        const CameraRay ray = camera.sample(sample);
        if (!ray) continue;
        const Importance back = own.importance(reversed(ray.ray));
        if (back.fate == RayFate::outside_fit) continue;
        ++compared;
        worst = std::max(worst, per_mm * std::hypot(back.film.x - sample.film.x, back.film.y - sample.film.y));
      }
    }
    RecordProperty(std::string(name(model)), std::to_string(worst));
    EXPECT_LT(worst, limit) << name(model);
    EXPECT_GT(compared, 300u) << name(model);
  }
}

TEST_P(AnyWavelength, FilmAndSceneSideAgree) {
  for (const ModelKind model :
       {ModelKind::exact_double, ModelKind::polynomial(5), ModelKind::thick, ModelKind::thin_two_disc}) {
    const bool each = model != ModelKind::exact_double;
    const Camera camera(lens_, film_,
                        {model, each ? Normalisation::unity_at_each_wavelength : Normalisation::irradiance});
    Samples samples(film_, 5);
    int rays = 0, lost = 0;
    for (int i = 0; i < 300; ++i) {
      const Wavelength nm = Wavelength::nm(samples.nm());
      const CameraSample sample = samples(nm);
      const CameraRay ray = camera.sample(sample);
      if (!ray) continue;
      ++rays;
      const Importance back = camera.importance(reversed(ray.ray), nm);
      if (!back || !(back.pdf_direction > 0)) {
        ++lost;  // at the edge of the film or the pupil
        continue;
      }
      ASSERT_NEAR(back.we / (back.pdf_position * back.pdf_direction), ray.weight, 1e-6 * ray.weight) << name(model);
      ASSERT_NEAR(std::hypot(back.film.x - sample.film.x, back.film.y - sample.film.y), 0, 1e-7) << name(model);
      ASSERT_NEAR(back.pdf_pupil, ray.pdf_pupil, 1e-6 * ray.pdf_pupil) << name(model);
    }
    EXPECT_GT(rays, 150) << name(model);
    EXPECT_LE(lost, rays / 50) << name(model);
  }
}

TEST_P(AnyWavelength, EverySampledRayIsConnected) {
  for (const ModelKind model : {ModelKind::exact_double, ModelKind::polynomial(5), ModelKind::thick}) {
    const Camera camera(lens_, film_, {.model = model});
    Samples samples(film_, 9);
    int rays = 0;
    for (int i = 0; i < 400; ++i) {
      const Wavelength nm = Wavelength::nm(samples.nm());
      const CameraRay ray = camera.sample(samples(nm));
      if (!ray) continue;
      ++rays;
      const Vec3<double> point = ray.ray.origin + 1e5 * ray.ray.direction;
      ASSERT_GT(camera.pdf_importance(point, -ray.ray.direction, nm), 0) << name(model);
      const ImportanceSample connection = camera.sample_importance(point, 0.3, 0.4, nm);
      ASSERT_GT(connection.pdf, 0) << name(model);
      ASSERT_NEAR(camera.pdf_importance(point, connection.direction, nm), connection.pdf, 1e-9 * connection.pdf)
          << name(model);
    }
    EXPECT_GT(rays, 200) << name(model);
  }
}

TEST_P(AnyWavelength, DifferentialsEqualFiniteDifferences) {
  for (const ModelKind model : {ModelKind::exact_double, ModelKind::polynomial(5), ModelKind::thin_two_disc,
                                ModelKind::thick, ModelKind::pinhole}) {
    const Camera camera(lens_, film_, {.model = model});
    const petzval::testing::CameraParts parts(camera);
    Samples samples(film_, 3);
    int lit = 0;
    for (int i = 0; i < 300; ++i) {
      const CameraSample sample = samples(Wavelength::nm(samples.nm()));
      constexpr double step = 1e-4;
      const CameraRay after = camera.sample(parts.moved(sample, step, 0));
      const CameraRay before = camera.sample(parts.moved(sample, -step, 0));
      if (!after || !before) continue;
      ++lit;
      const double slope = (after.ray.direction.x - before.ray.direction.x) / (2 * step);
      const double found = camera.sample_differential(sample).by_film_x.direction.x;
      ASSERT_NEAR(found, slope, 2e-3 * std::abs(slope) + 1e-6) << name(model) << ' ' << i;
    }
    EXPECT_GT(lit, 150) << name(model);
  }
}

INSTANTIATE_TEST_SUITE_P(Camera, AnyWavelength, ::testing::ValuesIn(ids),
                         [](const auto& parameter) { return std::to_string(parameter.index); });

/// Mean weight of a film point.
double exposure(const Camera& camera, const FilmPoint& film, Wavelength wavelength) {
  constexpr int side = 48;
  double sum = 0;
  for (int i = 0; i < side * side; ++i) {
    sum += camera.sample({film, (i % side + 0.5) / side, (i / side + 0.5) / side, wavelength}).weight;
  }
  return sum / (side * side);
}

// For exact rays the limit is the noise of the samples.
TEST(AnyWavelengthOf, ExposureEqualsExposureOfACompiledWavelength) {
  for (const char* id : ids) {
    const Prescription prescription = petzval::testing::data_prescription(id);
    const Lens lens = compiled(prescription, eight_wavelengths());
    const Film film = film_for(prescription, lens);
    for (const auto& [model, limit] :
         {std::pair(ModelKind::exact_float, 8e-3), std::pair(ModelKind::polynomial(5), 6e-3),
          std::pair(ModelKind::thin_two_disc, 6e-3), std::pair(ModelKind::thick, 1e-4)}) {
      const Camera camera(lens, film, {.model = model});
      const FilmPoint point = film.point(0.7 * film.columns, 0.7 * film.rows);
      double largest = 0;
      for (const double nm : {421.2, 421.6, 443., 550., 635.}) {  // 421.4 nm is midway between compiled wavelengths
        const Camera own(with_film(compiled(prescription, {nm}), lens.film_z()), film, {.model = model});
        const double found = exposure(camera, point, Wavelength::nm(nm)), wanted = exposure(own, point, {});
        largest = std::max(largest, std::abs(found / wanted - 1));
      }
      RecordProperty(std::string(id) + " " + std::string(name(model)), std::to_string(largest));
      EXPECT_LT(largest, limit) << id << " " << name(model);
    }
  }
}

// The numbers of wavelengths cover tables in one register, in two registers and in memory.
TEST(AnyWavelengthOf, MixedBatchEqualsBatchesOfOneWavelength) {
  const Prescription prescription = petzval::testing::data_prescription("tessar_100mm_f2.8");
  const auto check = [&]<class T>(T, ModelKind model, std::size_t wavelengths, double limit) {
    std::vector<double> nm;
    for (std::size_t w = 0; w < wavelengths; ++w) nm.push_back(400 + 300. * static_cast<double>(w) / 40);
    const Lens lens = compiled(prescription, nm);
    const Film film = film_for(prescription, lens);
    const Camera camera(lens, film, {.model = model, .normalisation = Normalisation::unity_at_each_wavelength});
    constexpr std::size_t count = 150;
    Samples samples(film, 4);
    std::array<std::vector<T>, 4> in;
    std::vector<std::uint16_t> each;
    for (std::size_t i = 0; i < count; ++i) {
      const CameraSample s = samples({});
      in[0].push_back(static_cast<T>(s.film.x)), in[1].push_back(static_cast<T>(s.film.y));
      in[2].push_back(static_cast<T>(s.pupil_u)), in[3].push_back(static_cast<T>(s.pupil_v));
      each.push_back(static_cast<std::uint16_t>(i * 7 % (wavelengths + 1)));
    }
    const auto sampled = [&](const RayWavelengths& of, std::vector<RayFate>& fates) {
      std::array<std::vector<T>, 7> out;
      for (auto& values : out) values.resize(count);
      fates.resize(count);
      const auto at = [&](std::size_t k) { return out[k].data(); };
      camera.sample<T>(count, {in[0].data(), in[1].data(), in[2].data(), in[3].data(), of},
                       {{at(0), at(1), at(2), at(3), at(4), at(5)}, at(6), fates.data()});
      return out;
    };
    std::vector<RayFate> fates, own_fates;
    const auto mixed = sampled({.each = each.data()}, fates);
    for (std::size_t w = 0; w <= wavelengths; ++w) {
      const auto own = sampled({.all = w}, own_fates);
      for (std::size_t i = 0; i < count; ++i) {
        if (each[i] != w) continue;
        ASSERT_EQ(fates[i], own_fates[i]);
        ASSERT_EQ(fates[i] == RayFate::outside_spectrum, w == wavelengths);
        ASSERT_NEAR(mixed[6][i], own[6][i], limit * double{own[6][i]}) << w << " of " << wavelengths;
        for (std::size_t k = 3; k < 6; ++k) ASSERT_NEAR(mixed[k][i], own[k][i], limit) << w << " of " << wavelengths;
      }
    }
  };
  for (const ModelKind model : {ModelKind::thick, ModelKind::pinhole}) {
    for (const std::size_t wavelengths : {1, 7, 8, 15, 16, 31, 32, 40}) {
      check(float(), model, wavelengths, 1e-6), check(double(), model, wavelengths, 1e-14);
    }
  }
}

TEST(AnyWavelengthOf, OtherWavelengthsAreOutsideTheSpectrum) {
  const Prescription prescription = petzval::testing::data_prescription("double_gauss_100mm_f2.0");
  const Lens lens = compiled(prescription, eight_wavelengths());
  const Film film = film_for(prescription, lens);
  for (const ModelKind model :
       {ModelKind::exact_float, ModelKind::polynomial(5), ModelKind::thick, ModelKind::pinhole}) {
    const Camera camera(lens, film, {.model = model});
    for (const double nm : {std::numeric_limits<double>::quiet_NaN(), 399.0, 701.0, 0.0, -1.0}) {
      const Wavelength bad = Wavelength::nm(nm);
      EXPECT_EQ(camera.sample({.film = {}, .wavelength = bad}).fate, RayFate::outside_spectrum);
      EXPECT_EQ(camera.sample_differential({.film = {}, .wavelength = bad}).sample.fate, RayFate::outside_spectrum);
      EXPECT_EQ(camera.importance({{0, 0, -1000}, {0, 0, 1}}, bad).fate, RayFate::outside_spectrum);
      EXPECT_EQ(camera.sample_importance({0, 0, -1000}, 0.5, 0.5, bad).importance.fate, RayFate::outside_spectrum);
      EXPECT_EQ(camera.sample_distant_importance({0, 0, 1}, 0.5, 0.5, bad).importance.fate, RayFate::outside_spectrum);
      EXPECT_EQ(camera.pdf_importance({0, 0, -1000}, {0, 0, 1}, bad), 0);
      EXPECT_EQ(camera.project({0, 0, -1000}, bad).status, AimStatus::no_ray);
    }
    EXPECT_EQ(camera.project({0, 0, -3000}, Wavelength::nm(511)).status, AimStatus::converged);
  }
}

TEST(AnyWavelengthOf, ClampingUsesTheEndsOfTheRange) {
  const Prescription prescription = petzval::testing::data_prescription("double_gauss_100mm_f2.0");
  const Lens lens = compiled(prescription, eight_wavelengths());
  const Film film = film_for(prescription, lens);
  const FilmPoint point{3, -2};
  const Vec3<double> scene{40, 30, -2000};
  for (const ModelKind model :
       {ModelKind::exact_float, ModelKind::polynomial(5), ModelKind::thick, ModelKind::pinhole}) {
    const Camera camera(lens, film, {.model = model, .clamp_wavelengths = true});
    const auto same = [](const Ray<double>& a, const Ray<double>& b) {
      return a.origin == b.origin && a.direction == b.direction;
    };
    for (const auto& [beyond, end] : {std::pair{360.0, 400.0}, {-1.0, 400.0}, {830.0, 700.0}, {511.0, 511.0}}) {
      const Wavelength out = Wavelength::nm(beyond), in = Wavelength::nm(end);
      const CameraSample sample{.film = point, .pupil_u = 0.3, .pupil_v = 0.6, .wavelength = out};
      CameraSample at_end = sample;
      at_end.wavelength = in;
      const CameraRay ray = camera.sample(sample), wanted = camera.sample(at_end);
      EXPECT_TRUE(ray) << name(model) << " " << beyond;
      EXPECT_EQ(ray.weight, wanted.weight);
      EXPECT_TRUE(same(ray.ray, wanted.ray));
      EXPECT_TRUE(same(camera.sample_differential(sample).by_film_x, camera.sample_differential(at_end).by_film_x));
      const auto connection = camera.sample_importance(scene, 0.3, 0.6, out);
      EXPECT_TRUE(connection) << name(model) << " " << beyond;
      EXPECT_EQ(connection.importance.we, camera.sample_importance(scene, 0.3, 0.6, in).importance.we);
      const Ray<double> back{scene, connection.direction};
      EXPECT_EQ(camera.importance(back, out).we, camera.importance(back, in).we);
      EXPECT_EQ(camera.pdf_importance(scene, back.direction, out), camera.pdf_importance(scene, back.direction, in));
      EXPECT_EQ(camera.project(scene, out).raster, camera.project(scene, in).raster);
    }
    const auto lost = camera.sample({.film = point, .wavelength = Wavelength::nm(std::nan(""))});
    EXPECT_EQ(lost.fate, RayFate::outside_spectrum);

    // 777 samples take several blocks.
    constexpr std::size_t count = 777;
    const std::vector<double> x(count, point.x), y(count, point.y), u(count, 0.3), v(count, 0.6);
    std::vector<float> nm(count), clamped_nm(count);
    for (std::size_t i = 0; i < count; ++i) {
      nm[i] = 360 + static_cast<float>(i);
      clamped_nm[i] = std::clamp(nm[i], 400.0F, 700.0F);
    }
    const auto sampled = [&](const std::vector<float>& each_nm) {
      std::array<std::vector<double>, 7> out;
      for (auto& column : out) column.resize(count);
      const auto at = [&](std::size_t k) { return out[k].data(); };
      camera.sample<double>(count, {x.data(), y.data(), u.data(), v.data(), {.each_nm = each_nm.data()}},
                            {{at(0), at(1), at(2), at(3), at(4), at(5)}, at(6)});
      return out;
    };
    EXPECT_EQ(sampled(nm), sampled(clamped_nm)) << name(model);
    const auto importances = [&](const std::vector<float>& each_nm) {
      const std::vector<Vec3<double>> points(count, scene);
      std::vector<ImportanceSample> found(count);
      camera.sample_importance(count, points.data(), u.data(), v.data(), {.each_nm = each_nm.data()}, found.data());
      std::array<std::vector<double>, 6> rays;
      for (const ImportanceSample& f : found) {
        for (int k = 0; k < 3; ++k) rays[k].push_back(scene[k]), rays[3 + k].push_back(f.direction[k]);
      }
      std::vector<Importance> of_rays(count);
      camera.importance(
          count, {rays[0].data(), rays[1].data(), rays[2].data(), rays[3].data(), rays[4].data(), rays[5].data()},
          {.each_nm = each_nm.data()}, of_rays.data());
      std::vector<double> we;
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_TRUE(found[i]) << name(model) << " " << nm[i];
        we.push_back(found[i].importance.we), we.push_back(of_rays[i].we);
      }
      return we;
    };
    EXPECT_EQ(importances(nm), importances(clamped_nm)) << name(model);
  }
}

}  // namespace any_wavelength_test
}  // namespace petzval
