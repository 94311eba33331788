// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/depth_of_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "petzval/paraxial/pupils.hpp"
#include "root.hpp"

namespace petzval::inline v0 {
namespace {

using enum FocusStatus;
constexpr double infinity = std::numeric_limits<double>::infinity();

void check_blur(const Lens& lens, double blur_mm) {
  if (!(blur_mm > 0 && std::isfinite(blur_mm))) {
    throw Error(lens.name() + ": blur is " + number(blur_mm) + " mm, wanted a finite diameter above 0");
  }
}

/// Blur on the lens's film over the nearness of the subject, less the one asked for.
class Excess {
 public:
  Excess(const focus_detail::FocusModel& model, double film_z, double blur)
      : model_(model), film_z_(film_z), blur_(blur) {}

  double operator()(double nearness) const {
    const auto image = model_.image_at(nearness);
    // Capped: the search wants finite numbers.
    return image ? std::min(image->diameter(film_z_), 4 * blur_) - blur_ : 3 * blur_;
  }

 private:
  const focus_detail::FocusModel& model_;
  double film_z_, blur_;
};

}  // namespace

std::optional<double> blur_diameter(const Lens& lens, double distance_mm, const FocusOptions& options) {
  focus_detail::check_distance(lens, distance_mm);
  const focus_detail::FocusModel model(lens, options);
  if (model.afocal()) return {};
  const double origin_z = options.origin == DistanceOrigin::film ? lens.film_z() : model.conjugates().origin_z;
  const auto image = model.image(origin_z - distance_mm);
  return image ? std::optional(image->diameter(lens.film_z())) : std::nullopt;
}

DepthOfField depth_of_field(const Lens& lens, double blur_mm, const FocusOptions& options) {
  check_blur(lens, blur_mm);
  const focus_detail::FocusModel model(lens, options);
  if (model.afocal()) return {.status = afocal};
  const double film_z = lens.film_z();
  const FocusSolution in_focus = model.subject(film_z);
  if (in_focus.status == no_rays || !model.image(-infinity)) return {.status = no_rays};

  const focus_detail::Conjugates& c = model.conjugates();
  const Excess excess(model, film_z, blur_mm);
  const double vertex = c.nearness_of_vertex();
  const double middle = std::min(c.nearness(in_focus.subject_z), vertex);
  if (excess(middle) > 0) return {.status = too_blurred};

  const auto distance = [&](double nearness) {
    return nearness > 0 ? c.distance(c.subject_at(nearness), film_z) : infinity;
  };
  const double rounding = 1e-12 * blur_mm;  // a lens at its hyperfocal distance is sharp to infinity
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
  const focus_detail::FocusModel model(lens, options);
  if (model.afocal()) return {.status = afocal};
  const auto infinite = model.image(-infinity);
  if (!infinite) return {.status = no_rays};
  const double focus = infinite->film_z;
  if (!(infinite->diameter(focus) <= blur_mm)) return {too_blurred, focus, -infinity, infinity};

  // The film as far behind infinity's focus as that stays sharp enough.
  const focus_detail::Conjugates& c = model.conjugates();
  const auto excess = [&](double shift) { return infinite->diameter(focus + c.sense * shift) - blur_mm; };
  double shift = blur_mm;
  for (int i = 0; i < 100 && excess(shift) <= 0; ++i) shift *= 2;
  if (excess(shift) <= 0) return model.nearest();
  return model.subject(focus + c.sense * focus_detail::root(excess, 0, shift));
}

std::optional<double> breathing(const Lens& lens, double film_z, const FocusOptions& options) {
  focus_detail::check_film(lens, film_z);
  const focus_detail::FocusModel model(lens, options);
  if (model.afocal()) return {};
  const FocusSolution infinite = model.focus(infinity);
  if (!infinite) return {};
  const double exit_z = pupils(lens, model.wavelength(), model.meridian()).exit.z;
  if (std::isinf(exit_z)) return 0;
  if (infinite.film_z == exit_z) return {};
  return (film_z - infinite.film_z) / (infinite.film_z - exit_z);
}

}  // namespace petzval::inline v0
