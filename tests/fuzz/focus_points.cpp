// SPDX-License-Identifier: Apache-2.0
// Films fitted to any focus points.
#include <vector>

#include "fit/fit_to_rays.hpp"
#include "laws.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/focus/autofocus.hpp"
#include "wild_lens.hpp"

namespace {

using namespace petzval;

std::vector<FocusTarget> wild_targets(fuzz::Bytes& bytes) {
  std::vector<FocusTarget> targets;
  for (int i = bytes.count(0, 8); i > 0; --i) {
    FocusTarget target{.point = {{bytes.number(-500, 500), bytes.number(-500, 500), bytes.number(-3000, -60)}}};
    const int kind = bytes.byte();
    if (kind < 32) target.blur_mm = bytes.number(-0.2, 0.2);
    if (kind % 8 == 1) target.weight = bytes.number(0, 4);
    if (kind % 32 == 2) target.point.at_infinity = true;
    if (kind % 32 == 3) target.fixes_distance = false;
    targets.push_back(target);
  }
  return targets;
}

void check(const Film& film) {
  fuzz::require(!film.z_mm || !std::isnan(*film.z_mm), "the position of a film is not NaN");
  fuzz::require(std::isfinite(film.tilt_rad) && std::isfinite(film.swing_rad), "tilt and swing of a film are finite");
}

void tilt(const auto& lens, const std::vector<FocusTarget>& targets, const TiltOptions& options) {
  const TiltFit fit = fit_tilt(lens, targets, options);
  fuzz::require(fit.blurs.size() == targets.size(), "each target has a blur");
  fuzz::require(!std::isnan(fit.rms_mm), "the error of a fit is not NaN");
  check(fit.film);
  if (!fit) return;
  fuzz::require(fit.film.z_mm && std::isfinite(*fit.film.z_mm), "the position of a fitted film is finite");
  fuzz::require(fit.film.angle() <= options.max_tilt_rad + 1e-6, "a fit keeps the limit of tilt");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const int work = bytes.byte();
    TiltOptions options{.robust = bytes.one_in(2)};
    options.film = {.width_mm = bytes.number(0, 40), .height_mm = bytes.number(0, 30)};
    const int kind = bytes.byte();
    if (kind < 16) options.film.tilt_rad = bytes.number(-0.5, 0.5);
    if (kind % 16 == 1) options.max_tilt_rad = bytes.number(0, 1.5);
    if (kind % 16 == 2) options.film.shift_y_mm = bytes.number(-20, 20);
    if (work < 8) {  // exact rays, a thousand times as slow
      const Lens glass = fuzz::wild_lens(bytes);
      const ImageRays lens(glass, bytes.number(1, 20), 16);
      const auto targets = wild_targets(bytes);
      if (work < 4) return tilt(lens, targets, options);
      return check(autofocus(lens, targets, {}, work % 2 ? FocusCriterion::min_rms : FocusCriterion::min_max).film);
    }
    const auto wild_thin_lens = [&] {
      const double focal_length = bytes.number(5, 300);
      return thin_lens(focal_length, bytes.number(0.8, 32));
    };
    const IdealLens lens = work < 64 ? thick_lens(fuzz::wild_lens(bytes)) : wild_thin_lens();
    if (work < 160) return tilt(lens, wild_targets(bytes), options);
    check(autofocus(lens, wild_targets(bytes)).film);
  });
  return 0;
}
