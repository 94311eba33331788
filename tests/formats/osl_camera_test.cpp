// SPDX-License-Identifier: Apache-2.0
// The text of an OSL camera is converted to C++ by a few replacements and compiled; its rays are compared with the
// library.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/formats/osl_camera.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/trace/trace.hpp"

namespace osl_camera_test {

namespace fs = std::filesystem;
using petzval::Lens;
using petzval::testing::data_lens;
using petzval::testing::expect_tokens;

/// The shader as a function, without metadata and defaults of parameters; outputs become references.
std::string as_cpp(const std::string& osl) {
  const std::size_t start = osl.find("shader petzval_camera("), end = osl.find("{\n", start);
  std::string parameters = osl.substr(start, end - start);
  parameters = std::regex_replace(parameters, std::regex(R"(\[\[[^\]]*\]\])"), "");
  parameters = std::regex_replace(parameters, std::regex(R"( = [-0-9.e+]+)"), "");
  parameters = std::regex_replace(parameters, std::regex(R"(output (point|vector|color) )"), "$1& ");
  parameters = std::regex_replace(parameters, std::regex("shader"), "void");
  // Numbers are floats.
  return std::regex_replace("#include \"host.hpp\"\n" + parameters + osl.substr(end),
                            std::regex(R"(([0-9]\.[0-9]*(e[-+]?[0-9]+)?))"), "$1f");
}

constexpr const char* driver = R"(
#include <cstdio>
int main() {
  float w, h, focus, f_number, roundness, rotation, units;
  int blades;
  if (std::scanf("%f %f %f %f %d %f %f %f", &w, &h, &focus, &f_number, &blades, &roundness, &rotation, &units) != 8) return 1;
  float x, y, u, v;
  while (std::scanf("%f %f %f %f", &x, &y, &u, &v) == 4) {
    raster_position = Triple(x, y, 0);
    random_sample = Triple(u, v, 0);
    point p;
    vector d;
    color c(1);
    petzval_camera(w, h, focus, f_number, blades, roundness, rotation, units, p, d, c);
    std::printf("%.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", p[0], p[1], p[2], d[0], d[1], d[2], c[0]);
  }
}
)";

struct Setting {
  double width = 36, height = 24, focus = 3, f_number = 2;
  int blades = 0;
  double roundness = 0, rotation = 0, units = 0.001;
};
struct Sample {
  float x, y, u, v;
};
struct Found {
  double p[3], d[3], c;
};

/// Rays of the compiled shader of a lens; empty if there is no compiler.
std::vector<Found> run(const Lens& lens, const Setting& s, const std::vector<Sample>& samples) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("osl_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const fs::path source = folder / "shader.cpp", program = folder / "shader", in = folder / "in", out = folder / "out";
  petzval::write_file(as_cpp(petzval::format_osl_camera(lens)) + driver, source);
  fs::copy_file(fs::path(PETZVAL_OSL_HOST), folder / "host.hpp", fs::copy_options::overwrite_existing);
  const std::string compile =
      "c++ -std=c++17 -O1 -Werror -Wno-unused -o '" + program.string() + "' '" + source.string() + "'";
  EXPECT_EQ(std::system(compile.c_str()), 0) << source;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << s.width << ' ' << s.height << ' ' << s.focus << ' ' << s.f_number << ' ' << s.blades << ' ' << s.roundness
       << ' ' << s.rotation << ' ' << s.units << '\n';
  for (const Sample& sample : samples)
    text << sample.x << ' ' << sample.y << ' ' << sample.u << ' ' << sample.v << '\n';
  petzval::write_file(text.str(), in);
  EXPECT_EQ(std::system(("'" + program.string() + "' < '" + in.string() + "' > '" + out.string() + "'").c_str()), 0);
  std::vector<Found> found;
  std::ifstream lines(out);
  for (Found f; lines >> f.p[0] >> f.p[1] >> f.p[2] >> f.d[0] >> f.d[1] >> f.d[2] >> f.c;) found.push_back(f);
  EXPECT_EQ(found.size(), samples.size()) << lens.name();
  fs::remove_all(folder);
  return found;
}

std::vector<Sample> random_samples(std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Sample> samples(count);
  for (Sample& s : samples) s = {unit(random), unit(random), unit(random), unit(random)};
  return samples;
}

