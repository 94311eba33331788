// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "text_file.hpp"
#include "written_lens.hpp"

namespace petzval {
namespace {

using namespace formats_detail;

/// Readers interpret a thickness of 0 in a special way: at the first glass as gaps in front of surfaces, and at the
/// last surface as a film without a position.
constexpr double zero_thickness_mm = 1e-9;

/// Renderers interpret radius 0 as the stop. A sphere this flat departs from a plane by 5e-5 mm at 10 mm from the axis.
constexpr double plane_radius_mm = 1e6;

std::string cells(double radius, double thickness, double index, double diameter) {
  return to_text(radius) + '\t' + to_text(thickness) + '\t' + to_text(index) + '\t' + to_text(diameter);
}

}  // namespace

ExportedLens format_table(const Prescription& prescription, const GlassCatalogue* glasses) {
  Writer out(prescription, glasses);
  const Prescription& p = out.lens();
  double largest = 0;
  for (const SurfaceRow& row : p.surfaces) {
    if (row.semi_diameter && std::isfinite(*row.semi_diameter)) largest = std::max(largest, *row.semi_diameter);
  }
  out.line("# " + one_line(p.name.empty() ? std::string("lens") : p.name));
  std::string nominal;
  if (p.focal_length_mm) nominal += to_text(*p.focal_length_mm) + " mm";
  if (p.f_number) append(nominal, " ", "f/" + to_text(*p.f_number));
  if (!nominal.empty()) out.line("# " + nominal);
  out.lose_nominal_data(false, {"focal_length_mm", "f_number"});
  out.line("# millimetres; the row of index 0 is the stop");
  out.line("# radius\tthickness\tn\taperture diameter");

  out.refuse_closed_rims("table");
  if (!p.object_space.is_air()) {
    throw Error(out.where() + ": a medium of index " + to_text(out.index(p.object_space)) +
                " in front of the lens; must be air for a table");
  }
  bool disperses = false, planes = false, open = false, obscured = false;
  const SurfaceRow* first_stop = nullptr;
  double before = 1;
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    const SurfaceRow& row = p.surfaces[i];
    if (row.mirror) out.refuse(i, "a mirror", "a refracting surface for a table");
    if (row.curved_in != Section::both) out.refuse(i, "a cylinder", "a sphere for a table");
    if (row.conic != 0 && row.radius != 0) out.refuse(i, "a conic", "a sphere for a table");
    if (!row.aspheric.empty()) out.refuse(i, "an asphere", "a sphere for a table");
    disperses = disperses || row.medium.vd || row.medium.glass;
    obscured = obscured || row.obscuration_semi_diameter.value_or(0) > 0;
    const bool limited = row.semi_diameter && std::isfinite(*row.semi_diameter);
    open = open || !limited;
    const double diameter = 2 * (limited ? *row.semi_diameter : largest > 0 ? largest : 1.0);
    const double index = out.index(row.medium);
    const bool is_stop = row.stop && !first_stop;
    if (is_stop) first_stop = &row;
    double thickness = row.thickness;
    if (thickness == 0 && ((i == 0 && index != 1) || i + 1 == p.surfaces.size())) {
      thickness = zero_thickness_mm;
      out.lose("thickness", "of 0 behind surface " + std::to_string(i) +
                                " is written as 1e-9 mm: readers interpret 0 as " +
                                (i == 0 ? "gaps in front of surfaces" : "a film without a position"));
    }
    if (is_stop && row.radius == 0 && index == 1 && before == 1) {
      out.line(cells(0, thickness, 0, diameter));
    } else {
      const double radius = row.radius == 0 ? plane_radius_mm : row.radius;
      planes = planes || row.radius == 0;
      // If a lens surface is the stop, the stop is written as a separate row, on the side of the surface with air.
      if (is_stop && before == 1) {
        out.line(cells(0, 0, 0, diameter));
        out.line(cells(radius, thickness, index, diameter));
      } else if (is_stop && index == 1) {
        out.line(cells(radius, 0, index, diameter));
        out.line(cells(0, thickness, 0, diameter));
      } else if (is_stop) {
        out.refuse(i, "the stop inside glass", "a stop in air for a table");
      } else {
        out.line(cells(radius, thickness, index, diameter));
      }
      if (is_stop) out.lose("stop", "of surface " + std::to_string(i) + " becomes a plane at its vertex");
    }
    before = index;
  }
  if (planes) out.lose("radius", "of planes is written as 1e6 mm, as 0 marks the stop");
  if (disperses) out.lose("vd", "the dispersion of glasses is lost: a table has only n_d");
  if (open) out.lose("semi_diameter", "surfaces without a semi-diameter get the largest of the others");
  if (obscured) out.lose("inner_semi_diameter", "central obscurations are lost");
  if (p.configurations.size() > 1) out.lose("configurations", "all but the first are lost");
  return out.take();
}

}  // namespace petzval
