// SPDX-License-Identifier: Apache-2.0
#include "exact_image.hpp"

#include <algorithm>
#include <utility>

#include "pupil/pupil_boundary.hpp"
#include "pupil/pupil_nodes.hpp"
#include "pupil/pupil_plane.hpp"
#include "pupil/trace_rays.hpp"

namespace petzval::focus_detail {
namespace {

/// The rays of one field at all wavelengths and, if `rims`, the rays along the rims of its pupils. nullopt if no ray
/// passes.
std::optional<RayBundle> field_rays(const Lens& lens, const FieldPoint& point,
                                    std::span<const WavelengthWeight> wavelengths, double plane_z, bool rims) {
  // On the axis of a lens of revolution one meridian suffices, and the centroid is on the axis.
  const bool on_axis = point.field_rad == 0 && lens.rotationally_symmetric();
  constexpr std::size_t directions = 96;
  RayBundle bundle;
  bundle.plane_z = plane_z;
  for (const auto& [wavelength, weight] : wavelengths) {
    const PupilBoundary boundary = pupil_boundary(lens, point, wavelength, on_axis ? 1 : directions);
    RayBundle rays = pupil_detail::trace_nodes(lens, boundary, plane_z);
    for (double& w : rays.weights) w *= weight;
    pupil_detail::append(bundle, rays);
    if (rims) pupil_detail::append(bundle, pupil_detail::trace_rim(lens, boundary, plane_z));
  }
  if (!centre(bundle, on_axis)) return {};
  return bundle;
}

}  // namespace

std::optional<Image> exact_image(const Lens& lens, double subject_z, std::span<const FocusField> fields,
                                 std::span<const WavelengthWeight> wavelengths, FocusCriterion criterion) {
  const bool rms = criterion == FocusCriterion::min_rms;
  double total = 0, most = 0;
  for (const FocusField& field : fields) total += field.weight, most = std::max(most, field.weight);

  // Rejects fields that do not meet the plane before any field is traced.
  for (const FocusField& field : fields) PupilPlane(lens, {field.field_rad, subject_z});

  RayBundle all;
  all.plane_z = lens.surfaces().back().vertex_z;
  for (const FocusField& field : fields) {
    auto rays = field_rays(lens, {field.field_rad, subject_z}, wavelengths, all.plane_z, !rms);
    if (!rays) return {};
    if (rms) {
      for (double& weight : rays->weights) weight *= field.weight / total;
    } else {
      for (auto* values : {&rays->x, &rays->y, &rays->slope_x, &rays->slope_y}) {
        for (double& value : *values) value *= field.weight / most;
      }
    }
    pupil_detail::append(all, *rays);
  }
  return rms ? least_rms(all) : least_maximum(std::move(all));
}

}  // namespace petzval::focus_detail
