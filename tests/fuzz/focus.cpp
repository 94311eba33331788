// SPDX-License-Identifier: Apache-2.0
// Any lens: focus by every criterion, and derived results.
#include "petzval/focus/focus.hpp"

#include "laws.hpp"
#include "petzval/pupil/f_number.hpp"
#include "wild_lens.hpp"

namespace {

using namespace petzval;

void check(const FocusSolution& found) {
  fuzz::require(!std::isnan(found.film_z) && !std::isnan(found.subject_z) && !std::isnan(found.distance),
                "a focus contains no NaN");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const int exact = bytes.byte();  // rare, because they trace thousands of rays
    FocusOptions options{.criterion = exact < 16    ? FocusCriterion::min_max
                                      : exact < 64  ? FocusCriterion::min_rms
                                      : exact < 160 ? FocusCriterion::paraxial
                                                    : FocusCriterion::thin};
    options.origin = static_cast<DistanceOrigin>(bytes.count(0, 3));
    const int work = bytes.count(0, 6);
    const Lens lens = fuzz::wild_lens(bytes);
    if (bytes.one_in(8)) options.fields.push_back({bytes.number(0, 0.5), bytes.number(0, 2)});
    const double distance = bytes.one_in(4) ? HUGE_VAL : bytes.number(50, 1e4), blur = bytes.number(0.001, 0.1);
    const double film_z = bytes.number(0, 300);
    switch (work) {
      case 0: {
        const FocusSolution found = solve_focus(lens, distance, options);
        if (found) fuzz::require(std::isfinite(found.film_z), "the position of a film in focus is finite");
        return check(found);
      }
      case 1: return check(solve_subject(lens, film_z, options));
      case 2: return check(nearest_focus(lens, options));
      case 3: {
        const auto found = blur_diameter(lens, distance, options);
        return fuzz::require(!found || *found >= 0, "a blur diameter is 0 or more");
      }
      case 4: {
        const DepthOfField found = depth_of_field(lens, blur, options);
        if (found) fuzz::require(found.near_distance <= found.far_distance, "the near limit is at most the far limit");
        return;
      }
      case 5: return check(hyperfocal(lens, blur, options));
      default: {
        const Lens focused = with_focus(lens, distance, options);
        fuzz::require(std::isfinite(focused.film_z()), "the film of a focused lens is finite");
        const auto growth = breathing(focused, film_z, options);
        fuzz::require(!growth || !std::isnan(*growth), "breathing is not NaN");
      }
    }
  });
  return 0;
}
