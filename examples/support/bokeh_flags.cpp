// SPDX-License-Identifier: Apache-2.0
#include "bokeh_flags.hpp"

#include <algorithm>
#include <iostream>

#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"
#include "text.hpp"

namespace examples {

bool plain_bokeh(const petzval::CameraSetup& setup) noexcept {
  const petzval::BokehControls& controls = setup.camera.bokeh;
  return setup.iris_map.empty() && controls.edge().even() && !controls.vignettes() && controls.blades == 0;
}

void add_bokeh(App& app, petzval::CameraSetup& setup) {
  petzval::BokehControls& c = setup.camera.bokeh;
  const auto map = [&setup](bool keep_mean) {
    return [&setup, keep_mean](const std::string& file) {
      setup.iris_map = file, setup.camera.bokeh.weight_map.keep_mean = keep_mean;
    };
  };
  const Option* const image =
      app.add_option("--iris-image", map(false),
                     "grey PNG or EXR over the square around the stop's rim, +x to the right and +y up: the fraction "
                     "of the light that passes, 0 to 1")
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
  const Option* const weights =
      app.add_option("--weight-map", map(true),
                     "grey PNG or EXR like --iris-image: weights, normalized to a mean of 1 over the iris")
          ->type_name("FILE");
  app.add_check([image, weights] {
    if (image->given() && weights->given()) throw petzval::Error("--weight-map cannot be combined with --iris-image");
  });
}

petzval::BokehControls controls_of(const petzval::CameraSetup& setup) {
  petzval::BokehControls result = setup.camera.bokeh;
  if (result.keep_light && !result.vignettes()) {
    throw petzval::Error(
        "--keep-light needs --lens-ratio or --rate-of-change: without them no second rim clips the pupil");
  }
  if (result.weight_distribution == 0 && result.weight_strength != petzval::EdgeWeight{}.strength) {
    throw petzval::Error("--weight-strength needs --weight-distribution: without it all weights are 1");
  }
  if (!setup.iris_map.empty()) {
    const bool weights = result.weight_map.keep_mean;
    result.weight_map = petzval::read_iris_map(setup.iris_map);
    result.weight_map.keep_mean = weights;
    const float most = std::ranges::max(result.weight_map.values);
    if (!weights && most > 1) {
      throw petzval::Error(setup.iris_map + ": value = " + number(most) +
                           "; must be a fraction of the light from 0 to 1");
    }
  }
  if (const double added = result.edge().light_added(); added > 0) {
    std::cerr << "note: negative weights are set to 0, which adds " << number(100 * added, 3) << " % of the light\n";
  }
  return result;
}

}  // namespace examples
