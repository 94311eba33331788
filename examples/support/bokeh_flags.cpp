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
  app.add_option(
         "--iris-image", flags.iris_image,
         "grey PNG or EXR over the square around the stop's rim, seen with +x to the right and +y up: the share "
         "of the light that passes")
      ->type_name("FILE");
  add_number(app, "--lens-ratio", c.lens_ratio, positive_number,
             "radius of a second rim, over that of the pupil on the axis, that cuts cat's eyes");
  add_number(
      app, "--rate-of-change", c.rate_of_change, finite_number,
      "by how many radii of the pupil that rim moves against the film point from the axis to half of the film's longer "
      "side (bokeh_psf: to 18 mm)");
  app.add_flag("--keep-light", c.keep_light, "cat's eyes keep the light of the whole pupil");
  add_number(app, "--weight-distribution", c.weight_distribution, finite_number,
             "d of the weight 1 + p (|d| + 1) x^|d| - p, x: the share of the iris nearer to the centre; below 0 the "
             "share farther from it, so that the middle is bright");
  add_number(app, "--weight-strength", c.weight_strength, finite_number,
             "p of the weight, 0 to 1; weights below 0, which others may give, are cut");
  app.add_option("--weight-map", flags.weight_map,
                 "grey PNG or EXR like --iris-image: weights, divided by their mean over the iris")
      ->type_name("FILE");
}

petzval::BokehControls controls_of(const BokehFlags& flags) {
  petzval::BokehControls result = flags.controls;
  if (result.keep_light && !result.vignettes()) {
    throw petzval::Error(
        "--keep-light: found it without --lens-ratio and --rate-of-change, wanted one of them: no rim cuts cat's eyes");
  }
  if (result.weight_distribution == 0 && result.weight_strength != petzval::EdgeWeight{}.strength) {
    throw petzval::Error(
        "--weight-strength: found it without --weight-distribution, wanted one: without it all weights are 1");
  }
  if (!flags.iris_image.empty() && !flags.weight_map.empty()) {
    throw petzval::Error("--weight-map: found an --iris-image as well, wanted one of them");
  }
  if (!flags.iris_image.empty()) {
    result.weight_map = petzval::read_iris_map(flags.iris_image);
    for (const float share : result.weight_map.values) {
      if (share > 1) {
        throw petzval::Error(flags.iris_image + ": found " + number(share) +
                             ", wanted shares of the light from 0 to 1");
      }
    }
  }
  if (!flags.weight_map.empty()) {
    result.weight_map = petzval::read_iris_map(flags.weight_map);
    result.weight_map.keep_mean = true;
  }
  if (const double added = result.edge().light_added(); added > 0) {
    std::cerr << "note: weights below 0 are cut, which adds " << number(100 * added, 3) << " % of the light\n";
  }
  return result;
}

}  // namespace examples
