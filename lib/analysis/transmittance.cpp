// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/transmittance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil_nodes.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace {

using Vec = kernel::Vec<double>;

/// The transmittance of rays at one wavelength.
class Passage {
 public:
  Passage(const Lens& lens, std::size_t wavelength, Travel travel)
      : view_(kernel::view<double>(lens)),
        path_{.travel = travel, .wavelength = wavelength, .apertures = false},
        nm_(lens.wavelengths_nm()[wavelength]) {
    const bool to_film = travel == Travel::to_film;
    for (std::size_t i = 0; i < lens.surface_count(); ++i) {
      const LensSurface& own = lens.surfaces()[i];
      const double front = lens.index(i, wavelength), back = lens.index(i + 1, wavelength);
      Coating coating = own.coating.value_or(Coating{});
      if (!to_film && !own.mirror) coating = reversed(std::move(coating));
      const bool bare = coating.layers.empty() && coating.table.empty();
      const std::size_t space = to_film ? i + 1 : i;
      surfaces_.push_back({std::move(coating), to_film ? front : back, to_film ? back : front,
                           lens.absorption(space, wavelength), own.mirror, bare && (own.mirror || front == back)});
    }
    hits_.reserve(lens.surface_count());
  }

  /// nullopt if the ray does not pass. Not thread-safe.
  std::optional<double> operator()(const Ray<double>& ray) {
    hits_.clear();
    const auto end = kernel::trace(view_, kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction), path_,
                                   [&](int surface, const Vec& point, const Vec& direction) {
                                     hits_.push_back({static_cast<std::size_t>(surface), point, direction});
                                   });
    if (end.fate != RayFate::transmitted) return {};
    double result = 1, absorbance = 0;
    for (std::size_t k = 0; k < hits_.size(); ++k) {
      const Surface& surface = surfaces_[hits_[k].surface];
      const bool last = k + 1 == hits_.size();
      result *= passed(surface, hits_[k]);
      if (last || surface.absorption == 0) continue;
      const Vec path = hits_[k + 1].point - hits_[k].point;
      absorbance += surface.absorption * std::sqrt(dot(path, path));
    }
    return result * std::exp(-absorbance);
  }

 private:
  struct Surface {
    Coating coating;  ///< seen from the arriving ray
    double before, behind;
    double absorption;  ///< of the medium behind, 1/mm
    bool mirror, lossless;
  };
  struct Hit {
    std::size_t surface;
    Vec point, direction;  ///< of the arriving ray
  };

  /// Fraction of the light that a surface passes.
  double passed(const Surface& surface, const Hit& hit) const {
    if (surface.lossless) return 1;
    const kernel::SurfaceTable<double>& table = view_.surfaces[hit.surface];
    const Vec at{hit.point.x, hit.point.y, hit.point.z - view_.vertex_z[hit.surface]};
    const Vec normal =
        table.asphere < 0 ? kernel::gradient(table.quadric, at) : kernel::normal(view_.aspheres[table.asphere], at);
    const double cosine = std::min(std::abs(dot(hit.direction, normal)) / std::sqrt(dot(normal, normal)), 1.0);
    const SurfaceLight light = surface_light(surface.coating, surface.before, surface.behind, cosine, nm_);
    return surface.mirror ? light.reflectance() : light.transmittance();
  }

  kernel::LensView<double> view_;
  kernel::SurfaceRange path_;
  double nm_;
  std::vector<Surface> surfaces_;
  std::vector<Hit> hits_;
};

}  // namespace

bool states_coatings(const Lens& lens) {
  return std::ranges::any_of(lens.surfaces(), [](const LensSurface& surface) { return surface.coating.has_value(); });
}

std::vector<std::size_t> uncoated_surfaces(const Lens& lens) {
  constexpr double largest_air_index = 1.01;  // as with_coating()
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const LensSurface& surface = lens.surfaces()[i];
    const bool to_air = (lens.index(i) < largest_air_index) != (lens.index(i + 1) < largest_air_index);
    if (to_air && !surface.mirror && !surface.coating) result.push_back(i);
  }
  return result;
}

std::optional<double> transmittance(const Lens& lens, const Ray<double>& ray, Wavelength wavelength, Travel travel) {
  return Passage(lens, lens.wavelength_index(wavelength), travel)(ray);
}

std::optional<double> transmittance(const Lens& lens, const FieldPoint& point, Wavelength wavelength) {
  const std::size_t directions = lens.rotationally_symmetric() && point.field_rad == 0 ? 1 : 32;
  const PupilBoundary pupil = pupil_boundary(lens, point, wavelength, directions);
  Passage passage(lens, lens.wavelength_index(wavelength), Travel::to_film);
  // The nodes of a symmetric lens are mirrored at the meridian of the field: one half is enough.
  const bool mirrored = lens.rotationally_symmetric() && point.azimuth_rad == 0;
  double light = 0, area = 0;
  for (const analysis_detail::PupilNode& node : analysis_detail::pupil_nodes<6>(pupil)) {
    if (mirrored && 2 * node.direction >= directions) continue;
    const auto passes = passage(pupil.plane.ray(node.position.x, node.position.y));
    if (!passes) continue;
    light += node.area * *passes, area += node.area;
  }
  return area > 0 ? std::optional(light / area) : std::nullopt;
}

Grid<std::optional<double>> transmittance(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                          int threads) {
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  Grid<std::optional<double>> result{std::vector<std::optional<double>>(fields_rad.size() * wavelengths), wavelengths};
  parallel_for(result.values.size(), 1, threads, [&](std::size_t k, std::size_t) {
    const FieldPoint point{.field_rad = fields_rad[k / wavelengths], .z = subject_z};
    result.values[k] = transmittance(lens, point, k % wavelengths);
  });
  return result;
}

double area_f_number(const Lens& lens, Wavelength wavelength) {
  const bool symmetric = lens.rotationally_symmetric();
  const auto length = [&](Meridian meridian) {
    return std::abs(first_order(lens, wavelength, meridian).effective_focal_length);
  };
  const double y = length(Meridian::y), mean = symmetric ? y : std::sqrt(y * length(Meridian::x));
  const FieldPoint axis{.z = -std::numeric_limits<double>::infinity()};
  return mean / (2 * std::sqrt(pupil_boundary(lens, axis, wavelength, symmetric ? 1 : 256).area() / std::numbers::pi));
}

std::optional<LensColour> lens_colour(const Lens& lens, double subject_z, const Spectrum& light,
                                      const ColourMatching& table) {
  const auto white = tristimulus(light, table);
  if (!(white[1] > 0)) {
    throw Error("lens_colour: the light has a luminance of " + to_text(white[1]) + "; must be positive");
  }
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
  const auto behind = tristimulus(product, table);
  if (!(behind[1] > 0)) return {};
  const auto xy = [](const std::array<double, 3>& xyz) {
    const double sum = xyz[0] + xyz[1] + xyz[2];
    return std::array{xyz[0] / sum, xyz[1] / sum};
  };
  const auto own = xy(behind), of_light = xy(white);
  return LensColour{behind[1] / white[1], own, of_light, correlated_colour_temperature(own, table),
                    correlated_colour_temperature(of_light, table)};
}

ApertureState aperture_state(const Lens& lens) {
  ApertureState state{.f_number = real_f_number(lens)};
  state.area_f_number = std::max(state.f_number, area_f_number(lens));
  if (states_coatings(lens)) {
    const auto light = transmittance(lens, FieldPoint{.z = -std::numeric_limits<double>::infinity()});
    if (light) state.t_number = state.area_f_number / std::sqrt(*light);
  }
  return state;
}

}  // namespace petzval
