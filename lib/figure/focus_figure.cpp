// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/spot_moments.hpp"
#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using figure_detail::Svg;

constexpr double width = 960, left = 78, right = 24, top = 140, plot_height = 340, row = 18;
constexpr std::uint32_t rays = 4096;

/// The rays of a field at all wavelengths.
Grid<Spot> spots_of(const Lens& lens, const FieldPoint& point) {
  Grid<Spot> spots{{}, lens.wavelengths_nm().size()};
  for (std::size_t w = 0; w < spots.columns; ++w) {
    spots.values.push_back(analysis_detail::trace_spot(lens, point, w, rays));
  }
  return spots;
}

class FocusFigure {
 public:
  FocusFigure(const Lens& lens, const Grid<Spot>& spots, std::vector<double> weights)
      : lens_(lens), subject_z_(spots.values.front().point.z), weights_(std::move(weights)) {
    const Grid<double> of_rays = analysis_detail::ray_weights("focus_figure", spots, weights_);
    bool has_axis = false;
    for (std::size_t field = 0; field < spots.size(); ++field) {
      fields_.push_back(spots[field].front().point.field_rad);
      curves_.push_back(parabola(spots[field], of_rays[field]));
      if (fields_.back() != 0) continue;
      has_axis = true;
      axis_ = curves_.back();
    }
    if (!has_axis) {
      const Grid<Spot> axis = spots_of(lens, {0, subject_z_});
      axis_ = parabola(axis.values, analysis_detail::ray_weights("focus_figure", axis, weights_).values);
    }
    mean_ = analysis_detail::mean(curves_);
    const double paraxial = paraxial_image_z(lens, subject_z_, lens.primary_wavelength(), main_meridian(lens));
    paraxial_ = std::isfinite(paraxial);
    zero_ = paraxial_ ? paraxial : lens.film_z();
    measure();
  }