/// The lens of the shader: focused from its origin, stopped down.
Lens set(const Lens& lens, const Setting& s) {
  const double origin = petzval::pupils(lens).entrance.z;
  return petzval::with_focus(petzval::with_f_number(lens, s.f_number), s.focus / s.units - origin);
}

/// Traces each transmitted ray of the shader back to the film point of its sample.
void expect_rays_of(const Lens& lens, const Setting& s, double tolerance_mm) {
  if (std::system("c++ --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no compiler";
  const auto samples = random_samples(4000);
  const auto found = run(lens, s, samples);
  const double origin = petzval::pupils(lens).entrance.z;
  const Lens own = set(lens, s);
  std::size_t passed = 0;
  double worst = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Found& f = found[i];
    if (f.c == 0) continue;
    ++passed;
    const double length = std::hypot(f.d[0], f.d[1], f.d[2]);
    ASSERT_NEAR(length, 1, 1e-5);
    // Cycles looks along +z: the lens frame has the scene at -z, and light runs to the film.
    const petzval::Vec3<double> at{f.p[0] / s.units, f.p[1] / s.units, origin - f.p[2] / s.units};
    const petzval::Vec3<double> towards{-f.d[0], -f.d[1], f.d[2]};
    const auto end = petzval::trace(own, petzval::Ray<double>{at - towards * 10.0, towards});
    if (!end.transmitted()) continue;  // at a rim, by rounding
    const auto& ray = end.ray;
    const double t = (own.film_z() - ray.origin.z) / ray.direction.z;
    const double x = ray.origin.x + t * ray.direction.x, y = ray.origin.y + t * ray.direction.y;
    worst =
        std::max({worst, std::abs(x - (0.5 - samples[i].x) * s.width), std::abs(y - (0.5 - samples[i].y) * s.height)});
  }
  EXPECT_GT(passed, found.size() / 10) << lens.name();
  EXPECT_LT(worst, tolerance_mm) << lens.name();
  EXPECT_GT(worst, 0) << lens.name();
}

TEST(OslCamera, RaysEqualTheLens) {
  const Setting far{.focus = 1e4, .f_number = 2}, near{.focus = 1, .f_number = 2.8};
  expect_rays_of(data_lens("double_gauss_100mm_f1.35"), {.focus = 3, .f_number = 1.4}, 0.01);
  expect_rays_of(data_lens("double_gauss_100mm_f1.35"), far, 0.01);
  expect_rays_of(data_lens("double_gauss_52mm_f1.8"), near, 0.01);
  expect_rays_of(data_lens("modern_50mm_f1.0"), {.focus = 2, .f_number = 1.2}, 0.01);
  expect_rays_of(data_lens("compact_31mm_f2.1"), {.width = 24, .height = 16, .focus = 1, .f_number = 2.2}, 0.01);
  expect_rays_of(data_lens("phone_5.6mm_f3.5"), {.width = 4, .height = 3, .focus = 1, .f_number = 3.6}, 0.002);
  expect_rays_of(data_lens("fisheye_16mm_f2.8"), {.width = 24, .height = 16, .focus = 1, .f_number = 4}, 0.01);
  expect_rays_of(data_lens("zoom_14-30mm_f4:tele"), {.focus = 1, .f_number = 5.6}, 0.01);
}

/// A lens whose rear group moves to focus.
petzval::Prescription floating() {
  petzval::Prescription p = petzval::testing::data_prescription("double_gauss_52mm_f1.8");
  const int last = static_cast<int>(p.surfaces.size()) - 1;
  const double film = p.surfaces.back().thickness;
  const double gap = p.surfaces[static_cast<std::size_t>(last) - 2].thickness;
  p.configurations = {
      {.name = "infinity"},
      {.name = "1 m",
       .focus_of = "infinity",
       .subject_distance_mm = 1000,
       .changes = {{.surface = last - 2, .thickness = gap + 0.2}, {.surface = last, .thickness = film + 2.8}}}};
  return p;
}

TEST(OslCamera, MovingGroupsMove) {
  const Lens lens = petzval::compile(floating());
  ASSERT_FALSE(lens.focus_positions().empty());
  expect_rays_of(lens, {.focus = 2, .f_number = 2.8}, 0.02);
}

TEST(OslCamera, MeanThroughputIsRelativeIrradiance) {
  if (std::system("c++ --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no compiler";
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  for (const double f_number : {1.4, 2.3, 5.6}) {
    const Setting s{.focus = 2, .f_number = f_number};
    const Lens own = set(lens, s);
    const double middle = petzval::film_irradiance(own, {});
    for (const auto& [x, y] : {std::pair(0.5f, 0.5f), std::pair(0.75f, 0.6f), std::pair(0.95f, 0.95f)}) {
      auto samples = random_samples(40'000, 7);
      for (Sample& sample : samples) sample.x = x, sample.y = y;
      double sum = 0;
      for (const Found& f : run(lens, s, samples)) sum += f.c;
      const petzval::FilmPoint point{(0.5 - x) * s.width, (0.5 - y) * s.height};
      EXPECT_NEAR(sum / 40'000, petzval::film_irradiance(own, point) / middle, 0.02) << f_number << ' ' << x;
    }
  }
}

TEST(OslCamera, BladesEqualTheIris) {
  if (std::system("c++ --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no compiler";
  const Lens lens = data_lens("double_gauss_52mm_f1.8");
  for (const petzval::Iris iris : {petzval::Iris{6, 0, 0.3}, petzval::Iris{5, 0.5, -0.2}, petzval::Iris{9, -0.6, 0},
                                   petzval::Iris{4, -0.5, 0.1}}) {
    const Setting s{.focus = 3,
                    .f_number = 4,
                    .blades = iris.blades,
                    .roundness = iris.roundness,
                    .rotation = petzval::degrees(iris.rotation_rad)};
    auto samples = random_samples(20'000, 3);
    for (Sample& sample : samples)
      sample.x = 0.5f + (sample.x - 0.5f) * 0.2f, sample.y = 0.5f + (sample.y - 0.5f) * 0.2f;
    const auto found = run(lens, s, samples);
    const Lens own = petzval::with_iris(set(lens, s), iris);
    const double origin = petzval::pupils(lens).entrance.z;
    std::size_t passed = 0, clipped = 0;
    double sum = 0;
    for (const Found& f : found) {
      sum += f.c;
      if (f.c == 0) continue;
      ++passed;
      const petzval::Vec3<double> at{f.p[0] / s.units, f.p[1] / s.units, origin - f.p[2] / s.units};
      const petzval::Vec3<double> towards{-f.d[0], -f.d[1], f.d[2]};
      clipped += petzval::trace(own, petzval::Ray<double>{at - towards * 10.0, towards}).transmitted() ? 0 : 1;
    }
    EXPECT_GT(passed, 2000u);
    EXPECT_LT(static_cast<double>(clipped), 0.005 * static_cast<double>(passed)) << iris.blades;
    EXPECT_NEAR(sum / 20'000, 1, 0.04) << iris.blades;  // the centre of the film for any iris
  }
}

TEST(OslCamera, IndependentOfTheLocale) {
  const std::string text = petzval::format_osl_camera(data_lens("double_gauss_100mm_f2.0"));
  EXPECT_EQ(text.find(",0"), std::string::npos);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    EXPECT_LT(end - at, 160u);
    at = end + 1;
  }
}

TEST(OslCamera, RefusesUnsupportedLenses) {
  const auto refusal = [](const Lens& lens) {
    return petzval::testing::message([&] { petzval::format_osl_camera(lens); });
  };
  expect_tokens(refusal(data_lens("mirror_newton_200mm_f8")), {"mirror"});
  expect_tokens(refusal(data_lens("anamorphic_60mm_2x")), {"cylinder"});
  expect_tokens(refusal(petzval::compile(petzval::testing::open_singlet())), {"stop"});
  // Distant subjects are in focus within the travel that the stop leaves.
  petzval::Prescription behind;
  behind.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12},
                     {.radius = -50, .thickness = 48, .semi_diameter = 12},
                     {.thickness = 60, .semi_diameter = 6, .stop = true}};
  expect_tokens(refusal(petzval::compile(behind)), {"subject", "inf mm"});
}

TEST(OslCamera, CompilesIfACompilerIsInstalled) {
  if (std::system("oslc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "oslc is not installed";
  const fs::path file = fs::path(::testing::TempDir()) / "camera.osl";
  petzval::write_file(petzval::format_osl_camera(data_lens("modern_50mm_f1.0")), file);
  EXPECT_EQ(std::system(("oslc -o /dev/null '" + file.string() + "'").c_str()), 0);
}

}  // namespace osl_camera_test
