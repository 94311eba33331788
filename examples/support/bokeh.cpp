// SPDX-License-Identifier: Apache-2.0
#include "bokeh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>

#include "camera_setup.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/image/psf.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "text.hpp"

namespace examples {
namespace {

constexpr double right_angle = std::numbers::pi / 2;

/// True if z lies in front of the whole first surface, even if that surface bulges forward.
bool in_front(const petzval::Lens& lens, double z) {
  try {
    petzval::scene_point(lens, {.z = z});
    return true;
  } catch (const petzval::Error&) {
    return false;
  }
}

/// @throws petzval::Error  if the light is not in front of the lens; the message gives the least distance
void check_light(const petzval::Lens& lens, const BokehSetup& setup, double origin_z) {
  if (in_front(lens, origin_z - setup.light_mm)) {
    const double focal_length =
        std::abs(petzval::first_order(lens, {}, petzval::main_meridian(lens)).effective_focal_length);
    if (setup.light_mm < 0.2 * focal_length) {
      note("a light " + number(setup.light_mm) + " mm from the " + in_words(setup.focus.origin) +
           "; lengths are in mm: " + number(setup.light_mm) + " m = " + number(1000 * setup.light_mm) + " mm");
    }
    return;
  }
  petzval::scene_point(lens, {.z = -std::numeric_limits<double>::infinity()});  // throws if the lens has no pupil
  double behind_mm = setup.light_mm, in_front_mm = std::max(1.0, behind_mm);
  while (!in_front(lens, origin_z - in_front_mm)) in_front_mm *= 2;
  while (in_front_mm - behind_mm > 1e-7 * in_front_mm) {
    const double middle = (in_front_mm + behind_mm) / 2;
    (in_front(lens, origin_z - middle) ? in_front_mm : behind_mm) = middle;
  }
  throw petzval::Error(lens.name() + ": light " + number(setup.light_mm) + " mm from the " +
                       in_words(setup.focus.origin) + "; must be in front of the lens, more than " +
                       number(in_front_mm, 6) + " mm away");
}

/// A light at a field of 90 degrees or more, at a distance along its ray from the entrance pupil.
/// @throws petzval::Error  if the light is not outside the lens
petzval::FieldPoint light_beside(const petzval::Lens& lens, const BokehSetup& setup) {
  // No plane of z holds a point at 90 degrees; the next field has one.
  const double field = std::copysign(std::max(std::abs(setup.field_rad), right_angle + 1e-9), setup.field_rad);
  const double pupil_z = petzval::pupils(lens, lens.primary_wavelength()).entrance.z;
  const petzval::FieldPoint light{field, pupil_z - setup.light_mm * std::cos(field)};
  try {
    petzval::scene_point(lens, light);
  } catch (const petzval::Error&) {
    throw petzval::Error("--at = " + number(setup.light_mm) + " mm along the ray at " +
                         number(petzval::degrees(setup.field_rad)) + " degrees; must be outside the lens");
  }
  return light;
}

}  // namespace

BokehScene focused_scene(const petzval::Lens& lens, double focus_mm, const BokehSetup& setup) {
  const petzval::Lens focused = for_flag("--focus", [&] { return petzval::with_focus(lens, focus_mm, setup.focus); });
  if (std::isfinite(setup.light_mm) && std::abs(setup.field_rad) >= right_angle) {
    return {focused, light_beside(focused, setup)};
  }
  const double from_z = origin_z(focused, setup.focus.origin);
  check_light(lens, setup, from_z);
  return {focused, {setup.field_rad, from_z - setup.light_mm}};
}

petzval::Camera camera_of(const BokehScene& scene, petzval::CameraOptions options) {
  constexpr double half_of_36 = 18, max_side_mm = 1e4;  // mm
  constexpr std::uint32_t trial_samples = 1 << 10;
  const double rate_per_mm = options.bokeh.rate_of_change / half_of_36;
  const petzval::ScenePoint light = petzval::scene_point(scene.lens, scene.light);
  const auto exact = petzval::point_image(scene.lens, scene.light, {.samples = trial_samples}).size;
  double side = 1 + 2.2 * (std::hypot(exact.centroid.x, exact.centroid.y) + exact.max_radius);
  for (; side <= max_side_mm; side *= 2) {
    options.bokeh.rate_of_change = rate_per_mm * side / 2;
    const petzval::Camera camera(scene.lens, {.width_mm = side, .height_mm = side}, options);
    bool holds = true;
    for (std::uint32_t i = 0; i < trial_samples && holds; ++i) {
      const petzval::Vec2<double> at = petzval::owen_sobol(i, 0);
      const auto s = light.at_infinity ? camera.sample_distant_importance(-light.position, at.x, at.y)
                                       : camera.sample_importance(light.position, at.x, at.y);
      holds = s.importance.fate != petzval::RayFate::outside_film;
    }
    if (holds) return camera;
  }
  throw petzval::Error(scene.lens.name() + ": the image by model " + std::string(petzval::name(options.model)) +
                       " does not fit on a film of " + number(max_side_mm / 1000) + " m");
}

petzval::Spectrum white_light(const std::string& white_point) {
  if (white_point.ends_with(".csv")) return petzval::Spectrum::load(white_point);
  const std::array<std::string_view, 4> names{"D65", "D50", "A", "E"};
  if (std::find(names.begin(), names.end(), white_point) == names.end()) {
    throw petzval::Error("--white-point = \"" + white_point + "\"; must be D65, D50, A, E or a file.csv");
  }
  return petzval::illuminant(white_point, petzval::data_directory() / "glass" / "cie_daylight_10nm.csv");
}

void add_white_point(App& app, std::string& white_point) {
  app.add_option("--white-point", white_point,
                 "spectrum of the light, shown as white: D65 or D50 (daylight), A (tungsten), E (equal power), or a "
                 "file.csv of wavelength_nm,power; a single wavelength is always shown as white")
      ->type_name("NAME|FILE.csv")
      ->capture_default_str();
}

std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm, const petzval::Spectrum& light) {
  const auto file = petzval::data_directory() / "glass" / "cie1931_2deg_5nm.csv";
  return petzval::rgb_weights(wavelengths_nm, petzval::ColourMatching::load(file), light, light);
}

