// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/transmittance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "petzval/core/error.hpp"
#include "petzval/pupil/f_number.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil_nodes.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace {

using Vec = kernel::Vec<double>;

/// Fraction of the light that a surface passes, from the directions on both sides; the normal is along the difference
/// of the directions times the indices.
double passed(const Coating& coating, bool mirror, double before, double behind, const Vec& in, const Vec& out,
              double wavelength_nm) {
  const bool bare = coating.layers.empty() && coating.table.empty();
  if (bare && (mirror || before == behind)) return 1;
  const Vec normal = out * behind - in * before;
  const double length = std::sqrt(dot(normal, normal));
  // Equal indices leave the direction as it is; their coating acts at normal incidence.
  const double cosine = length > 1e-12 ? std::min(std::abs(dot(in, normal)) / length, 1.0) : 1;
  const SurfaceLight light = surface_light(coating, before, behind, cosine, wavelength_nm);
  return mirror ? light.reflectance() : light.transmittance();
}

}  // namespace

std::optional<double> transmittance(const Lens& lens, const Ray<double>& ray, Wavelength wavelength, Travel travel) {
  const std::size_t position = lens.compiled_position(wavelength);
  std::vector<std::pair<std::size_t, Vec>> arrivals;  // surface, direction of the arriving ray
  const auto end =
      kernel::trace(kernel::view<double>(lens), kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction),
                    {.travel = travel, .wavelength = position, .apertures = false},
                    [&](int surface, const Vec&, const Vec& direction) {
                      arrivals.emplace_back(static_cast<std::size_t>(surface), direction);
                    });
  if (end.fate != RayFate::transmitted) return {};
  double result = 1;
  for (std::size_t k = 0; k < arrivals.size(); ++k) {
    const auto& [surface, in] = arrivals[k];
    const Vec& out = k + 1 < arrivals.size() ? arrivals[k + 1].second : end.direction;
    const bool to_film = travel == Travel::to_film;
    const double before = lens.index(to_film ? surface : surface + 1, position);
    const double behind = lens.index(to_film ? surface + 1 : surface, position);
    const LensSurface& own = lens.surfaces()[surface];
    const Coating coating = own.coating.value_or(Coating{});
    result *= passed(to_film ? coating : reversed(coating), own.mirror, before, behind, in, out,
                     lens.wavelengths_nm()[position]);
  }
  return result;
}

std::optional<double> transmittance(const Lens& lens, const FieldPoint& point, Wavelength wavelength) {
  constexpr std::size_t directions = 32;
  const PupilBoundary pupil = pupil_boundary(lens, point, wavelength, directions);
  double light = 0, area = 0;
  for (const analysis_detail::PupilNode& node : analysis_detail::pupil_nodes(pupil)) {
    const auto passes = transmittance(lens, pupil.plane.ray(node.position.x, node.position.y), wavelength);
    if (!passes) continue;
    light += node.area * *passes, area += node.area;
  }
  return area > 0 ? std::optional(light / area) : std::nullopt;
}

std::optional<LensColour> lens_colour(const Lens& lens, double subject_z, const Spectrum& light,
                                      const ColourMatching& table) {
  const auto& nm = lens.wavelengths_nm();
  std::vector<std::size_t> order(nm.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t w) { return nm[w]; });
  std::vector<double> values;
  for (const std::size_t w : order) {
    const auto value = transmittance(lens, {.z = subject_z}, w);
    if (!value) return {};
    values.push_back(*value);
  }
  const auto at = [&](double wavelength) {
    const auto above = std::ranges::lower_bound(order, wavelength, {}, [&](std::size_t w) { return nm[w]; });
    if (above == order.begin()) return values.front();
    if (above == order.end()) return values.back();
    const auto k = static_cast<std::size_t>(above - order.begin());
    const double from = nm[order[k - 1]];
    return std::lerp(values[k - 1], values[k], (wavelength - from) / (nm[order[k]] - from));
  };
  // tristimulus() is exact for light that is linear between the samples: samples 1 nm apart follow the product.
  Spectrum product;
  const double first = light.wavelengths_nm.front(), last = light.wavelengths_nm.back();
  for (double wavelength = first; wavelength <= last; wavelength += 1) {
    const auto above = std::ranges::lower_bound(light.wavelengths_nm, wavelength);
    const auto k = static_cast<std::size_t>(above - light.wavelengths_nm.begin());
    const double power = k == 0 ? light.power[0]
                                : std::lerp(light.power[k - 1], light.power[k],
                                            (wavelength - light.wavelengths_nm[k - 1]) /
                                                (light.wavelengths_nm[k] - light.wavelengths_nm[k - 1]));
    product.wavelengths_nm.push_back(wavelength);
    product.power.push_back(power * at(wavelength));
  }
  const auto behind = tristimulus(product, table), white = tristimulus(light, table);
  const auto xy = [](const std::array<double, 3>& xyz) {
    const double sum = xyz[0] + xyz[1] + xyz[2];
    return std::array{xyz[0] / sum, xyz[1] / sum};
  };
  const double luminous = behind[1] / white[1];
  return LensColour{luminous, real_f_number(lens) / std::sqrt(luminous), xy(behind), xy(white)};
}

}  // namespace petzval
