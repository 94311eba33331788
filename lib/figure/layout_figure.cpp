// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "figure_elements.hpp"
#include "lens/path_lens.hpp"
#include "lens_section.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "ray_paths.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace {

using figure_detail::LensSection;
using figure_detail::RayPath;
using figure_detail::SectionLine;
using figure_detail::SectionPoint;
using figure_detail::Svg;
using figure_detail::svg_number;

constexpr double width = 960, side = 22, top = 64, bottom = 86, tallest = 520;

/// Bounds of the drawing in the section, mm.
struct Box {
  double z_min = 0, z_max = 0, low = 0, high = 0;

  void take(const SectionPoint& p) {
    z_min = std::min(z_min, p.z);
    z_max = std::max(z_max, p.z);
    low = std::min(low, p.height);
    high = std::max(high, p.height);
  }
};

class LayoutFigure {
 public:
  /// @param rays   paths of the fields
  /// @param names  names of the fields
  /// @param words  explanation of the rays
  /// @param longest_film  limit of the film's length, relative to the height of the lens
  LayoutFigure(const Lens& lens, double subject_z, std::span<const double> fields_rad, Meridian section,
               std::vector<RayPath> rays, std::vector<std::string> names, std::string words, double longest_film,
               int first_surface_number)
      : lens_(lens),
        subject_z_(subject_z),
        fields_(fields_rad),
        names_(std::move(names)),
        words_(std::move(words)),
        first_surface_number_(first_surface_number),
        meridian_(section),
        wavelength_(lens.primary_wavelength()),
        rays_(std::move(rays)),
        longest_film_(longest_film),
        section_(lens, section, heights_needed(), wavelength_) {
    if (has_pupils(lens)) stop_ = pupils(lens, wavelength_, section);
    measure();
  }

  std::string draw() {
    const double height = (box_.high - box_.low) * scale_;
    Svg svg(width, top + height + bottom);
    figure_detail::draw_head(svg, lens_, meridian_ == Meridian::y ? "Section y-z" : "Section x-z", subject_z_,
                             wavelength_);
    svg.path("M" + svg_number(side / 2) + " " + svg_number(y(0)) + "H" + svg_number(width - side / 2),
             "fill=\"none\" stroke=\"#888\" stroke-width=\"0.8\" stroke-dasharray=\"14 3 2 3\"");
    draw_glass(svg);
    draw_rays(svg);
    for (const SectionLine& mirror : section_.mirrors()) {
      svg.path(path_of(mirror), "fill=\"none\" stroke=\"#333\" stroke-width=\"3.5\"");
    }
    draw_stop(svg);
    svg.path(path_of({{lens_.film_z(), -film_half_}, {lens_.film_z(), film_half_}}),
             "fill=\"none\" stroke=\"#111\" stroke-width=\"2\"");
    draw_legend(svg, top + height);
    return std::move(svg).finish();
  }

 private:
  double x(double z) const { return left_ + (z - box_.z_min) * scale_; }
  double y(double height) const { return top + (box_.high - height) * scale_; }

  std::string path_of(const SectionLine& line, bool closed = false) const {
    std::string d;
    for (const SectionPoint& p : line) {
      d += (d.empty() ? "M" : "L") + svg_number(x(p.z)) + " " + svg_number(y(p.height));
    }
    return closed ? d + "z" : d;
  }

  std::vector<double> heights_needed() const {
    std::vector<double> result(lens_.surface_count(), 0.0);
    for (const RayPath& ray : rays_) {
      for (std::size_t i = 0; i < ray.hits.size(); ++i) {
        double& height = result[ray.surfaces[i]];
        height = std::max(height, std::abs(ray.hits[i].height));
      }
    }
    return result;
  }

  bool arrives(const RayPath& ray) const {
    const double film_distance = lens_.film_z() - ray.hits.back().z;
    return ray.fate == RayFate::transmitted && film_distance * ray.behind.z > 0;
  }

  SectionPoint on_film(const RayPath& ray) const {
    const SectionPoint last = ray.hits.back();
    return {lens_.film_z(), last.height + ray.behind.height / ray.behind.z * (lens_.film_z() - last.z)};
  }

  /// The drawn end of a ray that does not run towards the film: its image is virtual.
  SectionPoint past_lens(const RayPath& ray) const {
    const SectionPoint last = ray.hits.back();
    return {last.z + tail_ * ray.behind.z, last.height + tail_ * ray.behind.height};
  }

