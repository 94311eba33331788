// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/aberrations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>

#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "optical_path.hpp"
#include "partial_sums.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/pupil/aim.hpp"
#include "points.hpp"
#include "spot_moments.hpp"

namespace petzval {
namespace {

using FilmRay = core_detail::SlopeRay<double>;

/// The ray behind the lens, at the film.
std::optional<FilmRay> at_film(const Lens& lens, const AimedRay& aimed) {
  if (!aimed || !aimed.end.transmitted()) return {};
  const FilmRay ray = core_detail::slope_ray(aimed.end.ray, lens.film_z());
  if (!std::isfinite(ray.x + ray.y)) return {};
  return ray;
}

/// The limit at step 0 of values at a step, a half and a quarter of it: Richardson's rule without the terms of first
/// and second order. Aspheres with r^3 have a term of first order.
std::optional<double> limit_at_0(const std::array<std::optional<double>, 3>& values) {
  if (!values[0] || !values[1] || !values[2]) return {};
  return (*values[0] - 6 * *values[1] + 8 * *values[2]) / 3;
}

/// Distance at which rays on both sides of a chief ray intersect.
std::optional<double> crossing(double position_change, double slope_change) {
  const double distance = -position_change / slope_change;
  if (!std::isfinite(distance)) return {};
  return distance;
}

/// Frequencies that are whole multiples of a base: their sums over rays follow from powers of one phase for each ray,
/// which saves most sines and cosines.
struct Harmonics {
  struct Member {
    std::size_t at, multiple;  ///< index in the list of frequencies; frequency divided by the base
  };
  double base = 0;
  std::vector<Member> members;

