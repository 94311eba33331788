// SPDX-License-Identifier: Apache-2.0
// The text of an OSL camera is converted to C++ by a few replacements and compiled; its rays are compared with the
// library.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/exports/renderer_cameras.hpp"
#include "petzval/focus/focus.hpp"
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
void put(Triple t) { std::printf("%.9g %.9g %.9g ", t[0], t[1], t[2]); }
int main() {
  float w, h, focus, f_number, roundness, rotation, units;
  int blades;
  if (std::scanf("%f %f %f %f %d %f %f %f", &w, &h, &focus, &f_number, &blades, &roundness, &rotation, &units) != 8) return 1;
  by_column = Triple(1.0f / 1920, 0, 0);
  by_row = Triple(0, 1.0f / 1280, 0);
  float x, y, u, v;
  while (std::scanf("%f %f %f %f", &x, &y, &u, &v) == 4) {
    raster_position = Triple(x, y, 0);
    random_sample = Triple(u, v, 0);
    Triple p, d, c(1), dpx, dpy, ddx, ddy;
    petzval_camera(w, h, focus, f_number, blades, roundness, rotation, units, p, d, c, dpx, dpy, ddx, ddy);
    for (const Triple& t : {p, d, c, dpx, ddx, dpy, ddy}) put(t);
    std::puts("");
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
/// Outputs of the shader; `by` holds the derivatives of position and direction by the pixels of a row and of a column.
struct Found {
  double p[3], d[3], c[3], by[2][2][3];
};

/// True if there is no compiler, so that tests are skipped.
bool no_compiler() { return std::system("c++ --version > /dev/null 2>&1") != 0; }

/// The compiled shader of a lens.
class Shader {
 public:
  explicit Shader(const Lens& lens) : Shader(petzval::format_osl_camera(lens)) {}
  explicit Shader(const std::string& osl) {
    static int count = 0;
    folder_ = fs::path(::testing::TempDir()) / ("osl_" + std::to_string(::getpid()) + "_" + std::to_string(++count));
    fs::create_directories(folder_);
    petzval::write_file(as_cpp(osl) + driver, folder_ / "shader.cpp");
    fs::copy_file(fs::path(PETZVAL_OSL_HOST), folder_ / "host.hpp", fs::copy_options::overwrite_existing);
    EXPECT_EQ(in_folder("c++ -std=c++17 -Werror -Wno-unused -o shader shader.cpp"), 0) << osl;
  }
  Shader(const Shader&) = delete;
  ~Shader() { fs::remove_all(folder_); }

  std::vector<Found> run(const Setting& s, const std::vector<Sample>& samples) const {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(9);
    text << s.width << ' ' << s.height << ' ' << s.focus << ' ' << s.f_number << ' ' << s.blades << ' ' << s.roundness
         << ' ' << s.rotation << ' ' << s.units << '\n';
    for (const Sample& sample : samples)
      text << sample.x << ' ' << sample.y << ' ' << sample.u << ' ' << sample.v << '\n';
    petzval::write_file(text.str(), folder_ / "in");
    EXPECT_EQ(in_folder("./shader < in > out"), 0);
    std::vector<Found> found(samples.size());
    std::ifstream lines(folder_ / "out");
    for (Found& f : found) {
      for (auto* triple : {f.p, f.d, f.c, f.by[0][0], f.by[0][1], f.by[1][0], f.by[1][1]}) {
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(lines >> triple[i]);
      }
    }
    return found;
  }

 private:
  int in_folder(const std::string& command) const {
    return std::system(("cd '" + folder_.string() + "' && " + command).c_str());
  }
  fs::path folder_;
};

std::vector<Sample> random_samples(std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Sample> samples(count);
  for (Sample& s : samples) s = {unit(random), unit(random), unit(random), unit(random)};
  return samples;
}

double origin_of(const Lens& lens) { return petzval::pupils(lens, {}, petzval::main_meridian(lens)).entrance.z; }

/// The lens of the shader: focused from its origin, stopped down.
Lens set(const Lens& lens, const Setting& s) {
  return petzval::with_focus(petzval::with_f_number(lens, s.f_number), s.focus / s.units - origin_of(lens));
}

/// A ray of the shader in the lens frame (mm), towards the film, and its derivatives. Cycles looks along +z: the lens
/// frame has the scene at -z.
petzval::Ray<double> towards_film(const double p[3], const double d[3], double origin, double units) {
  return {{p[0] / units, p[1] / units, origin - p[2] / units}, {-d[0], -d[1], d[2]}};
}

/// The point of a ray at a z, or its derivative by a parameter of which the ray has the derivative `by`.
petzval::Vec3<double> at_z(const petzval::Ray<double>& ray, double z) {
  return ray.origin + (z - ray.origin.z) / ray.direction.z * ray.direction;
}
petzval::Vec3<double> at_z(const petzval::Ray<double>& ray, const petzval::Ray<double>& by, double z) {
  const double t = (z - ray.origin.z) / ray.direction.z;
  const petzval::Vec3<double> moved = by.origin + t * by.direction;
  return moved - moved.z / ray.direction.z * ray.direction;
}

template <class T>
petzval::RayArrays<T> arrays(petzval::Ray<double>& ray) {
  auto& [at, to] = ray;
  return {&at.x, &at.y, &at.z, &to.x, &to.y, &to.z};
}

/// Chances of the wavelengths: the sizes of their colours.
std::vector<double> chance_ends(const std::vector<std::array<double, 3>>& rgb) {
  std::vector<double> ends;
  for (const auto& c : rgb)
    ends.push_back((ends.empty() ? 0 : ends.back()) + std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]));
  for (double& end : ends) end /= ends.back();
  return ends;
}
std::vector<std::array<double, 3>> colours_of(const Lens& lens) {
  const fs::path tables = fs::path(PETZVAL_TEST_DATA) / "glass";
  const auto daylight = petzval::illuminant("D65", tables / "cie_daylight_10nm.csv");
  return petzval::rgb_weights(lens.wavelengths_nm(), petzval::ColourMatching::load(tables / "cie1931_2deg_5nm.csv"),
                              daylight, daylight);
}