  /// Sets bounds and scale. Lens and film are measured first, because the length of rays in front of the lens depends
  /// on their size.
  void measure() {
    for (std::size_t i = 0; i < lens_.surface_count(); ++i) {
      for (const SectionLine& line : section_.surface(i)) {
        for (const SectionPoint& p : line) {
          box_.take(p);
          box_.take({p.z, -p.height});
        }
      }
    }
    body_half_ = box_.high;
    box_.take({lens_.film_z(), 0});
    for (std::size_t field = 0; field < fields_.size(); ++field) {
      // The height of the film is taken from the ray nearest to the chief ray, because a marginal ray may be nearly
      // parallel to the film.
      const RayPath* nearest = nullptr;
      for (const RayPath& ray : rays_) {
        if (ray.field != field || !arrives(ray)) continue;
        if (!nearest || std::abs(ray.stop_height) < std::abs(nearest->stop_height)) nearest = &ray;
      }
      if (nearest) film_half_ = std::max(film_half_, 1.05 * std::abs(on_film(*nearest).height));
    }
    film_half_ = std::min(film_half_, longest_film_ * body_half_);
    film_half_ = std::max(film_half_, 0.05 * std::max(box_.high, 0.3 * (box_.z_max - box_.z_min)));
    box_.take({lens_.film_z(), film_half_});
    box_.take({lens_.film_z(), -film_half_});
    film_and_body_half_ = box_.high;
    if (stop_) {
      tick_ = 0.03 * std::max(box_.high - box_.low, 0.3 * (box_.z_max - box_.z_min));
      const double rim = section_.rim(stop_->stop), z = section_.z(stop_->stop, rim);
      box_.take({z, rim + tick_});
      box_.take({z, -rim - tick_});
    }

    tail_ = 0.12 * std::max(box_.z_max - box_.z_min, box_.high - box_.low);
    const double z_front = box_.z_min - tail_;
    for (std::size_t field = 0; field < fields_.size(); ++field) start_rays(field, z_front);
    for (const SectionPoint& p : starts_) box_.take(p);
    for (const RayPath& ray : rays_) {
      if (ray.fate == RayFate::transmitted && !arrives(ray)) box_.take({past_lens(ray).z, 0});
    }
    box_.z_max += 0.01 * (box_.z_max - box_.z_min);
    scale_ = std::min((width - 2 * side) / (box_.z_max - box_.z_min), tallest / (box_.high - box_.low));
    left_ = (width - (box_.z_max - box_.z_min) * scale_) / 2;
  }

  /// Rays start in a common plane in front of the lens, or at the subject if it is nearer. Rays of a steep field start
  /// on a wavefront, because they come from the side or from behind.
  void start_rays(std::size_t field, double z_front) {
    const bool steep = std::abs(fields_[field]) > 0.95;  // rad
    double wavefront = 0;
    bool first = true;
    for (const RayPath& ray : rays_) {
      if (ray.field != field) continue;
      const SectionPoint hit = ray.hits.front(), chief = direction(field);
      const double along = hit.z * chief.z + hit.height * chief.height;
      wavefront = first ? along : std::min(wavefront, along);
      first = false;
    }
    for (const RayPath& ray : rays_) {
      if (ray.field != field) continue;
      const SectionPoint hit = ray.hits.front(), chief = direction(field);
      const double along = hit.z * chief.z + hit.height * chief.height;
      const double back =
          steep ? (along - wavefront + tail_) / (ray.before.z * chief.z + ray.before.height * chief.height)
                : (hit.z - std::max(z_front, subject_z_)) / ray.before.z;
      starts_.push_back({hit.z - back * ray.before.z, hit.height - back * ray.before.height});
    }
  }

  /// Direction of the light of a field.
  SectionPoint direction(std::size_t field) const { return {std::cos(fields_[field]), -std::sin(fields_[field])}; }

