// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "../camera/camera_samples.hpp"
#include "../declared_radius.hpp"
#include "flood.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval::flood {
namespace {

constexpr std::size_t count = 32768, on_axis = 4096;

const std::vector<Prescription>& lenses() {
  static const auto all = testing::data_prescriptions();
  return all;
}

void check(const testing::Samples<float>& found, double brightest, Counts& counts) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const auto* column : {&found.x, &found.y, &found.z, &found.dx, &found.dy, &found.dz, &found.weights,
                               &found.pdf_pupil, &found.pdf_direction}) {
      counts.fail_unless(std::isfinite((*column)[i]), "a camera ray is finite");
    }
    counts.fail_unless(found.weights[i] >= 0, "a weight is 0 or more");
    ++counts.kinds[std::string(name(found.fates[i]))];
    if (!(found.weights[i] > 0)) continue;
    const double x = found.dx[i], y = found.dy[i], z = found.dz[i], longer = std::abs(x * x + y * y + z * z - 1);
    counts.fail_unless(longer <= 8 * std::numeric_limits<float>::epsilon(), "a camera ray has unit length");
    counts.measure("|d|^2 - 1 in eps of float", longer / std::numeric_limits<float>::epsilon());
  }
  const double mean =
      std::accumulate(found.weights.begin(), found.weights.end(), 0.0) / static_cast<double>(found.size());
  counts.fail_unless(mean <= brightest, "irradiance is at most the irradiance of a half sphere");
  counts.done += found.size();
}

/// Compares the mean weight at the film's centre with the irradiance of the exact lens.
void check_exposure(const Camera& camera, Counts& counts) {
  const double exact = film_irradiance(camera.lens(), {});
  if (!(exact > 0)) return;
  testing::Samples<float> samples;
  for (std::size_t i = 0; i < on_axis; ++i) {
    const double k = static_cast<double>(i);
    samples.add(0, 0, std::fmod(k * std::numbers::phi, 1.0), (k + 0.5) / on_axis);
  }
  samples.run(camera);
  const double mean = std::accumulate(samples.weights.begin(), samples.weights.end(), 0.0) / on_axis;
  counts.measure("light on the axis, deviation from the exact lens", std::abs(mean / exact - 1));
  counts.fail_unless(std::abs(mean / exact - 1) <= 0.01, "light on the axis equals the exact lens within 1 %");
  counts.done += on_axis;
}

}  // namespace

Counts samples(Case& at) {
  Counts counts;
  fuzz::Bytes bytes = at.bytes();
  const Prescription& p = lenses()[static_cast<std::size_t>(at.between(0, static_cast<double>(lenses().size())))];
  const ModelKind model = models()[bytes.byte() % models().size()];
  const int kind = bytes.byte();
  try {
    Lens lens = compile(p, {.missing_glass = MissingGlass::abbe});
    if (kind & 1) lens = with_iris(lens, {.blades = bytes.count(3, 20), .roundness = bytes.between(-1, 1)});
    if (kind & 2) lens = with_f_number(lens, std::exp2(at.between(0, 6)));
    if (kind & 4) lens = with_focus(lens, 1e3 * std::exp2(at.between(0, 10)));
    Film film;
    film.width_mm = film.height_mm = 1.4 * testing::declared_radius(p, lens);
    if (kind % 64 >= 48) film.tilt_rad = at.between(-0.1, 0.1), film.swing_rad = at.between(-0.1, 0.1);
    CameraOptions options{.model = model};
    const bool weighted = kind % 32 >= 24;
    if (weighted) options.bokeh.weight_distribution = at.between(-4, 4), options.bokeh.weight_strength = 1;
    const Camera camera(lens, film, options);

    auto found = testing::random_samples<float>(film, count, static_cast<unsigned>(at.between(0, 1e9)));
    found.run(camera);
    const double n = lens.index(lens.surface_count());
    check(found, 1.01 * std::numbers::pi * n * n, counts);
    // Ball lenses have disconnected pupils, which the tables of these models do not contain
    // (FilmPupilTable::equal_area).
    if (!weighted && film.tilt_rad == 0 && !p.name.starts_with("Ball lens")) check_exposure(camera, counts);
  } catch (const Error&) {
    ++counts.kinds["(cameras refused)"];
  }
  return counts;
}

}  // namespace petzval::flood
