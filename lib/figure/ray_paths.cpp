// SPDX-License-Identifier: Apache-2.0
#include "ray_paths.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "petzval/pupil/aim.hpp"
#include "trace/sequential.hpp"

namespace petzval::figure_detail {
namespace {

/// The rays of one field, by their relative height in the stop, -1 to 1.
class Fan {
 public:
  Fan(const Lens& lens, const FieldPoint& point, Meridian meridian, std::size_t wavelength)
      : lens_(lens), point_(point), in_y_(meridian == Meridian::y), wavelength_(wavelength) {}

  AimedRay at(double height) const {
    const double inside = height * (1 - 1e-9);  // rounding must not vignette the ray through the rim
    return aim(lens_, point_, in_y_ ? Vec2<double>{0, inside} : Vec2<double>{inside, 0}, wavelength_);
  }
  bool passes(double height) const { return at(height).status == AimStatus::converged; }

  /// The limit of transmitted heights between a height that is transmitted and a height that is lost, by bisection.
  double edge(double passing, double lost) const {
    for (int i = 0; i < 20; ++i) {
      const double middle = (passing + lost) / 2;
      (passes(middle) ? passing : lost) = middle;
    }
    return passing;
  }

  /// The heights of the rays to draw.
  std::vector<double> heights(std::size_t count) const {
    constexpr int steps = 40;
    const auto step = [](int k) { return 2.0 * k / steps - 1; };
    int low = 0, high = steps;
    while (low <= steps && !passes(step(low))) ++low;
    if (low > steps) return {-1, 0, 1};
    while (!passes(step(high))) --high;
    const double from = low == 0 ? -1 : edge(step(low), step(low - 1));
    const double to = high == steps ? 1 : edge(step(high), step(high + 1));

    std::vector<double> result;
    for (std::size_t k = 0; k < count; ++k) {
      result.push_back(from + (to - from) * static_cast<double>(k) / static_cast<double>(count - 1));
    }
    // The chief ray replaces the nearest inner ray; the rays through the rim of the stop are added last.
    if (from < 0 && to > 0) {
      *std::min_element(result.begin() + 1, result.end() - 1,
                        [](double a, double b) { return std::abs(a) < std::abs(b); }) = 0;
    } else {
      result.push_back(0);
    }
    if (from > -1) result.push_back(-1);
    if (to < 1) result.push_back(1);
    return result;
  }

 private:
  const Lens& lens_;
  FieldPoint point_;
  bool in_y_;
  std::size_t wavelength_;
};

}  // namespace

std::vector<RayPath> ray_paths(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                               Meridian meridian, std::size_t count, std::size_t wavelength) {
  const bool in_y = meridian == Meridian::y;
  const auto seen = [in_y](const auto& v) { return SectionPoint{v.z, in_y ? v.y : v.x}; };
  std::vector<RayPath> result;
  for (std::size_t field = 0; field < fields_rad.size(); ++field) {
    const Fan fan(lens, {fields_rad[field], subject_z, in_y ? 0 : std::numbers::pi / 2}, meridian, wavelength);
    for (const double height : fan.heights(count)) {
      const AimedRay aimed = fan.at(height);
      if (!aimed) continue;
      RayPath path{field, height, {}, {}, seen(aimed.ray.direction), {}, RayFate::transmitted};
      const auto end = kernel::trace(
          kernel::view<double>(lens), kernel::to_kernel(aimed.ray.origin), kernel::to_kernel(aimed.ray.direction),
          {.wavelength = wavelength}, [&](int surface, const kernel::Vec<double>& hit, const kernel::Vec<double>&) {
            path.hits.push_back(seen(hit)), path.surfaces.push_back(static_cast<std::size_t>(surface));
          });
      path.behind = seen(end.direction);
      path.fate = end.fate;
      const bool misses_lens = end.fate != RayFate::transmitted && path.hits.size() < 2;
      if (!misses_lens) result.push_back(std::move(path));
    }
  }
  return result;
}

}  // namespace petzval::figure_detail