  void draw_glass(Svg& svg) const {
    constexpr const char* line = " stroke=\"#3d5a73\" stroke-width=\"1\" stroke-linejoin=\"round\"";
    const std::size_t count = lens_.surface_count();
    const double image_index = lens_.index(count, wavelength_);
    if (image_index > 1.01 && lens_.film_z() > lens_.surfaces()[count - 1].vertex_z) {
      // The glass, or another medium, reaches up to the film, as in an eye.
      SectionLine outline = section_.surface(count - 1).front();
      const double rim = outline.back().height;
      outline.push_back({lens_.film_z(), rim});
      outline.push_back({lens_.film_z(), -rim});
      svg.path(path_of(outline, true), "fill=\"" + figure_detail::glass_colour(image_index) + "\"" + line);
    }
    for (const figure_detail::GlassBody& body : section_.bodies()) {
      std::string d;
      for (const SectionLine& outline : body.outlines) d += path_of(outline, true);
      svg.path(d, "fill=\"" + figure_detail::glass_colour(body.index) + "\"" + line);
    }
  }

  /// The end of the last segment of a ray, clipped to a height: surfaces end at their rims, and a ray nearly parallel
  /// to the film meets it far away.
  static SectionPoint cut(const SectionPoint& from, const SectionPoint& to, double limit) {
    if (std::abs(to.height) <= limit || std::abs(from.height) >= limit) return to;
    const double t = (std::copysign(limit, to.height) - from.height) / (to.height - from.height);
    return {from.z + t * (to.z - from.z), std::copysign(limit, to.height)};
  }

  void draw_rays(Svg& svg) const {
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const RayPath& ray = rays_[i];
      SectionLine line{starts_[i]};
      line.insert(line.end(), ray.hits.begin(), ray.hits.end());
      const bool passes = ray.fate == RayFate::transmitted;
      if (passes) line.push_back(arrives(ray) ? on_film(ray) : past_lens(ray));
      line.back() = cut(line[line.size() - 2], line.back(), passes ? film_and_body_half_ : body_half_);
      svg.path(path_of(line), "fill=\"none\" stroke=\"" + std::string(figure_detail::field_colour(ray.field)) + "\"" +
                                  (passes ? " stroke-width=\"0.9\"" : " stroke-width=\"0.6\" stroke-opacity=\"0.5\""));
    }
  }

  void draw_stop(Svg& svg) const {
    if (!stop_) return;
    const double rim = section_.rim(stop_->stop), z = section_.z(stop_->stop, rim);
    const std::string line = std::string("fill=\"none\" stroke=\"#111\" stroke-width=\"2.2\"") +
                             (stop_->stop_inferred ? " stroke-dasharray=\"3 2\"" : "");
    svg.path(path_of({{z, rim}, {z, rim + tick_}}), line);
    svg.path(path_of({{z, -rim}, {z, -rim - tick_}}), line);
  }

  void draw_legend(Svg& svg, double y) const {
    double x = figure_detail::draw_scale_bar(svg, figure_detail::sheet_margin, y + 26, scale_, 160) + 30;
    for (std::size_t field = 0; field < fields_.size(); ++field) {
      const bool any = std::ranges::any_of(
          rays_, [&](const RayPath& ray) { return ray.field == field && ray.fate == RayFate::transmitted; });
      x = 21 + figure_detail::draw_key(svg, x, y + 26, figure_detail::field_colour(field),
                                       names_[field] + (any ? "" : " (no rays)"));
    }
    svg.text(figure_detail::sheet_margin, y + 50,
             "To scale. " + stop_in_words() + " Upright line: film. Darker glass has a higher index.",
             figure_detail::small_text);
    if (!fields_.empty()) {
      svg.text(figure_detail::sheet_margin, y + 66, words_, figure_detail::small_text);
    }
  }

  std::string stop_in_words() const {
    if (!stop_) return "No stop: the beam is unlimited.";
    const std::string surface =
        "surface " + std::to_string(static_cast<int>(stop_->stop) + first_surface_number_) + ".";
    if (!stop_->stop_inferred) return "Ticks: stop, " + surface;
    const std::string why = lens_.stop() ? "the stop has no rim" : "no surface is marked as stop";
    return "Dashed ticks: " + why + ", the beam is limited by " + surface;
  }

  const Lens& lens_;
  double subject_z_;
  std::span<const double> fields_;
  std::vector<std::string> names_;
  std::string words_;
  int first_surface_number_;
  Meridian meridian_;
  std::size_t wavelength_;
  std::vector<RayPath> rays_;
  double longest_film_;
  LensSection section_;
  std::optional<Pupils> stop_;
  Box box_;
  SectionLine starts_;    // start points of rays_
  double film_half_ = 0;  // half length of the line for the film
  double body_half_ = 0;  // half height of the lens
  double film_and_body_half_ = 0;
  double tick_ = 0;  // length of the ticks of the stop
  double tail_ = 0;  // length of rays in front of the lens
  double scale_ = 1, left_ = 0;
};

