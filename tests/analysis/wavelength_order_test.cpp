// SPDX-License-Identifier: Apache-2.0
// Every lens of data/ that can be compiled for F, d and C, in all six orders: results at the primary wavelength and at
// wavelengths given in nanometres do not depend on the order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace wavelength_order_test {

constexpr std::array<double, 3> lines_nm{486.1327, d_line_nm, 656.2725};
constexpr double off_axis = radians(4.0);

/// Numbers that must be equal to the bit; NaN if the lens does not have a value.
using Numbers = std::vector<double>;

std::vector<std::uint64_t> bits(const Numbers& numbers) {
  std::vector<std::uint64_t> result;
  for (const double x : numbers) result.push_back(__builtin_bit_cast(std::uint64_t, x));
  return result;
}

/// The lens stopped down and focused, with equal stop and film for every order.
Lens set(const Lens& lens) {
  const double f_number = 1.5 * real_f_number(lens);
  if (!std::isfinite(f_number)) return lens;
  const Lens stopped = with_f_number(lens, f_number);
  const FocusSolution focus = solve_focus(stopped, 3000);
  return focus ? with_film(stopped, focus.film_z) : stopped;
}

Numbers first_order_numbers(const Lens& lens) {
  Numbers found;
  const FirstOrder data = first_order(lens);
  const Pupils p = pupils(lens);
  for (const double x :
       {data.effective_focal_length, data.rear_focal_z, data.petzval_sum, p.entrance.z, p.entrance.diameter, p.exit.z,
        p.exit.diameter, static_cast<double>(p.stop), paraxial_f_number(lens), real_f_number(lens), lens.film_z()}) {
    found.push_back(x);
  }
  for (const LensSurface& surface : lens.surfaces()) found.push_back(surface.semi_diameter);
  const AimedRay chief = chief_ray(lens, {off_axis, -3000});
  found.insert(found.end(), {chief.end.ray.origin.y, chief.end.ray.direction.y, static_cast<double>(chief.status)});
  found.push_back(film_irradiance(lens, {}));
  return found;
}

/// Rays of a small film at the primary wavelength and at each line, and results of other camera functions with default
/// options.
std::optional<Numbers> camera_numbers(const Lens& lens) {
  std::optional<Camera> camera;
  try {
    camera.emplace(lens, Film{.width_mm = 3, .height_mm = 2, .columns = 30, .rows = 20});
  } catch (const Error&) {
    return {};
  }
  Numbers found;
  const auto say = [&](const CameraSample& sample) {
    const CameraRay r = camera->sample(sample);
    found.insert(found.end(), {r.ray.origin.x, r.ray.origin.y, r.ray.direction.x, r.ray.direction.y, r.weight,
                               static_cast<double>(r.fate)});
  };
  for (const double u : {0.1, 0.55, 0.8}) {
    const CameraSample sample{.film = {0.7, -0.6}, .pupil_u = u, .pupil_v = 0.3 + 0.6 * u};
    say(sample);
    for (const double nm : lines_nm) {
      CameraSample coloured = sample;
      coloured.wavelength = lens.wavelength_index(Wavelength::nm(nm));
      say(coloured);
    }
  }
  const Vec3<double> point{100, 50, -3000};
  const Projection seen = camera->project(point);
  const ImportanceSample towards = camera->sample_importance(point, 0.3, 0.6);
  found.insert(found.end(), {seen.film.x, seen.film.y, towards.importance.we, towards.direction.x,
                             camera->pdf_importance(point, towards.direction)});
  return found;
}

/// Samples, transmitted rays and image by wavelength, in the order of lines_nm.
struct Picture {
  std::array<double, 3> area{};
  std::array<std::uint64_t, 3> transmitted{};
  std::array<std::vector<std::uint64_t>, 3> counts;
  double entrance_area = 0;
};

Picture picture(const Lens& lens) {
  const auto image = point_image(lens, {off_axis, -3000}, {.samples = 512, .pixels = 8, .half_width_mm = 0.5});
  Picture result{.counts = {}, .entrance_area = image.entrance_pupil_area};
  for (std::size_t line = 0; line < 3; ++line) {
    const std::size_t w = lens.wavelength_index(Wavelength::nm(lines_nm[line]));
    result.area[line] = image.sampled_area[w];
    result.transmitted[line] = image.transmitted[w];
    const auto begin = image.counts.begin() + static_cast<std::ptrdiff_t>(64 * w);
    result.counts[line].assign(begin, begin + 64);
  }
  return result;
}

/// Number of hits in different pixels of two images. The centre of the images is a mean over wavelengths, whose last
/// bit depends on the order.
std::uint64_t moved(const Picture& a, const Picture& b) {
  std::uint64_t result = 0;
  for (std::size_t line = 0; line < 3; ++line) {
    for (std::size_t i = 0; i < 64; ++i) {
      const std::uint64_t n = a.counts[line][i], m = b.counts[line][i];
      result += n > m ? n - m : m - n;
    }
  }
  return result;
}

TEST(WavelengthOrder, ChangesNoResult) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const CompileOptions options{.glasses = &glasses, .missing_glass = MissingGlass::abbe};
  int compiled = 0, limited = 0, cameras = 0;
  for (const Prescription& prescription : testing::data_prescriptions()) {
    std::array<double, 3> order = lines_nm;  // ascending: the first of all permutations
    std::optional<Numbers> wanted, wanted_rays;
    std::optional<Picture> wanted_picture;
    do {
      std::optional<Lens> lens;
      try {
        lens = compile(prescription, order, options);
      } catch (const Error&) {
        break;
      }
      const bool first = !wanted;
      compiled += first;
      const Lens& whole = *lens;
      EXPECT_EQ(order[whole.primary_wavelength()], d_line_nm) << whole.name();
      if (!has_pupils(whole)) {
        wanted.emplace();
        continue;
      }
      limited += first;
      const Lens ready = set(whole);
      const Numbers numbers = first_order_numbers(ready);
      const auto rays = camera_numbers(ready);
      const Picture seen = picture(ready);
      if (first) {
        wanted = numbers, wanted_rays = rays, wanted_picture = seen;
        cameras += rays.has_value();
        continue;
      }
      const std::string where = whole.name() + ", primary at " + std::to_string(whole.primary_wavelength());
      EXPECT_EQ(bits(numbers), bits(*wanted)) << where;
      ASSERT_EQ(rays.has_value(), wanted_rays.has_value()) << where;
      if (rays) {
        EXPECT_EQ(bits(*rays), bits(*wanted_rays)) << where;
      }
      EXPECT_EQ(seen.area, wanted_picture->area) << where;
      EXPECT_EQ(seen.transmitted, wanted_picture->transmitted) << where;
      EXPECT_EQ(seen.entrance_area, wanted_picture->entrance_area) << where;
      EXPECT_LE(moved(seen, *wanted_picture), 8u) << where;
    } while (std::next_permutation(order.begin(), order.end()));
  }
  EXPECT_EQ(compiled, 66);
  EXPECT_GE(limited, 60);
  EXPECT_GE(cameras, 50);
}

}  // namespace wavelength_order_test
}  // namespace petzval