petzval::RgbImage irradiance(const petzval::Psf& psf, const petzval::Spectrum& light) {
  return petzval::render(psf, rgb_weights(psf.wavelengths_nm, light));
}

petzval::RgbImage irradiance(const petzval::DiffractionPsf& psf, const petzval::Spectrum& light) {
  return petzval::render(psf, rgb_weights(psf.wavelengths_nm, light));
}

double irradiance_on_axis(const petzval::Camera& camera) {
  constexpr std::uint32_t count = 4096;
  double sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto pupil = petzval::owen_sobol(i, 0);
    sum += camera.sample({.film = {0, 0}, .pupil_u = pupil.x, .pupil_v = pupil.y}).weight / count;
  }
  if (!(sum > 0)) throw petzval::Error(camera.lens().name() + ": no light reaches the axis");
  return sum;
}

petzval::RgbImage ghost_picture(const petzval::Lens& lens, const petzval::ScenePoint& light, const petzval::Film& film,
                                std::span<const std::array<double, 3>> weights, const petzval::GhostOptions& options) {
  petzval::RgbImage image(film.columns, film.rows);
  const std::size_t pixels = image.pixels.size() / 3;
  std::vector<petzval::Wavelength> wavelengths;
  for (std::size_t w = 0; w < weights.size(); ++w) {
    if (weights[w] != std::array<double, 3>{}) wavelengths.emplace_back(w);
  }
  std::vector<float> planes(pixels * wavelengths.size());
  petzval::add_ghosts(lens, light, film, wavelengths, planes, options);
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    const auto& weight = weights[wavelengths[w].index(0)];
    for (std::size_t i = 0; i < 3 * pixels; ++i) {
      image.pixels[i] += static_cast<float>(weight[i % 3]) * planes[w * pixels + i / 3];
    }
  }
  return image;
}

Exposed expose(const petzval::RgbImage& image, double exposure) {
  std::vector<float> lit;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    const float brightest = std::max({image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]});
    if (brightest > 0) lit.push_back(brightest);
  }
  if (lit.empty()) return {petzval::to_srgb8(image), 0};
  const auto rank = lit.begin() + static_cast<std::ptrdiff_t>((lit.size() - 1) * 99 / 100);
  std::nth_element(lit.begin(), rank, lit.end());
  const float white = static_cast<float>(*rank / exposure);
  if (exposure <= 1) return {petzval::to_srgb8(image, 1 / white), white};
  petzval::RgbImage faded = image;
  for (std::size_t i = 0; i < faded.pixels.size(); i += 3) {
    const std::span pixel(&faded.pixels[i], 3);
    const float luminance = 0.2126f * pixel[0] + 0.7152f * pixel[1] + 0.0722f * pixel[2];
    if (luminance <= white) continue;
    for (float& value : pixel) value = luminance + (value - luminance) * white / luminance;
  }
  return {petzval::to_srgb8(faded, 1 / white), white};
}

std::string focus_caption(double focus_mm) {
  return std::isinf(focus_mm) ? "focus infinity" : "focus " + number(focus_mm) + " mm";
}

namespace {

/// At least three digits, without an exponent.
std::string short_number(double value) { return value < 100 ? number(value, 3) : number(std::round(value)); }

}  // namespace

Tile bokeh_tile(double focus_mm, const petzval::Psf& image, Exposed exposed) {
  std::vector<std::string> captions{focus_caption(focus_mm)};
  if (image.mean_throughput > 0) {
    captions.push_back("radius " + short_number(image.size.max_radius) + " mm");
    captions.push_back("RMS " + short_number(image.size.rms_radius) + " mm");
  } else {
    captions.emplace_back("no light passes");
  }
  captions.push_back("white " + short_number(exposed.white_per_mm2) + " / mm²");
  return {std::move(exposed.picture), std::move(captions), image.pixels * image.pixel_mm};
}

std::vector<std::string> bokeh_notes() {
  return {
      "Radius: largest distance of a ray from the centroid. Tiles of a row have the same film scale and their own "
      "exposure.",
      "White: 99th percentile of the lit pixels, as a fraction of the light in the entrance pupil, per mm² of film."};
}

}  // namespace examples
