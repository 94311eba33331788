// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/f_number.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/bisect.hpp"
#include "core/text.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Traces axis-parallel rays in the main meridian from object space to one surface: the stop or a surface with a
/// central obscuration.
class HeightAt {
 public:
  HeightAt(const Lens& lens, std::size_t surface, Wavelength wavelength)
      : lens_(lens), surface_(surface), along_y_(main_meridian(lens, wavelength) == Meridian::y) {
    path_.wavelength = lens.wavelength_index(wavelength);
    path_.apertures = false;
    path_.last = surface + 1;
  }

  /// Height at which the ray that enters at height y meets the surface; nullopt if it does not reach the surface. Its
  /// fate at the surface is ignored.
  std::optional<double> operator()(double y) const noexcept {
    const kernel::Vec<double> start{along_y_ ? 0 : y, along_y_ ? y : 0, lens_.surfaces().front().vertex_z};
    const auto end = kernel::trace(kernel::view<double>(lens_), start, kernel::Vec<double>{0, 0, 1}, path_);
    const bool met = end.surface == static_cast<int>(surface_) &&
                     (end.fate == RayFate::transmitted || end.fate == RayFate::totally_reflected);
    if (!met) return {};
    return std::hypot(end.origin.x, end.origin.y);
  }

 private:
  const Lens& lens_;
  std::size_t surface_;
  bool along_y_;
  kernel::SurfaceRange path_;
};

/// Largest entering height of the beam within the rim of the stop: the height of the ray that meets the rim or, if rays
/// are lost before the rim, of the last ray that reaches the stop.
/// @param expected first-order estimate, which sets the step size
double entering_height(const HeightAt& height_at, double rim, double expected) {
  const auto inside = [&](double y) {
    const auto height = height_at(y);
    return height && *height <= rim;
  };
  // With spherical aberration, rays farther out may meet the stop inside its rim again. Steps that are small compared
  // with the beam find the first crossing. The steps grow, because the estimate may be far too small or underflow.
  double step = std::max(expected / 16, std::numeric_limits<double>::min());
  double low = 0, high = step;
  while (inside(high)) {
    low = high;
    if (low > 4 * expected) step *= 2;
    high += step;
    if (!(high < 1e100)) return infinity;
  }
  return core_detail::last_with(low, high, inside);
}

/// The stop of a lens and the height at which its axial beam enters, to first order.
struct Beam {
  std::size_t stop = 0;
  double height = 0;
};

Beam beam_of(const Lens& lens, double focal_length, Wavelength wavelength) {
  const Pupils p = pupils(lens, wavelength, main_meridian(lens, wavelength));
  return {p.stop, std::min(p.entrance.diameter / 2, focal_length)};
}

/// Exact entering height of the beam for the present stop.
double beam_height(const Lens& lens, const Beam& beam, Wavelength wavelength) {
  const double rim = lens.surfaces()[beam.stop].semi_diameter;
  return rim == 0 ? 0 : entering_height(HeightAt(lens, beam.stop, wavelength), rim, beam.height);
}

/// A central obscuration and the entering height of the ray that grazes its edge; 0 if there is no obscuration.
struct Obscuration {
  std::size_t surface = 0;
  double height = 0;
};

/// The largest of the obscurations that stop the ray that enters at height y.
Obscuration widest_obscuration(const Lens& lens, const Beam& beam, Wavelength wavelength, double y) {
  Obscuration widest;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const double edge = lens.surfaces()[i].obscuration_semi_diameter;
    const HeightAt height_at(lens, i, wavelength);
    if (const auto height = edge > 0 ? height_at(y) : std::nullopt; !height || *height > edge) continue;
    const double entering = entering_height(height_at, edge, beam.height);
    if (entering > widest.height) widest = {i, entering};
  }
  return widest;
}

/// The axial beam with the stop fully open.
struct WidestBeam {
  Beam beam;
  bool open = false;  ///< true if the marked stop has no rim
  double height = 0;  ///< entering height of the beam; infinite if the beam has no limit
};

