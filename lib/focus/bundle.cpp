// SPDX-License-Identifier: Apache-2.0
#include "bundle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/bisect.hpp"
#include "core/meet_plane.hpp"
#include "core/quadrature.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/pupil_boundary.hpp"
#include "petzval/pupil/pupil_plane.hpp"
#include "petzval/trace/batch.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::inline v0::focus_detail {
namespace {

/// The bundle of one field, its rays where they meet a plane.
class Bundle {
 public:
  Bundle(const Lens& lens, double plane_z, bool edges)
      : lens_(lens), plane_z_(plane_z), sense_(signed_index(lens, lens.surface_count()) > 0 ? 1 : -1), edges_(edges) {}

  void add(const FieldPoint& point, const WavelengthWeight& colour) {
    // On the axis of a lens of revolution one meridian stands for all: its centroid is the axis.
    centred_ = point.field_rad == 0 && lens_.rotationally_symmetric();
    const PupilBoundary outline = pupil_boundary(lens_, point, colour.wavelength, centred_ ? 1 : directions);
    static const auto nodes = core_detail::gauss_legendre<radial>();
    const double cell = outline.half_axes[0] * outline.half_axes[1] * colour.weight;
    std::vector<Ray<double>> rays;
    std::vector<double> weights;
    const auto send = [&](const Place& place, double weight) {
      rays.push_back(outline.plane.ray(place[0], place[1]));
      weights.push_back(weight);
    };
    for (const PupilSpan& span : outline.spans) {
      const double inner = span.from_radius * span.from_radius;
      const double area = (span.to_radius - span.from_radius) * (span.to_radius + span.from_radius);
      for (const core_detail::QuadratureNode& node : nodes) {
        send(outline.at(span.direction, std::sqrt(inner + area * node.x)), cell * area * node.weight);
      }
      if (!edges_) continue;
      send({span.from.x, span.from.y}, 0);
      send({span.to.x, span.to.y}, 0);
    }
    if (edges_) add_corners(outline);
    // Reproducible batches agree with the trace of one ray to the bit: edges found by that pass here too.
    std::vector<TracedRay<double>> ends(rays.size());
    trace<double>(lens_, rays, ends.data(),
                  {.wavelengths = {colour.wavelength}, .arithmetic = Arithmetic::reproducible});
    for (std::size_t i = 0; i < ends.size(); ++i) add_line(ends[i], weights[i]);
  }

  /// Turns the lines into those relative to the centroid, of weights that sum to 1. False where there is no light.
  bool normalise() {
    double total = 0;
    for (const Line& line : lines) total += line.weight;
    if (!(total > 0)) return false;
    Line mean;
    for (Line& line : lines) {
      line.weight /= total;
      if (centred_) continue;
      mean.x += line.weight * line.x, mean.y += line.weight * line.y;
      mean.slope_x += line.weight * line.slope_x, mean.slope_y += line.weight * line.slope_y;
    }
    for (Line& line : lines) {
      line.x -= mean.x, line.y -= mean.y;
      line.slope_x -= mean.slope_x, line.slope_y -= mean.slope_y;
    }
    return true;
  }

  std::vector<Line> lines;

 private:
  static constexpr std::size_t directions = 96, radial = 32;
  using Place = std::array<double, 2>;

  TracedRay<double> traced(const PupilBoundary& outline, const Place& place) const {
    return trace(lens_, outline.plane.ray(place[0], place[1]), {.wavelength = outline.wavelength});
  }

  void add_line(const TracedRay<double>& end, double weight) {
    const auto& [ray, fate, surface] = end;
    if (fate != RayFate::transmitted || !(ray.direction.z * sense_ > 0)) return;
    const auto [x, y, slope_x, slope_y] = core_detail::slope_ray(ray, plane_z_);
    lines.push_back({x, y, slope_x, slope_y, weight});
  }

  /// The corners of a pupil, where one rim takes over from another, lie farther out than the edges beside them: found
  /// between the last direction with the one and the first with the other.
  void add_corners(const PupilBoundary& outline) {
    const std::size_t count = outline.spans.size();
    if (count != outline.directions || count < 3) return;
    for (std::size_t k = 0; k < count; ++k) {
      const PupilSpan &one = outline.spans[k], &other = outline.spans[(k + 1) % count];
      if (one.to.surface == other.to.surface || one.from_radius > 0 || other.from_radius > 0) continue;
      // By the chord, which every line from the middle crosses once.
      const auto edge = [&](double part) {
        const Place chord{one.to.x + part * (other.to.x - one.to.x), one.to.y + part * (other.to.y - one.to.y)};
        const auto at = [&](double reach) {
          return Place{outline.middle[0] + reach * (chord[0] - outline.middle[0]),
                       outline.middle[1] + reach * (chord[1] - outline.middle[1])};
        };
        int surface = one.to.surface;
        const double last = core_detail::last_with(0.5, 2.0, [&](double reach) {
          const auto end = traced(outline, at(reach));
          if (!end.transmitted()) surface = end.surface;
          return end.transmitted();
        });
        return std::pair(at(last), surface);
      };
      const double part = core_detail::last_with(0.0, 1.0, [&](double p) { return edge(p).second == one.to.surface; });
      add_line(traced(outline, edge(part).first), 0);
    }
  }

  const Lens& lens_;
  double plane_z_;
  int sense_;
  bool edges_;
  bool centred_ = false;
};

}  // namespace

std::optional<Image> exact_image(const Lens& lens, double subject_z, std::span<const FocusField> fields,
                                 std::span<const WavelengthWeight> wavelengths, FocusCriterion criterion) {
  const double plane_z = lens.surfaces().back().vertex_z;
  const bool rms = criterion == FocusCriterion::min_rms;
  double total = 0, most = 0;
  for (const FocusField& field : fields) total += field.weight, most = std::max(most, field.weight);

  // A field that does not meet the plane is refused before others are traced.
  for (const FocusField& field : fields) PupilPlane(lens, {field.field_rad, subject_z});

  std::vector<Line> lines;
  for (const FocusField& field : fields) {
    Bundle bundle(lens, plane_z, !rms);
    for (const WavelengthWeight& colour : wavelengths) bundle.add({field.field_rad, subject_z}, colour);
    if (!bundle.normalise()) return {};
    for (Line line : bundle.lines) {
      if (rms) {
        line.weight *= field.weight / total;
      } else {
        const double scale = field.weight / most;
        line.x *= scale, line.y *= scale, line.slope_x *= scale, line.slope_y *= scale;
      }
      lines.push_back(line);
    }
  }
  return rms ? least_rms(lines, plane_z) : least_maximum(std::move(lines), plane_z);
}

}  // namespace petzval::inline v0::focus_detail
