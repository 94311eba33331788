// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/focus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "root.hpp"
#include "solver.hpp"

namespace petzval {
namespace {

using enum FocusStatus;
constexpr double infinity = std::numeric_limits<double>::infinity();

void check_blur(const Lens& lens, double blur_mm) {
  if (!(blur_mm > 0 && std::isfinite(blur_mm))) {
    throw Error(lens.name() + ": blur = " + to_text(blur_mm) + " mm; must be finite and above 0");
  }
}

/// The blur on the film of the lens minus the allowed blur, as a function of the subject's vergence.
class Excess {
 public:
  Excess(const focus_detail::FocusSolver& solver, double film_z, double blur)
      : solver_(solver), film_z_(film_z), blur_(blur) {}

  double operator()(double vergence) const {
    const auto image = solver_.image_at(vergence);
    // Limited, because root() needs finite numbers.
    return image ? std::min(image->diameter(film_z_), 4 * blur_) - blur_ : 3 * blur_;
  }

 private:
  const focus_detail::FocusSolver& solver_;
  double film_z_, blur_;
};

}  // namespace

std::optional<double> blur_diameter(const Lens& lens, double distance, const FocusOptions& options) {
  focus_detail::check_distance(lens, distance);
  const focus_detail::FocusSolver solver(lens, options);
  if (solver.afocal()) return {};
  const double origin_z = options.origin == DistanceOrigin::film ? lens.film_z() : solver.conjugates().origin_z;
  const auto image = solver.image(origin_z - distance);
  return image ? std::optional(image->diameter(lens.film_z())) : std::nullopt;
}

DepthOfField depth_of_field(const Lens& lens, double blur_mm, const FocusOptions& options) {
  check_blur(lens, blur_mm);
  const focus_detail::FocusSolver solver(lens, options);
  if (solver.afocal()) return {.status = afocal};
  const double film_z = lens.film_z();
  const FocusSolution in_focus = solver.subject(film_z);
  if (in_focus.status == no_rays || !solver.image(-infinity)) return {.status = no_rays};

  const focus_detail::Conjugates& c = solver.conjugates();
  const Excess excess(solver, film_z, blur_mm);
  const double vertex = c.vergence_of_vertex();
  const double middle = std::min(c.vergence(in_focus.subject_z), vertex);
  if (excess(middle) > 0) return {.status = too_blurred};

  const auto distance = [&](double vergence) {
    return vergence > 0 ? c.distance(c.subject_at(vergence), film_z) : infinity;
  };
  const double rounding = 1e-12 * blur_mm;  // at the hyperfocal distance, the blur of infinity is blur_mm
  const double far = excess(0) > rounding ? focus_detail::root(excess, 0, middle) : 0;
  double near = middle;
  for (double low = middle, step = (vertex - middle) / 1024; near < vertex && near == low; step *= 2) {
    const double high = std::min(low + step, vertex);
    near = excess(high) > 0 ? focus_detail::root(excess, low, high) : high;
    low = high;
  }
  return {solved, distance(near), distance(far)};
}

FocusSolution hyperfocal(const Lens& lens, double blur_mm, const FocusOptions& options) {
  check_blur(lens, blur_mm);
  const focus_detail::FocusSolver solver(lens, options);
  if (solver.afocal()) return {.status = afocal};
  const auto infinite = solver.image(-infinity);
  if (!infinite) return {.status = no_rays};
  const double focus = infinite->film_z;
  if (!(infinite->diameter(focus) <= blur_mm)) return {too_blurred, focus, -infinity, infinity};

  // The film moves behind the infinity focus until the blur of infinity reaches blur_mm.
  const focus_detail::Conjugates& c = solver.conjugates();
  const auto excess = [&](double shift) { return infinite->diameter(focus + c.direction * shift) - blur_mm; };
  // The shift must be large enough to change `focus` despite rounding.
  double shift = std::max(blur_mm, 4 * std::numeric_limits<double>::epsilon() * std::abs(focus));
  for (int i = 0; i < 100 && excess(shift) <= 0; ++i) shift *= 2;
  if (excess(shift) <= 0) return solver.nearest();
  return solver.subject(focus + c.direction * focus_detail::root(excess, 0, shift));
}

std::optional<double> breathing(const Lens& lens, double film_z, const FocusOptions& options) {
  focus_detail::check_film(lens, film_z);
  const focus_detail::FocusSolver solver(lens, options);
  if (solver.afocal()) return {};
  const FocusSolution infinite = solver.focus(infinity);
  if (!infinite) return {};
  const double exit_z = pupils(lens, solver.wavelength(), solver.meridian()).exit.z;
  if (std::isinf(exit_z)) return 0;
  if (infinite.film_z == exit_z) return {};
  return (film_z - infinite.film_z) / (infinite.film_z - exit_z);
}

}  // namespace petzval
