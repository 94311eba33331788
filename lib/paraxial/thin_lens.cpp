// SPDX-License-Identifier: Apache-2.0
#include "petzval/paraxial/ideal_lens.hpp"

#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

void require(bool holds, const char* where, const char* what, double found, const char* rule) {
  if (!holds) throw Error(std::string(where) + ": " + what + " = " + to_text(found) + " mm; must be " + rule);
}

}  // namespace

double thin_lens_blur_diameter(double focal_length, double diameter, double subject, double focused) {
  constexpr auto where = "thin_lens_blur_diameter";
  require(focal_length > 0 && std::isfinite(focal_length), where, "focal length", focal_length, "finite and above 0");
  require(diameter >= 0 && std::isfinite(diameter), where, "diameter", diameter, "finite and at least 0");
  require(subject > 0, where, "subject distance", subject, "above 0");
  require(focused > focal_length, where, "focused distance", focused, "above the focal length");

  // Distances are subtracted, not their reciprocals: a difference of reciprocals would lose digits near the focus.
  if (diameter == 0) return 0;
  if (std::isinf(focused)) return std::isinf(subject) ? 0 : diameter * (focal_length / subject);
  if (std::isinf(subject)) return diameter * (focal_length / (focused - focal_length));
  // The difference is divided by the farther distance first: no product of 0 and infinity.
  if (subject > focused) return diameter * (focal_length / (focused - focal_length) * ((subject - focused) / subject));
  return diameter * (focal_length / subject * ((focused - subject) / (focused - focal_length)));
}

double thin_lens_extension(double focal_length, double subject) {
  constexpr auto where = "thin_lens_extension";
  require(focal_length > 0 && std::isfinite(focal_length), where, "focal length", focal_length, "finite and above 0");
  require(subject > focal_length, where, "subject distance", subject, "above the focal length");
  return focal_length * (focal_length / (subject - focal_length));
}

double thin_lens_subject(double focal_length, double extension) {
  constexpr auto where = "thin_lens_subject";
  require(focal_length > 0 && std::isfinite(focal_length), where, "focal length", focal_length, "finite and above 0");
  require(extension >= 0, where, "extension", extension, "at least 0");
  return focal_length + focal_length * (focal_length / extension);
}

double thin_lens_film_distance(double focal_length, double subject_to_film) {
  constexpr auto where = "thin_lens_film_distance";
  require(focal_length > 0 && std::isfinite(focal_length), where, "focal length", focal_length, "finite and above 0");
  require(subject_to_film >= 4 * focal_length, where, "distance from subject to film", subject_to_film,
          "at least 4 focal lengths");
  // Ratios do not overflow, and the difference from 4 f is exact near 4 f.
  const double root = std::sqrt((subject_to_film - 4 * focal_length) / subject_to_film);
  return std::isinf(subject_to_film) ? focal_length : 2 * focal_length / (1 + root);
}

}  // namespace petzval
