// SPDX-License-Identifier: Apache-2.0
#include "bokeh_flags.hpp"

#include <iostream>

#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"
#include "text.hpp"

namespace examples {

bool BokehFlags::change_nothing() const noexcept {
  return iris_image.empty() && weight_map.empty() && controls.edge().even() && !controls.vignettes();
}

void add_bokeh(App& app, BokehFlags& flags) {
  petzval::BokehControls& c = flags.controls;
  app.add_option("--iris-image", flags.iris_image,
                 "grey PNG or EXR over the square around the stop's rim, +x to the right and +y up: the fraction of "
                 "the light that passes, 0 to 1")
      ->type_name("FILE");
  add_number(app, "--lens-ratio", c.lens_ratio, positive_number,
             "radius of the second rim that clips cat's eyes, divided by the radius of the pupil on the axis");
  add_number(app, "--rate-of-change", c.rate_of_change, finite_number,
             "pupil radii by which that rim moves, opposite to the film point, from the axis to half of the film's "
             "longer side (psf: 18 mm)");
  app.add_flag("--keep-light", c.keep_light, "clipped pupils keep the light of the unclipped pupil");
  add_number(app, "--weight-distribution", c.weight_distribution, finite_number,
             "d of the weight 1 + p (|d| + 1) x^|d| - p, x: fraction of the iris area nearer to the centre, or farther "
             "from it if d is below 0 (bright centre)");
  add_number(app, "--weight-strength", c.weight_strength, finite_number,
             "p of the weight, 0 to 1; outside this range weights may fall below 0 and are then set to 0");
  app.add_option("--weight-map", flags.weight_map,
                 "grey PNG or EXR like --iris-image: weights, normalized to a mean of 1 over the iris")
      ->type_name("FILE");
}

petzval::BokehControls controls_of(const BokehFlags& flags) {
  petzval::BokehControls result = flags.controls;
  if (result.keep_light && !result.vignettes()) {
    throw petzval::Error(
        "--keep-light needs --lens-ratio or --rate-of-change: without them no second rim clips the pupil");
  }
  if (result.weight_distribution == 0 && result.weight_strength != petzval::EdgeWeight{}.strength) {
    throw petzval::Error("--weight-strength needs --weight-distribution: without it all weights are 1");
  }
  if (!flags.iris_image.empty() && !flags.weight_map.empty()) {
    throw petzval::Error("--weight-map cannot be combined with --iris-image");
  }
  if (!flags.iris_image.empty()) {
    result.weight_map = petzval::read_iris_map(flags.iris_image);
    for (const float transmittance : result.weight_map.values) {
      if (transmittance > 1) {
        throw petzval::Error(flags.iris_image + ": value = " + number(transmittance) +
                             "; must be a fraction of the light from 0 to 1");
      }
    }
  }
  if (!flags.weight_map.empty()) {
    result.weight_map = petzval::read_iris_map(flags.weight_map);
    result.weight_map.keep_mean = true;
  }
  if (const double added = result.edge().light_added(); added > 0) {
    std::cerr << "note: negative weights are set to 0, which adds " << number(100 * added, 3) << " % of the light\n";
  }
  return result;
}

}  // namespace examples