/// The largest deviations of the rays and of their derivatives.
struct Deviation {
  std::size_t passed = 0;
  double film_mm = 0;  ///< of the traced ray from the film point of its sample
  double pixels = 0;   ///< of the derivatives of the film point and of the point in the plane of the last vertex
};

/// Traces each transmitted ray of the shader, with its derivatives, back to the film point of its sample.
Deviation deviation_of(const Lens& lens, const Shader& shader, const Setting& s, std::size_t count) {
  const auto samples = random_samples(count);
  const auto found = shader.run(s, samples);
  const double origin = origin_of(lens);
  const Lens own = set(lens, s);
  const auto colours = colours_of(lens);
  const auto ends = chance_ends(colours);
  Deviation result;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Found& f = found[i];
    if (f.c[0] == 0 && f.c[1] == 0 && f.c[2] == 0) continue;
    ++result.passed;
    EXPECT_NEAR(std::hypot(f.d[0], f.d[1], f.d[2]), 1, 1e-5);
    // A sample very near the end of a chance may have either wavelength.
    const auto chosen = std::ranges::find_if(ends, [&](double end) { return samples[i].u < end; });
    if (std::abs(samples[i].u - *chosen) < 1e-6) continue;
    const auto wavelength = static_cast<std::size_t>(chosen - ends.begin());
    const auto& [r, g, b] = colours[wavelength];
    const petzval::Vec3<double> throughput{f.c[0], f.c[1], f.c[2]}, colour{r, g, b};
    EXPECT_LT(glm::length(glm::cross(throughput, colour)), 1e-5 * glm::length(throughput) * glm::length(colour));
    auto ray = towards_film(f.p, f.d, origin, s.units);
    petzval::Ray<double> by[2], end, by_end[2];
    for (int k = 0; k < 2; ++k) {
      by[k] = towards_film(f.by[k][0], f.by[k][1], 0, s.units);
      const double along = glm::dot(by[k].direction, ray.direction);
      EXPECT_NEAR(along, 0, 1e-6);
      by[k].direction = by[k].direction - along * ray.direction;
    }
    petzval::RayFate fate{};
    petzval::trace_differentials<double>(own, 1, arrays<const double>(ray),
                                         {arrays<const double>(by[0]), arrays<const double>(by[1])},
                                         arrays<double>(end), {arrays<double>(by_end[0]), arrays<double>(by_end[1])},
                                         &fate, nullptr, {.wavelengths = {.all = wavelength}});
    if (fate != petzval::RayFate::transmitted) continue;  // at a rim, by rounding
    const auto at = at_z(end, own.film_z());
    result.film_mm = std::max({result.film_mm, std::abs(at.x - (0.5 - samples[i].x) * s.width),
                               std::abs(at.y - (0.5 - samples[i].y) * s.height)});
    for (int k = 0; k < 2; ++k) {
      const double pixel = k == 0 ? s.width / 1920 : s.height / 1280;
      const auto film = at_z(end, by_end[k], own.film_z());
      const auto last = at_z(end, by_end[k], own.surfaces().back().vertex_z);
      for (const double off : {(k == 0 ? film.x : film.y) + pixel, k == 0 ? film.y : film.x, last.x, last.y})
        result.pixels = std::max(result.pixels, std::abs(off) / pixel);
    }
  }
  return result;
}

