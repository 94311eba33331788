// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <optional>

#include "core/text.hpp"
#include "iris/iris_shape.hpp"
#include "iris/iris_weights.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

/// Samples of an iris, distributed by its weights. A tenth of the samples is uniform, so that no sample weight is
/// large.
struct WeightedIris {
  iris_detail::IrisShape shape;
  std::optional<iris_detail::IrisWeights> weights;  ///< empty if the lens has no weights

  explicit WeightedIris(const ThinLens& lens) : shape(lens.iris) {
    if (lens.edge.distribution == 0 && lens.map.empty()) return;
    weights.emplace(lens.iris, lens.edge, lens.map, 0.1, "thin lens: ");
  }
};

}  // namespace

LensRays LensRays::thin(const LayerCamera& camera, const ThinLens& lens, std::span<const PupilPoint> points,
                        const LensRaysOptions& options) {
  const auto wrong = [](const std::string& what) { return Error("thin lens: " + what); };
  if (!(lens.radius_mm >= 0 && std::isfinite(lens.radius_mm))) {
    throw wrong("radius = " + to_text(lens.radius_mm) + " mm; must be finite and at least 0");
  }
  if (!(lens.inverse_focus >= 0 && 2 * lens.radius_mm * lens.inverse_focus < 1)) {
    throw wrong("inverse depth in focus = " + to_text(lens.inverse_focus) +
                " / mm; must be at least 0, and its depth above the diameter of the lens, " +
                to_text(2 * lens.radius_mm) + " mm");
  }
  if (!lens.map.empty()) iris_detail::check(lens.map, "thin lens: ");
  const bool even = lens.edge.even() && lens.map.empty();
  const auto weighted = std::make_shared<const WeightedIris>(lens);
  const bool coloured = lens.colour_shift != Vec3<double>{0, 0, 0};

  const auto source = [=, radius = lens.radius_mm, inverse_focus = lens.inverse_focus, focus = lens.focus,
                       shift = lens.colour_shift, focal = camera.focal_px](int channel, const Vec2<double>& raster,
                                                                           std::span<const PupilPoint> pupil_points,
                                                                           std::span<LayerRay> found) {
    const FocusAt at = focus ? focus(raster) : FocusAt{inverse_focus, 1};
    const double in_focus = at.inverse_depth + (coloured ? shift[channel] : 0.0),
                 scale = focal * radius * at.pupil_scale;
    for (std::size_t i = 0; i < pupil_points.size(); ++i) {
      double u = pupil_points[i].u, v = pupil_points[i].v, weight = 1;
      if (!even) {
        const auto sample = weighted->weights->draw(u, v);
        u = sample.u, v = sample.v;
        weight = weighted->weights->of_sample(u, v) / (sample.density * weighted->weights->mean());
      }
      const Vec2<double> stop_point = weighted->shape.sample(u, v), slope{scale * stop_point.x, -scale * stop_point.y};
      found[i] = {raster - slope * in_focus, slope, weight};
    }
  };
  return LensRays(camera, points, coloured ? 3 : 1, source, options);
}

}  // namespace petzval
