// SPDX-License-Identifier: Apache-2.0
#include "scene_panel.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace petzval::figure_detail {
namespace {

double unit_of(const SceneFrame& frame) { return frame.box.length() > 2000 ? 1e-3 : 1; }

std::string unit_name(const SceneFrame& frame) { return frame.box.length() > 2000 ? " (m)" : " (mm)"; }

}  // namespace

SectionLine cut_off(const SectionLine& outline, const SectionTrace& line) {
  SectionLine result;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const SectionPoint &a = outline[i], &b = outline[(i + 1) % outline.size()];
    const double at_a = line.side(a), at_b = line.side(b);
    if (at_a >= 0) result.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
      const double t = at_a / (at_a - at_b);
      result.push_back({a.z + t * (b.z - a.z), a.height + t * (b.height - a.height)});
    }
  }
  return result;
}

SceneFrame::SceneFrame(SectionBox content, double lowest, double tallest) : box(content) {
  constexpr double margin = 22;  // px
  px_per_mm = std::min((width - 2 * margin) / box.length(), (tallest - 2 * margin) / box.tall());
  height = std::max(lowest, box.tall() * px_per_mm + 2 * margin);
  const double more_z = (width / px_per_mm - box.length()) / 2, more_h = (height / px_per_mm - box.tall()) / 2;
  box.z_min -= more_z, box.z_max += more_z, box.low -= more_h, box.high += more_h;
}

ScenePanel::ScenePanel(Svg& svg, double y, const SceneFrame& frame, const std::string& across)
    : svg_(svg),
      frame_(frame),
      unit_(unit_of(frame)),
      axes_(svg, SceneFrame::left, y, SceneFrame::width, frame.height,
            {unit_ * frame.box.z_min, unit_ * frame.box.z_max, "z" + unit_name(frame)},
            {unit_ * frame.box.low, unit_ * frame.box.high, across + unit_name(frame)}) {}

void ScenePanel::stroke(const SectionPoint& a, const SectionPoint& b, std::string_view attributes) {
  const std::vector<Axes::Point> ends{{unit_ * a.z, unit_ * a.height}, {unit_ * b.z, unit_ * b.height}};
  axes_.curve(ends, attributes);
}

void ScenePanel::line(const SectionTrace& line, std::string_view attributes) {
  const SectionBox& b = frame_.box;
  const double squared = line.along * line.along + line.across * line.across;
  const SectionPoint middle{(b.z_min + b.z_max) / 2, (b.low + b.high) / 2};
  const double by = -line.side(middle) / squared, far = (b.length() + b.tall()) / std::sqrt(squared);
  const SectionPoint foot{middle.z + by * line.along, middle.height + by * line.across};
  stroke({foot.z - far * line.across, foot.height + far * line.along},
         {foot.z + far * line.across, foot.height - far * line.along}, attributes);
}

void ScenePanel::fill(const SectionLine& outline, std::string_view attributes) {
  std::string d;
  for (const SectionPoint& p : outline) d += (d.empty() ? "M" : "L") + svg_number(x(p)) + " " + svg_number(y(p));
  if (!d.empty()) svg_.path(d + "z", attributes);
}

void ScenePanel::dot(const SectionPoint& p, std::string_view name, double lower_px) {
  if (!frame_.box.holds(p)) return;
  svg_.circle(x(p), y(p), 4, "fill=\"#7b3fb5\"");
  if (!name.empty()) words(p, name, lower_px);
}

void ScenePanel::mark(const SectionPoint& p, std::size_t number, bool used, double radius) {
  if (!frame_.box.holds(p)) return;
  svg_.circle(x(p), y(p), radius, used ? "fill=\"#d0331f\"" : "fill=\"#fff\" stroke=\"#d0331f\"");
  svg_.text(x(p) + radius + 2, y(p) - 3, std::to_string(number), "font-size=\"11\" fill=\"#a02515\"");
}

void ScenePanel::words(const SectionPoint& p, std::string_view words, double lower_px) {
  const bool at_right = x(p) > SceneFrame::left + 0.7 * SceneFrame::width;
  const double foot = y({p.z, frame_.box.low}) - 5;
  svg_.text(x(p) + (at_right ? -8 : 8), std::min(y(p) + lower_px, foot), words,
            std::string("font-size=\"11\" fill=\"#333\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"") +
                (at_right ? " text-anchor=\"end\"" : ""));
}

}  // namespace petzval::figure_detail