void expect_rays_of(const Lens& lens, const Shader& shader, const Setting& s, double tolerance_mm) {
  const Deviation found = deviation_of(lens, shader, s, 4000);
  EXPECT_GT(found.passed, 400u) << lens.name();
  EXPECT_LT(found.film_mm, tolerance_mm) << lens.name();
  EXPECT_GT(found.film_mm, 0) << lens.name();
  EXPECT_LT(found.pixels, 0.001) << lens.name();
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
  if (no_compiler()) GTEST_SKIP() << "no compiler";
  const Lens lens = petzval::compile(floating());
  ASSERT_FALSE(lens.focus_positions().empty());
  expect_rays_of(lens, Shader(lens), {.focus = 2, .f_number = 2.8}, 0.02);
}

/// The mean throughput of a raster position, over equally spread random numbers.
std::array<double, 3> mean_throughput(const Shader& shader, const Setting& s, float x, float y) {
  std::vector<Sample> samples(20'000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double at = static_cast<double>(i), v = at * std::numbers::phi;
    samples[i] = {x, y, static_cast<float>((at + 0.5) / 20'000), static_cast<float>(v - std::floor(v))};
  }
  std::array<double, 3> mean{};
  for (const Found& f : shader.run(s, samples))
    for (std::size_t k = 0; k < 3; ++k) mean[k] += f.c[k] / static_cast<double>(samples.size());
  return mean;
}

/// Compares mean throughputs with the irradiances of all wavelengths in their colours.
void expect_mean_throughput(const Lens& lens, const Shader& shader, const Setting& s) {
  const auto colours = colours_of(lens);
  const Lens own = set(lens, s);
  for (const auto& [x, y] : {std::pair(0.5f, 0.5f), std::pair(0.75f, 0.6f), std::pair(0.95f, 0.95f)}) {
    const auto mean = mean_throughput(shader, s, x, y);
    const petzval::FilmPoint point{(0.5 - x) * s.width, (0.5 - y) * s.height};
    for (std::size_t k = 0; k < 3; ++k) {
      double colour = 0;
      for (std::size_t w = 0; w < colours.size(); ++w)
        colour += colours[w][k] * petzval::film_irradiance(own, point, w);
      EXPECT_NEAR(mean[k], colour / petzval::film_irradiance(own, {}), 0.022) << lens.name() << ' ' << x << ' ' << k;
    }
  }
}

TEST(OslCamera, MeanThroughputIsRelativeIrradiance) {
  if (no_compiler()) GTEST_SKIP() << "no compiler";
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const Shader shader(lens);
  for (const double f_number : {1.4, 2.3, 5.6})
    expect_mean_throughput(lens, shader, {.focus = 2, .f_number = f_number});
}

TEST(OslCamera, CylindersInXAndYEqualTheLens) {
  if (no_compiler()) GTEST_SKIP() << "no compiler";
  petzval::Prescription p = petzval::testing::data_prescription("anamorphic_60mm_2x");
  for (const petzval::Section section : {petzval::Section::x, petzval::Section::y}) {
    for (auto& row : p.surfaces)
      if (row.curved_in != petzval::Section::both) row.curved_in = section;
    const Lens lens = petzval::compile(p);
    const Shader shader(lens);
    const Setting s{.width = 22, .height = 18, .focus = 4, .f_number = 4};
    expect_rays_of(lens, shader, s, 0.01);
    expect_mean_throughput(lens, shader, s);
  }
}

TEST(OslCamera, RaysAndColoursOfWavelengthsEqualTheLens) {
  if (no_compiler()) GTEST_SKIP() << "no compiler";
  petzval::Prescription p = petzval::testing::data_prescription("double_gauss_100mm_f1.35");
  const Setting s{.focus = 2, .f_number = 2};
  const Lens lens = petzval::compile(p, std::array{440.0, 480.0, 520.0, 560.0, 600.0, 660.0});
  const Shader shader(lens);
  expect_rays_of(lens, shader, s, 0.01);
  expect_mean_throughput(lens, shader, s);
  for (auto& row : p.surfaces) row.medium = {.nd = row.medium.nd.value_or(1), .vd = 0};  // no dispersion
  const Shader white(petzval::compile(p, std::array{440.0, 550.0, 660.0}));
  for (const double mean : mean_throughput(white, s, 0.5f, 0.5f)) EXPECT_NEAR(mean, 1, 0.01);
}

TEST(OslCamera, PixelsInThePlaneOfFocusEqualTheCamera) {
  if (no_compiler()) GTEST_SKIP() << "no compiler";
  const Lens lens = data_lens("double_gauss_52mm_f1.8");
  const Setting s{.focus = 3, .f_number = 11};
  const Lens own = set(lens, s);
  const petzval::Film film{.width_mm = s.width, .height_mm = s.height, .columns = 1920, .rows = 1280};
  const petzval::Camera camera(own, film, {.model = petzval::ModelKind::exact_double});
  const double origin = origin_of(lens), z = origin - s.focus / s.units;
  const auto samples = random_samples(400);
  const auto found = Shader(lens).run(s, samples);
  std::size_t passed = 0;
  double worst = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto by =
        camera.sample_differential({.film = {(0.5 - samples[i].x) * s.width, (0.5 - samples[i].y) * s.height},
                                    .pupil_u = samples[i].u,
                                    .pupil_v = samples[i].v});
    if (found[i].c[0] == 0 || !by.sample) continue;
    ++passed;
    const auto raster = petzval::by_raster(by, film);
    for (int k = 0; k < 2; ++k) {
      const auto& [p, d] = found[i].by[k];
      const auto own_pixel =
          at_z(towards_film(found[i].p, found[i].d, origin, s.units), towards_film(p, d, 0, s.units), z);
      // Raster y of Cycles runs upwards.
      const auto pixel = at_z(by.sample.ray, raster[static_cast<std::size_t>(k)], z) * (k == 0 ? 1.0 : -1.0);
      worst = std::max(worst, glm::length(own_pixel - pixel) / glm::length(pixel));
    }
  }
  EXPECT_GT(passed, 100u);
  EXPECT_LT(worst, 0.01);
}

TEST(OslCamera, BladesEqualTheIris) {
  if (no_compiler()) GTEST_SKIP() << "no compiler";
  const Lens lens = data_lens("double_gauss_52mm_f1.8");
  const Shader shader(lens);
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
    const auto found = shader.run(s, samples);
    const Lens own = petzval::with_iris(set(lens, s), iris);
    const double origin = origin_of(lens);
    std::size_t passed = 0, clipped = 0;
    double sum = 0;
    for (const Found& f : found) {
      sum += f.c[0];
      if (f.c[0] == 0) continue;
      ++passed;
      clipped += petzval::trace(own, towards_film(f.p, f.d, origin, s.units)).transmitted() ? 0 : 1;
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
  expect_tokens(refusal(petzval::compile(petzval::testing::open_singlet())), {"stop"});
  // Distant subjects are in focus within the travel that the stop leaves.
  petzval::Prescription behind;
  behind.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12},
                     {.radius = -50, .thickness = 48, .semi_diameter = 12},
                     {.thickness = 60, .semi_diameter = 6, .stop = true}};
  expect_tokens(refusal(petzval::compile(behind)), {"subject", "inf mm"});
}

