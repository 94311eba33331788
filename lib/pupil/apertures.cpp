// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/apertures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "aim.hpp"
#include "lens/compile.hpp"
#include "lens/data.hpp"
#include "lens/edges.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double margin = 0.05;
constexpr double default_half_field_rad = 20 * std::numbers::pi / 180;

bool lacks_aperture(const SurfaceRow& row) { return !row.semi_diameter; }

double object_z(const Prescription& rows) {
  const double distance = rows.design.object_distance_mm;
  return std::isfinite(distance) && distance > 0 ? -distance : -infinity;
}

/// Calls take(surface, height) for each surface that an aimed ray meets.
void for_heights(const Lens& lens, const Ray<double>& ray, const auto& take) {
  const auto vector = [](const Vec3<double>& v) { return kernel::Vec<double>{v.x, v.y, v.z}; };
  kernel::trace(kernel::view<double>(lens), vector(ray.origin), vector(ray.direction),
                {.wavelength = lens.primary_wavelength()},
                [&](int surface, const kernel::Vec<double>& hit, const kernel::Vec<double>&) {
                  take(static_cast<std::size_t>(surface), std::hypot(hit.x, hit.y));
                });
}

/// Returns the lens with a stop as large as the axial beam through the other apertures and the edges, if they limit the
/// beam.
Lens with_widest_stop(const Lens& lens, const Prescription& rows) {
  if (!lacks_aperture(rows.surfaces[*lens.stop()]) || !has_pupils(lens)) return lens;
  const PupilPlane axis(lens, {.z = object_z(rows)});
  const auto ray_at = [&](double relative_field) { return pupil_detail::aim(lens, axis, {0, relative_field}, {}); };
  const auto passes = [&](double relative_field) { return ray_at(relative_field).status == AimStatus::converged; };
  double low = 0, high = 1;
  while (high < 1e6 && passes(high)) low = high, high *= 2;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (passes(middle) ? low : high) = middle;
  }
  double height = 0;
  if (low > 0) {
    for_heights(lens, ray_at(low).ray, [&](std::size_t surface, double at) {
      if (surface == *lens.stop()) height = at;
    });
  }
  return height > 0 ? with_semi_diameter(lens, *lens.stop(), height) : lens;
}

/// Returns the lens with the stop sized for the declared beam, if the stop is marked and has no aperture.
Lens with_declared_stop(const Lens& lens, const Prescription& rows) {
  if (!lens.stop() || std::isfinite(lens.data().rims[*lens.stop()])) return lens;
  std::optional<double> f_number = rows.f_number;
  if (const auto& aperture = rows.design.aperture; aperture && aperture->value > 0) {
    if (aperture->setting == ApertureSetting::f_number) f_number = aperture->value;
    if (aperture->setting == ApertureSetting::entrance_pupil_diameter) {
      f_number = std::abs(first_order(lens, {}, main_meridian(lens)).effective_focal_length) / aperture->value;
    }
  }
  if (!f_number) return with_widest_stop(lens, rows);
  try {
    return with_f_number(lens, *f_number);
  } catch (const Error&) {
    return lens;  // rays at the height of this f-number do not reach the stop
  }
}

/// The heights at which the rays of a beam meet the surfaces of a lens.
class BeamHeights {
 public:
  explicit BeamHeights(const Lens& lens) : lens_(lens), heights_(lens.surface_count(), 0.0) {}

  /// Adds the beam of a field: rays through the rim of the stop or, if these are lost, through the last points before
  /// the rim whose rays pass.
  /// @param mirrored true if the beam is symmetric about the meridian x = 0
  void add(const FieldPoint& point, bool mirrored) {
    const PupilPlane plane(lens_, point);
    if (!pupil_detail::aim(lens_, plane, {}, {})) return;
    constexpr int rays = 24;
    for (int i = 0; i <= (mirrored ? rays / 2 : rays - 1); ++i) {
      const double angle = 2 * std::numbers::pi * i / rays;
      add(plane, {std::sin(angle), std::cos(angle)});
    }
  }

  const std::vector<double>& heights() const noexcept { return heights_; }

 private:
  void add(const PupilPlane& plane, const Vec2<double>& rim) {
    const auto ray_at = [&](double fraction) {
      return pupil_detail::aim(lens_, plane, {fraction * rim.x, fraction * rim.y}, {});
    };
    AimedRay last = ray_at(1);
    if (last.status != AimStatus::converged) {
      // The centre may be obscured.
      constexpr int steps = 8, halvings = 4;
      double passes = -1, lost = 1;
      for (int i = steps - 1; i >= 0 && passes < 0; --i) {
        const double fraction = static_cast<double>(i) / steps;
        last = ray_at(fraction);
        (last.status == AimStatus::converged ? passes : lost) = fraction;
      }
      if (passes < 0) return;
      for (int i = 0; i < halvings; ++i) {
        const double fraction = (passes + lost) / 2;
        const AimedRay next = ray_at(fraction);
        if (next.status == AimStatus::converged) last = next;
        (next.status == AimStatus::converged ? passes : lost) = fraction;
      }
    }
    for_heights(lens_, last.ray,
                [&](std::size_t surface, double height) { heights_[surface] = std::max(heights_[surface], height); });
  }

  const Lens& lens_;
  std::vector<double> heights_;
};