  std::string draw() {
    const double rows = static_cast<double>(fields_.size() + (several() ? 1 : 0));
    Svg svg(width, top + plot_height + 62 + row * rows + 34);
    figure_detail::draw_head(svg, lens_, "Blur against film position", subject_z_, lens_.primary_wavelength());
    const bool micrometres = highest_ < 0.5;
    const double unit = micrometres ? 1e3 : 1;
    figure_detail::Axes axes(
        svg, left, top, width - left - right, plot_height,
        {from_ - zero_, to_ - zero_, std::string("film shift") + (paraxial_ ? " from paraxial focus" : "") + " (mm)"},
        {0, unit * highest_, std::string("RMS radius (") + (micrometres ? "\u00b5m)" : "mm)")});

    constexpr std::string_view film = "fill=\"none\" stroke=\"#111\" stroke-width=\"1.4\"";
    constexpr std::string_view thin = "fill=\"none\" stroke=\"#777\" stroke-width=\"0.8\"";
    constexpr std::string_view dashed = "fill=\"none\" stroke=\"#777\" stroke-width=\"0.8\" stroke-dasharray=\"5 3\"";
    std::vector<figure_detail::Axes::Mark> marks{{lens_.film_z() - zero_, "film", film}};
    if (paraxial_) marks.push_back({0, "paraxial focus", thin});
    if (axis_) marks.push_back({axis_->best - zero_, "least RMS on the axis", dashed});
    if (several() && mean_) marks.push_back({mean_->best - zero_, "least mean of the fields", dashed});
    axes.marks(std::move(marks));

    const auto curve = [&](const Parabola& p, const std::string& stroke) {
      constexpr int steps = 240;
      std::vector<std::pair<double, double>> points;
      for (int k = 0; k <= steps; ++k) {
        const double z = from_ + (to_ - from_) * k / steps;
        points.push_back({z - zero_, unit * p.rms(z)});
      }
      axes.curve(points, "fill=\"none\" stroke-linejoin=\"round\" " + stroke);
    };
    double y = top + plot_height + 62;
    const auto entry = [&](std::string_view colour, const std::string& name, const std::optional<Parabola>& p) {
      figure_detail::draw_key(svg, left, y, colour,
                              name + (p ? ":  least RMS " + figure_detail::length_text(p->least_rms()) + " at " +
                                              signed_mm(p->best - zero_) + ",  " +
                                              figure_detail::length_text(p->rms(lens_.film_z())) + " on the film"
                                        : ":  no focus: no rays, or parallel rays"));
      y += row;
    };
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const std::string colour(figure_detail::field_colour(i));
      if (curves_[i]) curve(*curves_[i], "stroke=\"" + colour + "\" stroke-width=\"1.6\"");
      entry(colour, "field " + figure_detail::field_text(fields_[i]), curves_[i]);
    }
    if (several()) {
      if (mean_) curve(*mean_, "stroke=\"#111\" stroke-width=\"1.6\" stroke-dasharray=\"7 3\"");
      entry("#111", "mean of the fields (dashed)", mean_);
    }
    svg.text(figure_detail::sheet_margin, y + 12,
             "RMS radius about the centroid over the area of the vignetted pupil" + wavelengths_in_words() +
                 ". Mean: root of the mean square, fields with equal weight.",
             figure_detail::small_text);
    return std::move(svg).finish();
  }

 private:
  using Parabola = analysis_detail::BlurParabola;

  /// RMS radius over z of the film, lens frame.
  std::optional<Parabola> parabola(std::span<const Spot> spots, std::span<const double> ray_weights) const {
    auto found = analysis_detail::SpotMoments(spots, ray_weights).parabola();
    if (found) found->best += lens_.film_z();
    return found;
  }

  bool several() const { return fields_.size() > 1; }

  std::string wavelengths_in_words() const {
    const auto count = lens_.wavelengths_nm().size();
    return count == 1 ? ""
                      : ", " + std::to_string(count) + " wavelengths with " + figure_detail::weights_text(weights_);
  }

  static std::string signed_mm(double mm) {
    return (mm >= 0 ? "+" : "\u2212") + to_text(std::abs(mm) < 5e-7 ? 0.0 : std::abs(mm), 3) + " mm";
  }

  /// Sets the ranges of the axes: they include all marks, and a part of the curves on both sides.
  void measure() {
    from_ = to_ = lens_.film_z();
    const auto take = [&](double z) { from_ = std::min(from_, z), to_ = std::max(to_, z); };
    if (std::abs(zero_ - lens_.film_z()) < 0.1 * std::abs(lens_.film_z())) take(zero_);
    for (const auto* p : {&axis_, &mean_}) {
      if (*p) take((*p)->best);
    }
    for (const auto& p : curves_) {
      if (p) take(p->best);
    }
    // The range includes, on both sides, the interval in which the axial curve rises to three times its minimum.
    double pad = 0.25 * (to_ - from_);
    if (axis_) pad = std::max(pad, analysis_detail::focus_range(lens_, *axis_));
    if (!(pad > 0)) pad = 1;
    from_ -= pad;
    to_ += pad;
    for (const auto& p : curves_) {
      if (p) highest_ = std::max({highest_, 1.3 * p->rms(mean_->best), 1.3 * p->rms(lens_.film_z())});
    }
    if (axis_) highest_ = std::max({highest_, 2.5 * axis_->least_rms(), axis_->rms(axis_->best + pad)});
    if (!(highest_ > 0)) highest_ = 1e-3;
  }

  const Lens& lens_;
  double subject_z_;
  std::vector<double> fields_;
  std::vector<double> weights_;                  // one per wavelength
  std::vector<std::optional<Parabola>> curves_;  // one per field
  std::optional<Parabola> axis_, mean_;
  bool paraxial_ = false;
  double zero_ = 0;  // z of the origin of the horizontal axis, lens frame
  double from_ = 0, to_ = 0, highest_ = 0;
};

}  // namespace

std::string focus_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                         std::span<const double> wavelength_weights) {
  Grid<Spot> spots{{}, lens.wavelengths_nm().size()};
  for (const double field : fields_rad) {
    for (Spot& spot : spots_of(lens, {field, subject_z}).values) spots.values.push_back(std::move(spot));
  }
  return focus_figure(lens, spots, wavelength_weights);
}

std::string focus_figure(const Lens& lens, const Grid<Spot>& spots, std::span<const double> wavelength_weights) {
  if (spots.values.empty()) throw Error("focus_figure: fields = 0; must be at least 1");
  return FocusFigure(lens, spots, figure_detail::checked_weights("focus_figure", lens, wavelength_weights)).draw();
}

}  // namespace petzval