/// The defaults of the parameters in a shader.
Setting defaults_of(const std::string& osl) {
  const auto value = [&](const std::string& name) {
    return std::stod(osl.substr(osl.find(name + " = ") + name.size() + 3));
  };
  return {value("sensor_width"), value("sensor_height"), value("focus_distance"), value("f_number")};
}

TEST(OslCamera, EveryLensOfTheGuideEqualsTheLibrary) {
  const bool compiles = !no_compiler();
  std::size_t taken = 0;
  std::string rows;
  for (const auto& p : petzval::testing::data_prescriptions()) {
    const Lens lens = petzval::compile(p);
    std::string osl;
    const std::string refusal = petzval::testing::message([&] { osl = petzval::format_osl_camera(lens); });
    if (osl.empty()) {
      rows += "| `" + p.id + "` | " + refusal.substr(lens.name().size() + 2) + " |\n";
      continue;
    }
    ++taken;
    if (!compiles) continue;
    Setting far = defaults_of(osl), between = far;
    far.focus = std::numeric_limits<double>::infinity(), between.f_number *= 1.2;
    const Shader shader(osl);
    const auto first = petzval::first_order(lens, {}, petzval::main_meridian(lens));
    const double focal_length = std::abs(first.effective_focal_length);
    const Deviation tabulated = deviation_of(lens, shader, far, 1000),
                    other = deviation_of(lens, shader, between, 1000);
    EXPECT_GT(tabulated.passed, 300u) << p.id;
    EXPECT_LT(tabulated.film_mm, 1e-5 * focal_length) << p.id;
    EXPECT_LT(tabulated.pixels, 2e-4) << p.id;
    EXPECT_LT(other.film_mm, (p.id == "cylinder_3.9mm" ? 0.04 : 2e-3) * focal_length) << p.id;
    EXPECT_LT(other.pixels, p.id == "cylinder_3.9mm" ? 0.1 : 5e-3) << p.id;
  }
  rows += "| the other " + std::to_string(taken) + " | taken |\n";
  const std::string page = petzval::read_file(fs::path(PETZVAL_TEST_DATA).parent_path() / "examples/hosts/README.md");
  EXPECT_NE(page.find(rows), std::string::npos) << rows;
}

TEST(OslCamera, CompilesIfACompilerIsInstalled) {
  if (std::system("oslc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "oslc is not installed";
  const fs::path file = fs::path(::testing::TempDir()) / "camera.osl";
  petzval::write_file(petzval::format_osl_camera(data_lens("modern_50mm_f1.0")), file);
  EXPECT_EQ(std::system(("oslc -o /dev/null '" + file.string() + "'").c_str()), 0);
}

}  // namespace osl_camera_test