  /// Sums of exp(-2 pi i m base (value - origin)) over values, for multiples m from 0 to the largest.
  std::vector<std::complex<double>> sums(std::span<const double> values, double origin) const {
    constexpr std::size_t lanes = 8, block = 32 * lanes;
    std::size_t largest = 0;
    for (const Member& member : members) largest = std::max(largest, member.multiple);
    std::vector<std::complex<double>> result(largest + 1);
    for (std::size_t begin = 0; begin < values.size(); begin += block) {
      const auto own = values.subspan(begin, std::min(block, values.size() - begin));
      // Lanes beyond the values stay 0.
      std::array<double, block> step_re{}, step_im{}, re{}, im{};
      for (std::size_t i = 0; i < own.size(); ++i) {
        const double phase = -2 * std::numbers::pi * base * (own[i] - origin);
        step_re[i] = std::cos(phase), step_im[i] = std::sin(phase);
        re[i] = 1;
      }
      for (std::size_t m = 0;; ++m) {
        analysis_detail::PartialSums sum_re{}, sum_im{};
        for (std::size_t i = 0; i < block; i += lanes) {
          for (std::size_t lane = 0; lane < lanes; ++lane) sum_re[lane] += re[i + lane], sum_im[lane] += im[i + lane];
        }
        result[m] += std::complex(analysis_detail::sum(sum_re), analysis_detail::sum(sum_im));
        if (m == largest) break;
        for (std::size_t i = 0; i < block; ++i) {
          const double x = re[i], y = im[i];
          re[i] = x * step_re[i] - y * step_im[i], im[i] = x * step_im[i] + y * step_re[i];
        }
      }
    }
    return result;
  }
};

/// One group if all frequencies are small multiples of the smallest one above 0, else a group for each frequency.
std::vector<Harmonics> harmonics(std::span<const double> frequencies) {
  Harmonics all;
  for (const double f : frequencies) {
    if (std::abs(f) > 0 && (all.base == 0 || std::abs(f) < all.base)) all.base = std::abs(f);
  }
  std::vector<Harmonics> single;
  bool together = true;
  for (std::size_t at = 0; at < frequencies.size(); ++at) {
    const double f = std::abs(frequencies[at]), multiple = all.base > 0 ? std::round(f / all.base) : 0;
    single.push_back({f, {{at, 1}}});
    together = together && std::abs(multiple * all.base - f) <= 1e-14 * f &&
               multiple <= 8 * static_cast<double>(frequencies.size());
    if (together) all.members.push_back({at, static_cast<std::size_t>(multiple)});
  }
  if (together) return {all};
  return single;
}

}  // namespace

Grid<RayFan> ray_fans(const Lens& lens, double subject_z, std::span<const double> fields_rad, std::size_t count) {
  if (count < 2) throw Error("ray_fans: count = " + std::to_string(count) + "; must be at least 2");
  Grid<RayFan> fans{{}, lens.wavelengths_nm().size()};
  for (const double field : fields_rad) {
    const FieldPoint point{.field_rad = field, .z = subject_z};
    const auto chief = analysis_detail::chief_point(lens, point, lens.primary_wavelength());
    for (std::size_t w = 0; w < fans.columns; ++w) {
      RayFan& fan = fans.values.emplace_back(RayFan{field, w, {}});
      const auto errors = analysis_detail::SphereErrors::of(lens, point, w);
      const auto ray = [&](const Vec2<double>& target) {
        AimedRay aimed = aim(lens, point, target, w);
        return chief && aimed.status == AimStatus::converged ? std::optional(aimed) : std::nullopt;
      };
      const auto waves = [&](const AimedRay& aimed) -> std::optional<double> {
        const auto path = errors ? errors->paths()(aimed.ray) : std::nullopt;
        return path ? std::optional((*errors)(*path)) : std::nullopt;
      };
      for (std::size_t i = 0; i < count; ++i) {
        const double pupil = 2 * static_cast<double>(i) / static_cast<double>(count - 1) - 1;
        RayFan::Point& at = fan.points.emplace_back(RayFan::Point{.pupil = pupil});
        constexpr double inside = 1 - 1e-9;  // rays on the rim of the stop may be clipped by rounding
        if (const auto aimed = ray({0, inside * pupil})) {
          if (const auto hit = at_film(lens, *aimed)) at.tangential_mm = hit->y - chief->y;
          at.tangential_waves = waves(*aimed);
        }
        if (const auto aimed = ray({inside * pupil, 0})) {
          if (const auto hit = at_film(lens, *aimed)) at.sagittal_mm = hit->x - chief->x;
          at.sagittal_waves = waves(*aimed);
        }
      }
    }
  }
  return fans;
}

std::vector<FieldFocus> field_curvature(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                        Wavelength wavelength) {
  std::vector<FieldFocus> foci;
  for (const double field : fields_rad) {
    const FieldPoint point{.field_rad = field, .z = subject_z};
    const auto ray = [&](const Vec2<double>& target) { return at_film(lens, aim(lens, point, target, wavelength)); };
    std::array<std::optional<double>, 3> tangential, sagittal;
    for (std::size_t k = 0; k < tangential.size(); ++k) {
      const double step = std::ldexp(2e-3, -static_cast<int>(k));  // semi-diameters of the stop
      const auto up = ray({0, step}), down = ray({0, -step}), right = ray({step, 0}), left = ray({-step, 0});
      if (up && down) tangential[k] = crossing(up->y - down->y, up->slope_y - down->slope_y);
      if (right && left) sagittal[k] = crossing(right->x - left->x, right->slope_x - left->slope_x);
    }
    FieldFocus& focus = foci.emplace_back(FieldFocus{field, limit_at_0(tangential), limit_at_0(sagittal)});
    // Along the light, which may run towards -z behind mirrors.
    const double forwards = lens.light_direction(lens.surface_count());
    for (auto* distance : {&focus.tangential_mm, &focus.sagittal_mm}) {
      if (*distance) **distance *= forwards;
    }
  }
  return foci;
}

std::vector<FieldDistortion> distortion_percent(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                                Wavelength wavelength) {
  const std::size_t w = lens.wavelength_index(wavelength);
  const auto height = [&](double field) -> std::optional<double> {
    const FieldPoint point{.field_rad = field, .z = subject_z};
    const auto hit = analysis_detail::chief_point(lens, point, w);
    if (!hit) return {};
    return hit->y;
  };
  double widest = 0;
  for (const double field : fields_rad) widest = std::max(widest, std::abs(field));
  const double small = widest > 0 ? std::min(4e-4, widest / 4) : 4e-4;  // rad; some telescopes have fields of 1e-3
  std::array<std::optional<double>, 3> scales;                          // height over field
  for (std::size_t k = 0; k < scales.size(); ++k) {
    const double near_axis = std::ldexp(small, -static_cast<int>(k));
    if (const auto found = height(near_axis)) scales[k] = *found / near_axis;
  }
  const auto scale = limit_at_0(scales);
  std::vector<FieldDistortion> result;
  for (const double field : fields_rad) {
    FieldDistortion& own = result.emplace_back(FieldDistortion{field, height(field), {}, {}});
    if (!own.height_mm || !scale) continue;
    const auto percent = [&](double projected) {
      return field == 0 ? 0 : 100 * (*own.height_mm / (*scale * projected) - 1);
    };
    own.f_theta_percent = percent(field);
    if (std::abs(field) < std::numbers::pi / 2) own.f_tan_theta_percent = percent(std::tan(field));
  }
  return result;
}

Grid<MtfPoint> geometric_mtf(const Grid<Spot>& spots, std::span<const double> frequencies_per_mm,
                             std::span<const double> wavelength_weights, int threads) {
  constexpr std::size_t parts = analysis_detail::error_parts;
  const auto weights = analysis_detail::ray_weights("geometric_mtf", spots, wavelength_weights);
  const std::vector<Harmonics> groups = harmonics(frequencies_per_mm);
  const std::size_t count = frequencies_per_mm.size(), tasks = 2 * spots.values.size();
  // Sums over the rays of a spot: [2 spot + direction][frequency][part of the rays].
  std::vector<std::vector<std::array<std::complex<double>, parts>>> sums(tasks);
  parallel_for(tasks, 1, threads, [&](std::size_t task, std::size_t) {
    const Spot& spot = spots.values[task / 2];
    const Vec2<double> origin = spots[task / 2 / spots.columns].front().size.centroid;
    const bool along_y = task % 2 == 0;
    sums[task].resize(count);
    for (const Harmonics& group : groups) {
      for (std::size_t part = 0; part < parts; ++part) {
        const auto values = analysis_detail::part_of(along_y ? spot.y : spot.x, part);
        const auto of_part = group.sums(values, along_y ? origin.y : origin.x);
        for (const auto& [at, multiple] : group.members) sums[task][at][part] = of_part[multiple];
      }
    }
  });
  Grid<MtfPoint> result{{}, count};
  for (std::size_t field = 0; field < spots.size(); ++field) {
    const std::size_t first = field * spots.columns;
    for (std::size_t at = 0; at < count; ++at) {
      MtfPoint& point =
          result.values.emplace_back(MtfPoint{spots.values[first].point.field_rad, frequencies_per_mm[at]});
      for (std::size_t direction = 0; direction < 2; ++direction) {
        std::array<std::complex<double>, parts + 1> sum{};  // the last one: all rays
        std::array<double, parts + 1> total{};
        for (std::size_t part = 0; part < parts; ++part) {
          for (std::size_t i = first; i < first + spots.columns; ++i) {
            sum[part] += weights.values[i] * sums[2 * i + direction][at][part];
            total[part] +=
                weights.values[i] * static_cast<double>(analysis_detail::part_of(spots.values[i].x, part).size());
          }
          sum[parts] += sum[part];
          total[parts] += total[part];
        }
        const auto contrast = [&](std::size_t part) { return total[part] > 0 ? std::abs(sum[part]) / total[part] : 0; };
        (direction == 0 ? point.tangential : point.sagittal) = contrast(parts);
        for (std::size_t part = 0; part < parts; ++part) {
          point.sampling_error = std::max(point.sampling_error, std::abs(contrast(part) - contrast(parts)));
        }
      }
    }
  }
  return result;
}

Grid<EncircledEnergy> encircled_energy(const Grid<Spot>& spots, std::span<const double> fractions,
                                       std::span<const double> wavelength_weights, int threads) {
  const auto weights = analysis_detail::ray_weights("encircled_energy", spots, wavelength_weights);
  for (const double fraction : fractions) {
    if (!(fraction >= 0 && fraction <= 1)) {
      throw Error("encircled_energy: fraction = " + to_text(fraction) + "; must be 0 to 1");
    }
  }
  std::vector<std::size_t> order(fractions.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::sort(order, {}, [&](std::size_t k) { return fractions[k]; });
  Grid<EncircledEnergy> result{std::vector<EncircledEnergy>(spots.size() * fractions.size()), fractions.size()};
  parallel_for(spots.size(), 1, threads, [&](std::size_t field, std::size_t) {
    const auto own = spots[field];
    const auto own_weights = weights[field];
    const Vec2<double> centre = analysis_detail::SpotMoments(own, own_weights).centroid(0);
    struct Ray {
      double squared_radius;
      std::uint32_t wavelength, part;
    };
    constexpr std::uint32_t parts = analysis_detail::error_parts;
    std::vector<Ray> rays;
    std::array<double, parts> total{};
    for (std::size_t w = 0; w < own.size(); ++w) {
      const Spot& spot = own[w];
      if (own_weights[w] == 0) continue;
      for (std::size_t i = 0; i < spot.x.size(); ++i) {
        const double dx = spot.x[i] - centre.x, dy = spot.y[i] - centre.y;
        // As part_of().
        const auto part = static_cast<std::uint32_t>(((i + 1) * parts - 1) / spot.x.size());
        rays.push_back({dx * dx + dy * dy, static_cast<std::uint32_t>(w), part});
        total[part] += own_weights[w];
      }
    }
    std::ranges::sort(rays, {}, &Ray::squared_radius);
    // Radii of the fractions, by the rays of some parts: the first ray with which the sum reaches the fraction.
    const auto radii = [&](std::uint32_t from, std::uint32_t to) {
      std::vector<std::optional<double>> found(fractions.size());
      const double all = std::accumulate(total.begin() + from, total.begin() + to, 0.0);
      double sum = 0, largest = 0;
      auto next = order.begin();
      for (const Ray& ray : rays) {
        if (ray.part < from || ray.part >= to) continue;
        sum += own_weights[ray.wavelength];
        largest = std::sqrt(ray.squared_radius);
        constexpr double rounding = 1e-9;
        for (; next != order.end() && fractions[*next] < 1 && sum >= (fractions[*next] - rounding) * all; ++next) {
          found[*next] = fractions[*next] > 0 ? largest : 0;
        }
      }
      for (; next != order.end() && all > 0; ++next) found[*next] = largest;
      return found;
    };
    EncircledEnergy* const own_result = result.values.data() + field * fractions.size();
    const auto of_all = radii(0, parts);
    for (std::size_t k = 0; k < fractions.size(); ++k) {
      own_result[k] = {own.front().point.field_rad, fractions[k], of_all[k], 0};
    }
    for (std::uint32_t part = 0; part < parts; ++part) {
      const auto of_part = radii(part, part + 1);
      for (std::size_t k = 0; k < fractions.size(); ++k) {
        if (!of_all[k] || !of_part[k]) continue;
        double& error = own_result[k].sampling_error_mm;
        error = std::max(error, std::abs(*of_part[k] - *of_all[k]));
      }
    }
  });
  return result;
}

Grid<AxialRayFocus> longitudinal_aberration(const Lens& lens, double subject_z, std::size_t count) {
  if (count < 2) throw Error("longitudinal_aberration: count = " + std::to_string(count) + "; must be at least 2");
  constexpr double near_axis = 1e-3, inside = 1 - 1e-9;  // as in field_curvature() and ray_fans()
  Grid<AxialRayFocus> foci{{}, count};
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    const auto ray = [&](const Vec2<double>& target) -> std::optional<FilmRay> {
      const AimedRay aimed = aim(lens, {0, subject_z}, target, w);
      if (aimed.status != AimStatus::converged) return {};
      return at_film(lens, aimed);
    };
    for (std::size_t i = 0; i < count; ++i) {
      const double pupil = static_cast<double>(i) / static_cast<double>(count - 1);
      AxialRayFocus& focus = foci.values.emplace_back(AxialRayFocus{w, pupil, {}, {}});
      const double height = inside * std::max(pupil, near_axis);
      if (const auto up = ray({0, height})) focus.tangential_mm = crossing(up->y, up->slope_y);
      if (const auto right = ray({height, 0})) focus.sagittal_mm = crossing(right->x, right->slope_x);
    }
  }
  return foci;
}

double diffraction_limited_mtf(double frequency_per_mm, double wavelength_nm, double f_number) noexcept {
  const double s = std::abs(frequency_per_mm) * wavelength_nm * 1e-6 * f_number;
  return s < 1 ? 2 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1 - s * s)) : 0;
}

}  // namespace petzval