/// Semi-diameters of all surfaces; computed from the beam if missing in the prescription.
std::vector<double> rims_of(const Lens& given, const Prescription& rows) {
  const Lens lens = with_declared_stop(given, rows);
  std::vector<double> rims = lens.data().rims;
  if (!has_pupils(lens)) return rims;
  BeamHeights beam(lens);
  try {
    const double z = object_z(rows), half = declared_half_field(rows, lens).value_or(default_half_field_rad);
    constexpr std::array field_fractions{0.0, 0.5, 0.7, 0.85, 1.0};
    const bool round = with_iris(lens, {}).rotationally_symmetric();
    for (const double relative_field : field_fractions) {
      beam.add({.field_rad = relative_field * half, .z = z}, round);
      if (round || relative_field == 0) continue;
      beam.add({.field_rad = relative_field * half, .z = z, .azimuth_rad = std::numbers::pi / 2}, false);
      beam.add({.field_rad = relative_field * half, .z = z, .azimuth_rad = std::numbers::pi / 4}, false);
    }
  } catch (const Error&) {
    // Field angles are undefined, or no stop limits the beam: semi-diameters stay missing.
  }
  for (std::size_t i = 0; i < rims.size(); ++i) {
    const bool computed = lacks_aperture(rows.surfaces[i]) && lens.stop() != i &&
                          lens_detail::changes_rays(lens.surfaces(), lens.data().indices.values, i);
    const double height = (1 + margin) * beam.heights()[i];
    if (computed && height > lens.surfaces()[i].obscuration_semi_diameter) rims[i] = height;
  }
  return rims;
}

/// A configuration at the primary wavelength of the design, or else at the reference wavelength; nullopt if a medium
/// has no index at either.
std::optional<Lens> at_one_wavelength(const Prescription& rows, std::size_t configuration, CompileOptions options) {
  options.configuration = configuration;
  options.missing_glass = MissingGlass::abbe;
  options.primary_nm.reset();
  const DesignData& design = rows.design;
  std::vector<double> wavelengths{rows.reference_wavelength_nm};
  if (!design.wavelengths.empty()) {
    wavelengths.insert(wavelengths.begin(), design.wavelengths[design.primary_wavelength].nm);
  }
  for (const double nm : wavelengths) {
    try {
      return lens_detail::compile_as_given(rows, std::array{nm}, options);
    } catch (const Error&) {  // The prescription is valid; an index is missing.
    }
  }
  return {};
}

}  // namespace

std::optional<double> declared_field(const Prescription& rows, const Lens& lens, FieldKind kind, double value) {
  if (kind == FieldKind::angle_deg) return value * std::numbers::pi / 180;
  const double z = object_z(rows);
  const Meridian meridian = main_meridian(lens);
  const FirstOrder first = first_order(lens, {}, meridian);
  const bool of_image = kind != FieldKind::object_height;
  if (of_image ? first.afocal : std::isinf(z)) return {};
  if (std::isinf(z)) return std::atan(std::abs(value / first.effective_focal_length));
  // Magnification of a finite object: f / (distance from the front focus).
  const double size = of_image ? value * (first.front_focal_z - z) / first.effective_focal_length : value;
  return std::atan(std::abs(size / (pupils(lens, {}, meridian).entrance.z - z)));
}

std::optional<double> declared_half_field(const Prescription& rows, const Lens& lens) {
  if (rows.half_field_deg) return declared_field(rows, lens, FieldKind::angle_deg, *rows.half_field_deg);
  double largest = 0;
  for (const DesignField& field : rows.design.fields) largest = std::max(largest, std::hypot(field.x, field.y));
  const auto declared = largest > 0 ? declared_field(rows, lens, rows.design.field_kind, largest) : std::nullopt;
  if (declared || !rows.image_diagonal_mm) return declared;
  return declared_field(rows, lens, FieldKind::paraxial_image, *rows.image_diagonal_mm / 2);
}

Lens compile(const Prescription& prescription, std::span<const double> wavelengths_nm, const CompileOptions& options) {
  if (std::ranges::none_of(prescription.surfaces, lacks_aperture)) {
    return lens_detail::compile_as_given(prescription, wavelengths_nm, options);
  }
  return lens_detail::compile_as_given(with_apertures(prescription, options), wavelengths_nm, options);
}

Lens compile(const Prescription& prescription, const CompileOptions& options) {
  return compile(prescription, std::array{prescription.reference_wavelength_nm}, options);
}

Prescription with_apertures(const Prescription& prescription, const CompileOptions& options) {
  Prescription result = prescription;
  for (SurfaceRow& row : result.surfaces) {
    if (row.semi_diameter_computed) row.semi_diameter.reset();
    row.semi_diameter_computed = false;
  }
  if (std::ranges::none_of(result.surfaces, lacks_aperture)) return result;
  validate(result, result.name.empty() ? "lens" : result.name);
  const Prescription given = result;

  // Beams change slowly from one zoom position to the next, so that 9 positions suffice.
  constexpr std::size_t max_positions = 9;
  const std::size_t count = std::max<std::size_t>(given.configurations.size(), 1),
                    tried = std::min(count, max_positions);
  for (std::size_t k = 0; k < tried; ++k) {
    const std::size_t configuration = tried == 1 ? 0 : k * (count - 1) / (tried - 1);
    const std::optional<Lens> lens = at_one_wavelength(given, configuration, options);
    if (!lens) return given;
    const std::vector<double> rims = rims_of(*lens, configured(given, configuration));
    for (std::size_t i = 0; i < rims.size(); ++i) {
      SurfaceRow& row = result.surfaces[i];
      if (!lacks_aperture(given.surfaces[i]) || !std::isfinite(rims[i])) continue;
      row.semi_diameter = std::max(rims[i], row.semi_diameter.value_or(0));
      row.semi_diameter_computed = true;
    }
  }
  return result;
}

}  // namespace petzval
