// SPDX-License-Identifier: Apache-2.0
#include "textbook_pupil.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "petzval/core/error.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "text.hpp"

namespace examples {
namespace {

using namespace petzval;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Rays of one axial point in the main meridian, indexed by their signed distance p from the vertex of the surface that
/// they meet first: the sine of the ray's angle is p divided by the distance of the point, which may be infinite.
class AxialFan {
 public:
  AxialFan(const Lens& lens, Travel travel, double point_z, Wavelength wavelength)
      : lens_(lens),
        options_{.travel = travel, .wavelength = wavelength},
        first_(travel == Travel::to_film ? 0 : lens.surface_count() - 1),
        along_y_(main_meridian(lens, wavelength) == Meridian::y) {
    const std::size_t space = travel == Travel::to_film ? 0 : lens.surface_count();
    forward_ = (travel == Travel::to_film) == (lens.light_direction(space) > 0) ? 1 : -1;
    distance_ = std::isinf(point_z) ? infinity : forward_ * (lens.surfaces()[first_].vertex_z - point_z);
  }

  /// The ray at distance p from the vertex. It starts at its point nearest to the vertex, so that the rounding of its
  /// direction does not grow with the distance of the object.
  Ray<double> ray(double p) const noexcept {
    const double sine = p / distance_, cosine = std::sqrt((1 - sine) * (1 + sine));
    return {placed(p * cosine, lens_.surfaces()[first_].vertex_z - forward_ * p * sine),
            placed(sine, forward_ * cosine)};
  }

  TracedRay<double> trace(double p) const noexcept { return petzval::trace(lens_, ray(p), options_); }

  /// Distance p of the ray to the point of the first surface at a height; at most the p of a ray at a right angle to
  /// the axis.
  double towards(double height) const noexcept {
    const double sag = petzval::sag(lens_, first_, along_y_ ? 0 : height, along_y_ ? height : 0);
    const double depth = distance_ + forward_ * (std::isnan(sag) ? 0 : sag);
    if (std::isinf(distance_)) return height;
    return depth * distance_ > 0 ? std::abs(distance_) * height / std::hypot(height, depth) : std::abs(distance_);
  }

  /// Height of the ray in the plane at z.
  double height_at(double p, double z) const noexcept {
    if (std::isinf(z)) return infinity;
    const auto [origin, direction] = ray(p);
    const double distance = (z - origin.z) / direction.z;
    return along_y_ ? origin.y + distance * direction.y : origin.x + distance * direction.x;
  }

  bool at_vertex() const noexcept { return distance_ == 0; }

  /// The start height: the rim of the first surface, or the widest rim if the first surface has no rim.
  double rim() const noexcept {
    const double own = lens_.surfaces()[first_].semi_diameter;
    if (std::isfinite(own)) return own;
    double widest = 1;
    for (const LensSurface& s : lens_.surfaces()) {
      if (std::isfinite(s.semi_diameter)) widest = std::max(widest, s.semi_diameter);
    }
    return widest;
  }

 private:
  Vec3<double> placed(double across, double z) const noexcept {
    return along_y_ ? Vec3<double>{0, across, z} : Vec3<double>{across, 0, z};
  }

  const Lens& lens_;
  TraceOptions options_;
  std::size_t first_;
  bool along_y_;
  double forward_ = 1;   // sign of the ray's direction along z
  double distance_ = 0;  // from the point to the vertex; negative for a converging beam
};

TextbookPupil textbook_pupil(const Lens& lens, Travel travel, double point_z, Wavelength wavelength) {
  const bool entrance = travel == Travel::to_film;
  const std::string where = lens.name() + ": textbook " + (entrance ? "entrance" : "exit") + " pupil: ";
  lens.index(0, wavelength);  // throws if the wavelength was not compiled
  const Pupils paraxial = pupils(lens, wavelength, main_meridian(lens, wavelength));
  const AxialFan fan(lens, travel, point_z, wavelength);
  if (std::isnan(point_z) || fan.at_vertex()) {
    throw Error(where + (entrance ? "object_z" : "film_z") + " = " + number(point_z) +
                " mm; must be infinite or differ from the vertex of the lens");
  }
  const auto passes = [&](double p) { return fan.trace(p).transmitted(); };
  if (const auto axial = fan.trace(0); !axial.transmitted()) {
    throw Error(where + "the ray along the axis ends at surface " + std::to_string(axial.surface) + " (" +
                std::string(name(axial.fate)) + "); must pass, because the bisection starts from it");
  }

  // Steps 1 to 5. The ray to the rim is tried first; without a rim, the height doubles.
  double height = fan.rim(), outermost = fan.towards(height);
  const bool limited = std::isfinite(lens.surfaces()[entrance ? 0 : lens.surface_count() - 1].semi_diameter);
  while (!limited && passes(outermost) && height < 1e100) outermost = fan.towards(height *= 2);
  if (!passes(outermost)) {
    double last = 0, first = outermost;  // brackets the edge: a ray that passes and a lost ray
    for (double middle = first / 2; middle > last && middle < first; middle = last + (first - last) / 2) {
      (passes(middle) ? last : first) = middle;
    }
    outermost = last;
  }

  // Steps 6 to 8.
  const Pupil& image = entrance ? paraxial.entrance : paraxial.exit;
  const auto next = fan.trace(std::nextafter(outermost, infinity));
  return {.z = image.z,
          .diameter = 2 * std::abs(fan.height_at(outermost, image.z)),
          .limiting =
              next.transmitted() ? (entrance ? 0 : lens.surface_count() - 1) : static_cast<std::size_t>(next.surface),
          .next_fate = next.transmitted() ? RayFate::vignetted : next.fate,
          .marginal = fan.ray(outermost)};
}

}  // namespace

TextbookPupil textbook_entrance_pupil(const Lens& lens, double object_z, Wavelength wavelength) {
  return textbook_pupil(lens, Travel::to_film, object_z, wavelength);
}

TextbookPupil textbook_exit_pupil(const Lens& lens, double film_z, Wavelength wavelength) {
  return textbook_pupil(lens, Travel::to_scene, film_z, wavelength);
}

}  // namespace examples