/// The rays of a light that a pair of surfaces sends to the film: the outermost ones and one between.
std::vector<RayPath> ghost_rays(const Lens& lens, const ScenePoint& light, Meridian section, const GhostPair& pair,
                                std::size_t field) {
  const std::vector<lens_detail::Passage> passages = lens_detail::path_of_pair(lens, pair.first, pair.second);
  const Lens path = lens_detail::along(lens, passages);
  const auto seen = [section](const auto& v) { return SectionPoint{v.z, section == Meridian::y ? v.y : v.x}; };
  const LensSurface& front = lens.surfaces().front();
  const Vec3<double> vertex{0, 0, front.vertex_z},
      to_light = light.position - (light.at_infinity ? Vec3<double>{} : vertex);
  const double distance = glm::length(to_light);
  const Vec3<double> direction = -to_light / distance, across = section == Meridian::y
                                                                    ? Vec3<double>{0, direction.z, -direction.y}
                                                                    : Vec3<double>{direction.z, 0, -direction.x};
  constexpr int steps = 500;
  std::vector<RayPath> passing;
  for (int k = -steps; k <= steps; ++k) {
    const double height = static_cast<double>(k) / steps;
    const Vec3<double> target = vertex + across * (height * front.semi_diameter);
    const Vec3<double> origin = light.at_infinity ? target - direction * (4 * front.semi_diameter) : light.position;
    const Vec3<double> towards = light.at_infinity ? direction : glm::normalize(target - origin);
    RayPath ray{field, height, {}, {}, seen(towards), {}, RayFate::transmitted};
    const auto end = kernel::trace(kernel::view<double>(path), kernel::to_kernel(origin), kernel::to_kernel(towards),
                                   {.wavelength = lens.primary_wavelength()},
                                   [&](int surface, const kernel::Vec<double>& hit, const kernel::Vec<double>&) {
                                     ray.hits.push_back(seen(hit));
                                     ray.surfaces.push_back(passages[static_cast<std::size_t>(surface)].surface);
                                   });
    ray.behind = seen(end.direction);
    if (end.fate == RayFate::transmitted) passing.push_back(std::move(ray));
  }
  if (passing.size() < 4) return passing;
  return {passing.front(), passing[passing.size() / 2], passing.back()};
}

}  // namespace

std::string layout_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad, Meridian section,
                          std::size_t rays, int first_surface_number) {
  if (rays < 3 || rays > 7) {
    throw Error("layout_figure: rays = " + std::to_string(rays) + "; must be 3 to 7");
  }
  std::vector<std::string> names;
  for (const double field : fields_rad) names.push_back(figure_detail::field_text(field));
  return LayoutFigure(lens, subject_z, fields_rad, section,
                      figure_detail::ray_paths(lens, subject_z, fields_rad, section, rays, lens.primary_wavelength()),
                      std::move(names),
                      "Rays: the chief ray, the outermost transmitted rays and others between. Thin: vignetted rays "
                      "through the rim or centre of the stop.",
                      std::numeric_limits<double>::infinity(), first_surface_number)
      .draw();
}

std::string ghost_figure(const Lens& lens, double subject_z, double field_rad, std::span<const GhostPair> pairs,
                         Meridian section, int first_surface_number) {
  const ScenePoint light = scene_point(lens, {field_rad, subject_z, section == Meridian::y ? 0 : std::numbers::pi / 2});
  std::vector<RayPath> rays;
  std::vector<std::string> names;
  for (const GhostPair& pair : pairs) {
    std::ranges::move(ghost_rays(lens, light, section, pair, names.size()), std::back_inserter(rays));
    const auto surface = [&](std::size_t i) {
      return i == lens.surface_count() ? "film" : std::to_string(static_cast<int>(i) + first_surface_number);
    };
    names.push_back(surface(pair.second) + " and " + surface(pair.first) + ": " + svg_number(100 * pair.energy) + " %");
  }
  const std::vector<double> fields(pairs.size(), field_rad);
  return LayoutFigure(
             lens, subject_z, fields, section, std::move(rays), std::move(names),
             "Rays of a light that two surfaces reflect, and the share of the light that they send to the film.", 1.5,
             first_surface_number)
      .draw();
}

}  // namespace petzval