WidestBeam widest_beam(const Lens& lens, double focal_length, Wavelength wavelength) {
  const bool open = lens.stop() && std::isinf(lens.surfaces()[*lens.stop()].semi_diameter);
  const Beam beam = open ? Beam{*lens.stop(), focal_length} : beam_of(lens, focal_length, wavelength);
  return {beam, open, beam_height(lens, beam, wavelength)};
}

double focal_length(const Lens& lens, Wavelength wavelength) {
  return std::abs(first_order(lens, wavelength, main_meridian(lens, wavelength)).effective_focal_length);
}

double f_number(double focal_length, double beam_height) {
  return std::isinf(focal_length) ? infinity : focal_length / (2 * beam_height);
}

}  // namespace

double real_f_number(const Lens& lens, Wavelength wavelength) {
  const double length = focal_length(lens, wavelength);
  const Beam beam = beam_of(lens, length, wavelength);
  return std::isinf(length) ? infinity : f_number(length, beam_height(lens, beam, wavelength));
}

double fastest_f_number(const Lens& lens, Wavelength wavelength) {
  const double length = focal_length(lens, wavelength);
  if (std::isinf(length)) throw Error(lens.name() + ": afocal; must have a focal length for an f-number");
  return length / (2 * widest_beam(lens, length, wavelength).height);
}

Lens with_f_number(const Lens& lens, double f_number, Wavelength wavelength) {
  if (!(f_number > 0 && std::isfinite(f_number))) {
    throw Error(lens.name() + ": f-number = " + to_text(f_number) + "; must be finite and above 0");
  }
  const double length = focal_length(lens, wavelength);
  if (std::isinf(length))
    throw Error(lens.name() + ": the lens is afocal; must have a focal length to set an f-number");

  const auto [beam, open, largest] = widest_beam(lens, length, wavelength);
  const LensSurface& stop = lens.surfaces()[beam.stop];
  const double y = length / (2 * f_number);
  if (!(largest > 0)) {
    throw Error(lens.name() + ": no ray parallel to the axis passes; must transmit an axial beam to set an f-number");
  }
  const HeightAt stop_height(lens, beam.stop, wavelength);
  const auto height = stop_height(std::min(y, largest));
  // Declared f-numbers are rounded, or belong to the paraxial pupil or to another glass. A stop without a rim gets the
  // declared f-number exactly.
  const double tolerance = open ? 1e-9 : 0.005;
  if (!height || y > largest * (1 + tolerance)) {
    throw Error(lens.name() + ": f-number = " + to_text(f_number) + "; must be at least " +
                to_text(length / (2 * largest), 10) + " (the fastest the lens can give)");
  }
  if (!open && y > largest) return lens;
  const Obscuration obscuration = widest_obscuration(lens, beam, wavelength, y);
  if (obscuration.height > 0) {
    throw Error(lens.name() + ": f-number = " + to_text(f_number) + "; must be less than " +
                to_text(length / (2 * obscuration.height), 10) + ": the central obscuration of surface " +
                std::to_string(obscuration.surface) + " is that large");
  }
  Lens stopped = with_any_semi_diameter(lens, beam.stop, std::min(*height, stop.semi_diameter));
  // With strong spherical aberration, rays at other heights may meet the stop as far out as the ray of height y.
  const double found = real_f_number(stopped, wavelength);
  if (std::isinf(found)) {
    throw Error(lens.name() + ": f-number = " + to_text(f_number) + "; must be smaller: no ray passes a stop of " +
                to_text(*height) + " mm");
  }
  if (!(std::abs(found - f_number) <= 1e-6 * f_number)) {
    throw Error(lens.name() + ": f-number = " + to_text(f_number) +
                "; must be an f-number that a stop can give, such as " + to_text(found, 10) +
                ": with spherical aberration, other rays meet the rim of the stop");
  }
  return stopped;
}

}  // namespace petzval
