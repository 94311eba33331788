// SPDX-License-Identifier: Apache-2.0
#include "lens_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "html_page.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/focus/focus.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// Writes one row per number and one column per meridian.
void first_order_table(std::ostream& html, const Report& r) {
  html << "<table>\n";
  const auto& sections = r.first_order.sections;
  if (sections.size() > 1) {
    html << "<tr><th></th>";
    for (const auto& m : sections) html << "<th class=\"number\">" << section_name(m.meridian) << "</th>";
    html << "<th></th></tr>\n";
  }
  for (const Entry& entry : entries(r, r.main())) {
    html << "<tr><td>" << entry.label << "</td>";
    for (const auto& m : sections) {
      const auto all = entries(r, m);
      const auto same = std::ranges::find(all, entry.label, &Entry::label);
      html << "<td class=\"number\">" << (same == all.end() ? "" : in_words(same->value)) << "</td>";
    }
    html << "<td>" << entry.unit << "</td></tr>\n";
  }
  html << "<tr><td>film, z</td><td class=\"number\">" << in_words(r.loaded.lens.film_z()) << "</td>"
       << (sections.size() > 1 ? "<td></td>" : "") << "<td>mm</td></tr>\n</table>\n";
}

/// Digits of numbers that are compared with the source: more than sources print, less than rounding changes.
constexpr int source_digits = 12;

bool is_aspheric(const petzval::SurfaceRow& row) { return row.conic != 0 || !row.aspheric.empty(); }

std::string in_words(const petzval::Coating& coating) {
  if (!coating.table.empty()) return "reflectances";
  const std::size_t layers = coating.layers.size();
  return layers == 0 ? "uncoated" : std::to_string(layers) + (layers == 1 ? " layer" : " layers");
}

void surface_table(std::ostream& html, const Report& r) {
  const petzval::Prescription& p = r.loaded.prescription;
  html << "<div class=\"scroll\"><table>\n<tr><th class=\"number\">surface</th><th class=\"number\">radius</th>"
          "<th class=\"number\">thickness</th><th class=\"number\">n<sub>d</sub></th><th class=\"number\">V<sub>d</sub>"
          "</th><th>glass</th><th class=\"number\">semi-diameter</th><th class=\"number\">edge "
          "thickness</th><th></th></tr>\n";
  const auto edges = petzval::edge_thicknesses(r.loaded.lens);
  const auto cell = [](const std::string& words) { return "<td class=\"number\">" + words + "</td>"; };
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    const petzval::SurfaceRow& row = p.surfaces[i];
    const petzval::LensSurface& compiled = r.loaded.lens.surfaces()[i];
    const petzval::Glass* glass = petzval::glass_of(row.medium, r.loaded.glasses);
    // The surface's own value, else the value of its glass.
    const auto either = [&](std::optional<double> own, double petzval::Glass::*of_glass, int digits) {
      return own ? number(*own, digits) : glass ? number(glass->*of_glass, digits) : std::string();
    };
    const std::string nd = row.medium.is_air() ? "" : either(row.medium.nd, &petzval::Glass::nd, 8),
                      vd = either(row.medium.vd, &petzval::Glass::vd, 8);
    std::string remarks;
    const auto remark = [&](const std::string& words) { remarks += (remarks.empty() ? "" : ", ") + words; };
    if (row.stop) remark("stop");
    if (row.mirror) remark("mirror");
    if (row.curved_in != petzval::Section::both) {
      remark(std::string("cylinder, curved in ") + (row.curved_in == petzval::Section::x ? "x" : "y"));
    }
    if (is_aspheric(row)) remark("asphere");
    if (row.obscuration_semi_diameter) remark("central obscuration " + number(*row.obscuration_semi_diameter, 5));
    if (row.coating) remark("coating: " + in_words(*row.coating));
    const bool stated = !row.semi_diameter_computed && row.semi_diameter == compiled.semi_diameter;
    if (row.semi_diameter_computed) {
      remark("semi-diameter computed");
    } else if (row.semi_diameter && !stated && std::isfinite(*row.semi_diameter)) {
      remark("semi-diameter in the file " + number(*row.semi_diameter, source_digits));
    }
    html << "<tr>" << cell(std::to_string(r.surface_number(i)))
         << cell(row.radius == 0 ? "plane" : number(row.radius, source_digits))
         << cell(number(compiled.thickness, source_digits)) << cell(nd) << cell(vd) << "<td>"
         << escaped_html(row.medium.glass.value_or("")) << "</td>"
         << cell(stated                                  ? number(compiled.semi_diameter, source_digits)
                 : std::isfinite(compiled.semi_diameter) ? number(compiled.semi_diameter, 5)
                                                         : "unlimited")
         << cell(edges[i] ? number(*edges[i], 5) : "") << "<td>" << remarks << "</td></tr>\n";
  }
  html << "</table></div>\n";
}

/// One row of a table, with numbers aligned to the right; a dash for NaN.
void number_row(std::ostream& html, const std::string& first, std::span<const double> values, int digits) {
  html << "<tr><td>" << first << "</td>";
  constexpr double rounding = 1e-9;  // shown as 0
  for (const double value : values) {
    html << "<td class=\"number\">"
         << (std::isnan(value) ? "\u2013" : number(std::abs(value) < rounding ? 0 : value, digits)) << "</td>";
  }
  html << "</tr>\n";
}

void head_row(std::ostream& html, std::initializer_list<const char*> names) {
  html << "<div class=\"scroll\"><table>\n<tr>";
  for (const char* name : names) html << "<th class=\"number\">" << name << "</th>";
  html << "</tr>\n";
}

/// Wavefront errors of each field and wavelength.
void wavefront_table(std::ostream& html, const Report& r, const petzval::LensReport& aberrations) {
  if (!r.main().pupils || !aberrations.wavefront) return;
  html
      << "<h2>Wavefront</h2>\n<p class=\"lead\">In waves, over the vignetted exit pupil. The second RMS and the Strehl "
         "ratio are about the image point with the smallest RMS; a dash stands beyond half a wave, where an image has "
         "no "
         "single peak. Zernike coefficients in fringe "
         "order, in the unit circle of the stop: defocus Z4, astigmatism Z5, coma Z8, spherical aberration Z9. All 37 "
         "are in the output of "
         "--json. Errors: of the first RMS and of the Strehl ratio, by the number of rays.</p>\n";
  head_row(html,
           {"field", "wavelength", "RMS", "error", "RMS without tilt", "Strehl", "error", "Z4", "Z5", "Z8", "Z9"});
  const auto nm = aberrations.lens.wavelengths_nm();
  for (std::size_t field = 0; field < aberrations.wavefront->size(); ++field) {
    const std::string label = number(r.subject.fields.degrees[field], 4) + "\u00b0";
    for (std::size_t k = 0; k < nm.size(); ++k) {
      const std::optional<petzval::Wavefront>& front = (*aberrations.wavefront)[field][k];
      if (!front) {
        html << "<tr><td>" << label << "</td><td class=\"number\">" << number(nm[k], 7)
             << "</td><td>no light</td></tr>\n";
        continue;
      }
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      number_row(html, label,
                 std::array{nm[k], front->rms_waves, front->sampling_error_waves, front->rms_without_tilt,
                            front->strehl.value_or(none), front->strehl ? front->strehl_error : none, front->zernike[3],
                            front->zernike[4], front->zernike[7], front->zernike[8]},
                 4);
    }
  }
  html << "</table></div>\n";
}

/// Seidel sums with the paraxial rays of each surface.
void third_order_table(std::ostream& html, const Report& r, const petzval::LensReport& aberrations) {
  if (!aberrations.seidel) return;
  const petzval::SeidelSums& sums = *aberrations.seidel;
  const petzval::ParaxialRays& rays = *aberrations.paraxial_rays;
  html << "<h2>Third order</h2>\n<p class=\"lead\">For the largest field, with a chief ray that rises, in micrometres: "
          "spherical aberration, coma, "
          "astigmatism, Petzval curvature, distortion, axial and lateral colour. Then height (mm) and slope behind the "
          "surface of the marginal and the chief ray. Optical invariant "
       << number(rays.invariant, 7) << " mm; " << numbering_in_words(r) << '.';
  const bool declared(aberrations.seidel_declared);
  if (declared) {
    html << " Sums and invariant with the declared entrance pupil of " << number(r.declared_pupil->diameter, 7)
         << " mm instead of the rim of the stop (paraxial marginal ray, as OpticStudio): invariant "
         << number(aberrations.paraxial_rays_declared->invariant, 7) << " mm.";
  }
  html << "</p>\n";
  head_row(html,
           {"surface", "S1", "S2", "S3", "S4", "S5", "C1", "C2", "marginal y", "marginal u", "chief y", "chief u"});
  const auto terms = [](const petzval::SeidelTerms& t) {
    return std::vector{1000 * t.s1, 1000 * t.s2, 1000 * t.s3, 1000 * t.s4, 1000 * t.s5, 1000 * t.c1, 1000 * t.c2};
  };
  for (std::size_t i = 0; i < rays.surfaces.size(); ++i) {
    const auto& [marginal_y, marginal_u, chief_y, chief_u] = rays.surfaces[i];
    std::vector<double> values = terms(sums.surfaces[i]);
    values.insert(values.end(), {marginal_y, marginal_u, chief_y, chief_u});
    number_row(html, std::to_string(r.surface_number(i)), values, 5);
  }
  number_row(html, declared ? "sum, rim of the stop" : "sum", terms(sums.sums), 5);
  if (declared) number_row(html, "sum, declared pupil", terms(aberrations.seidel_declared->sums), 5);
  html << "</table></div>\n";
}

void light_table(std::ostream& html, const LightReport& light) {
  html << "<h2>Light</h2>\n<p class=\"lead\">The fraction of unpolarised light that the lens passes, mean over the "
          "pupil; "
       << escaped_html(coatings_in_words(light)) << '.';
  if (const std::string words = t_stop_in_words(light); !words.empty()) html << ' ' << words << '.';
  if (light.colour) {
    for (const std::string& words : colour_in_words(*light.colour)) html << ' ' << words << '.';
  }
  html << "</p>\n";
  const auto wavelengths = light.colours.wavelengths_nm();
  html << "<div class=\"scroll\"><table>\n<tr><th class=\"number\">field</th>";
  for (const double nm : wavelengths) html << "<th class=\"number\">" << number(nm, 6) << " nm</th>";
  html << "</tr>\n";
  for (std::size_t field = 0; field < light.values.size(); ++field) {
    html << "<tr><td class=\"number\">" << number(light.fields_deg[field], 4) << "\u00b0</td>";
    for (const std::optional<double>& value : light.values[field]) {
      html << "<td class=\"number\">" << (value ? number(100 * *value, 4) + " %" : "no light") << "</td>";
    }
    html << "</tr>\n";
  }
  html << "</table></div>\n";
}

void ghost_table(std::ostream& html, const Report& r, const GhostReport& ghosts) {
  html
      << "<h2>Ghosts</h2>\n<p class=\"lead\">Light of a point at " << number(ghosts.field_deg, 3)
      << "\u00b0 that two surfaces reflect to the film, as fractions of the light that enters the first surface within "
         "its rim. ";
  if (!ghosts.failure.empty()) {
    html << "Not computed: " << escaped_html(ghosts.failure) << ".</p>\n";
    return;
  }
  html << "The brightest pairs without coatings, and the sum of all pairs";
  if (ghosts.left_out > 0) html << " but the " << ghosts.left_out << " weakest";
  html << "; petzval ghosts draws them.</p>\n<div class=\"scroll\"><table>\n<tr><th>surfaces</th>";
  for (const GhostReport::Column& column : ghosts.columns) {
    html << "<th class=\"number\">" << escaped_html(column.coatings) << "</th>";
  }
  html << "<th class=\"number\">centre (mm)</th><th class=\"number\">rms radius (mm)</th></tr>\n";
  const auto row = [&](const std::string& name, const auto& energy_of, const std::string& rest) {
    html << "<tr><td>" << name << "</td>";
    for (const GhostReport::Column& column : ghosts.columns) {
      html << "<td class=\"number\">" << number(energy_of(column), 3) << "</td>";
    }
    html << rest << "</tr>\n";
  };
  for (std::size_t k = 0; k < ghosts.pairs.size(); ++k) {
    const petzval::GhostPair& pair = ghosts.pairs[k];
    const bool film = pair.second == r.loaded.lens.surface_count();
    row((film ? std::string("film") : std::to_string(r.surface_number(pair.second))) + ", then " +
            std::to_string(r.surface_number(pair.first)),
        [&](const GhostReport::Column& column) { return column.energies[k]; },
        "<td class=\"number\">" + number(pair.centre.y, 3) + "</td><td class=\"number\">" +
            number(pair.rms_radius_mm, 3) + "</td>");
  }
  row(
      "all", [](const GhostReport::Column& column) { return column.glare; }, "<td></td><td></td>");
  html << "</table></div>\n";
}

/// Conic constants and coefficients of the aspheres, one row per surface and one column per order.
void asphere_table(std::ostream& html, const Report& r) {
  const auto& surfaces = r.loaded.prescription.surfaces;
  if (std::ranges::none_of(surfaces, is_aspheric)) return;
  std::set<int> orders;
  for (const petzval::SurfaceRow& row : surfaces) {
    for (const petzval::AsphereTerm& term : row.aspheric) orders.insert(term.order);
  }
  html << "<h2>Aspheres</h2>\n<p class=\"lead\">sag = c r<sup>2</sup> / (1 + sqrt(1 - (1 + K) c<sup>2</sup> "
          "r<sup>2</sup>))"
       << (orders.empty() ? "" : " + A4 r<sup>4</sup> + A6 r<sup>6</sup> + ...")
       << ", with c = 1 / radius and lengths in mm.</p>\n<div class=\"scroll\"><table>\n"
          "<tr><th class=\"number\">surface</th><th class=\"number\">K</th>";
  for (const int order : orders) html << "<th class=\"number\">A" << order << "</th>";
  html << "</tr>\n";
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (!is_aspheric(surfaces[i])) continue;
    html << "<tr><td class=\"number\">" << r.surface_number(i) << "</td><td class=\"number\">"
         << number(surfaces[i].conic, source_digits) << "</td>";
    for (const int order : orders) {
      const auto term = std::ranges::find(surfaces[i].aspheric, order, &petzval::AsphereTerm::order);
      html << "<td class=\"number\">"
           << (term == surfaces[i].aspheric.end() ? "" : number(term->coefficient, source_digits)) << "</td>";
    }
    html << "</tr>\n";
  }
  html << "</table></div>\n";
}

/// Distances that differ between the zoom positions and focus positions of the file, one column per position.
void position_table(std::ostream& html, const Report& r) {
  const petzval::Prescription& whole = r.loaded.whole;
  if (whole.configurations.size() < 2) return;
  html << "<h2>Positions</h2>\n<p class=\"lead\">Thicknesses that change, in millimetres.</p>\n"
          "<div class=\"scroll\"><table>\n<tr><th>after surface</th>";
  for (const petzval::Configuration& c : whole.configurations) {
    html << "<th class=\"number\">" << escaped_html(c.name) << "</th>";
  }
  html << "</tr>\n";
  const auto line = [&](const std::string& label, const auto& value_of) {
    std::string cells;
    bool any = false;
    for (std::size_t k = 0; k < whole.configurations.size(); ++k) {
      const std::optional<double> value = value_of(k);
      any = any || value;
      cells += "<td class=\"number\">" + (value ? number(*value, source_digits) : "") + "</td>";
    }
    if (any) html << "<tr><td>" << label << "</td>" << cells << "</tr>\n";
  };
  std::vector<petzval::Prescription> positions;
  for (std::size_t k = 0; k < whole.configurations.size(); ++k) positions.push_back(petzval::configured(whole, k));
  line("focal length", [&](std::size_t k) { return whole.configurations[k].focal_length_mm; });
  line("f-number", [&](std::size_t k) { return whole.configurations[k].f_number; });
  line("subject distance", [&](std::size_t k) { return whole.configurations[k].subject_distance_mm; });
  for (std::size_t i = 0; i < whole.surfaces.size(); ++i) {
    const auto thickness = [&](std::size_t k) { return std::optional(positions[k].surfaces[i].thickness); };
    const bool changes = std::ranges::any_of(positions, [&](const petzval::Prescription& p) {
      return p.surfaces[i].thickness != positions.front().surfaces[i].thickness;
    });
    if (changes) line(std::to_string(r.surface_number(i)), thickness);
  }
  html << "</table></div>\n";
}

void sources(std::ostream& html, const petzval::Prescription& p) {
  html << "<table>\n";
  const auto line = [&](const char* label, const std::string& words) {
    if (!words.empty()) html << "<tr><td>" << label << "</td><td>" << escaped_html(words) << "</td></tr>\n";
  };
  line("design", p.source_design);
  line("numbers from", p.source_numbers);
  line("semi-diameters", p.semi_diameters.value_or(""));
  line("size of the stop", p.stop_size.value_or(""));
  line("film", p.image_distance.value_or(""));
  line("glass names", p.glass_names.value_or(""));
  line("notes", p.notes.value_or(""));
  html << "</table>\n";
}

/// The subject, wavelengths and fields of the figures, and their sources.
std::string conditions(const ReportSubject& subject) {
  const auto origin = [](bool of_file) { return of_file ? " (as in the file)" : ""; };
  std::string text = in_words(subject);
  text[0] = 'S';
  return text + ". Wavelengths: " + in_words(subject.light) + origin(subject.light.of_file) +
         ". Fields: " + in_words(subject.fields) + origin(subject.fields.of_file) + ".";
}

}  // namespace

std::vector<LensFigure> lens_figures(const Report& r, const petzval::LensReport& aberrations,
                                     const std::optional<LightReport>& light) {
  const petzval::Lens &lens = r.loaded.lens, &colours = aberrations.lens;
  constexpr std::size_t rays = 5;
  const int first = r.loaded.first_surface_number;
  const double subject_z = examples::subject_z(r.subject, lens);
  const std::vector<double>& weights = r.subject.light.weights;
  std::vector<LensFigure> result;
  std::vector<std::function<std::string()>> drawings;
  const auto add = [&](const char* name, const char* title, const char* caption, std::function<std::string()> draw) {
    result.push_back({name, title, caption, {}});
    drawings.push_back(std::move(draw));
  };
  // The figures share the processors; each draws on one thread.
  const auto draw_all = [&] {
    petzval::parallel_for(drawings.size(), 1, threads(),
                          [&](std::size_t k, std::size_t) { result[k].svg = drawings[k](); });
  };
  const bool limited(r.main().pupils);
  std::vector<double> fields;
  for (std::size_t i = 0; limited && i < r.subject.fields.degrees.size(); ++i) {
    fields.push_back(petzval::radians(r.subject.fields.degrees[i]));
  }

  add("layout", "The lens",
      "Each colour is one field: its rays come from one far point and should meet in one point of the film. If the "
      "rays of a field do not fill the stop from tick to tick, rims clip the pupil and the corner darkens.",
      [&] { return petzval::layout_figure(lens, subject_z, fields, petzval::Meridian::y, rays, first); });
  if (!lens.rotationally_symmetric()) {
    add("layout_x", "The lens in the other section",
        "The section x-z of the lens. Cylinders are curved in one section only, so the focal length differs.",
        [&] { return petzval::layout_figure(lens, subject_z, fields, petzval::Meridian::x, rays, first); });
  }
  if (!limited) {
    draw_all();
    return result;
  }

  const petzval::Grid<petzval::Spot>& spots = *aberrations.spots;
  const petzval::Grid<petzval::RayFan>& fans = *aberrations.ray_fans;
  std::vector<double> shifts;
  if (aberrations.through_focus && aberrations.through_focus->size() > 0) {
    for (const auto& spot : (*aberrations.through_focus)[0]) shifts.push_back(spot.film_shift_mm);
  }
  const double farthest = std::abs(*std::ranges::max_element(fields, {}, [](double f) { return std::abs(f); }));

  add("spots", "Spots",
      "Film points of the rays from one field point. If the spot is within the dashed Airy circle, diffraction "
      "dominates. A comet is coma, a line or a cross astigmatism; separate colours are lateral colour.",
      [&] { return petzval::spot_figure(colours, spots, weights); });
  if (!shifts.empty()) {
    add("through_focus", "Spots through focus",
        "The same rays on films in front of and behind the film. If the smallest spot of a field is not in the middle, "
        "the field is curved or the film out of focus; a line that turns by 90 degrees is astigmatism.",
        [&] { return petzval::through_focus_figure(colours, spots, shifts, weights); });
  }
  add("energy", "Encircled energy",
      "The fraction of the rays within a radius. A curve that rises steeply and then slowly is a sharp core in a halo.",
      [&] {
        std::vector<double> fractions;
        for (int k = 1; k <= 100; ++k) fractions.push_back(k / 100.0);
        const auto points = petzval::encircled_energy(spots, fractions, weights);
        return petzval::energy_figure(colours, subject_z, points);
      });
  add("fans", "Ray fans",
      "Errors of the rays through the two sections of the stop. A tilted line is defocus, an S is spherical "
      "aberration, a parabola is coma; distances between the curves are lateral colour.",
      [&] { return petzval::fan_figure(colours, subject_z, fans); });
  if (aberrations.wavefront) {
    add("wavefront", "Wavefront",
        "The same rays by their optical paths. If all curves stay within a quarter of a wave, the lens is limited by "
        "diffraction.",
        [&] { return petzval::wavefront_figure(colours, subject_z, fans); });
  }
  add("footprints", "Pupils",
      "The vignetted pupil of each field point. The more of the dashed circle is missing, the darker the corner. "
      "Bright points out of focus have blurs of this shape.",
      [&] { return petzval::footprint_figure(lens, subject_z, fields, first); });
  if (aberrations.through_focus) {
    add("focus", "Focus",
        "Spot size against film position. Separate minima mean curvature of field; a high, flat minimum is an "
        "aberration that focusing does not remove.",
        [&] { return petzval::focus_figure(colours, spots, weights); });
  }
  if (aberrations.mtf_chart && !aberrations.mtf_chart->empty()) {
    add("mtf_chart", "MTF chart",
        "Contrast from the centre to the edge of the picture, with diffraction, as makers of lenses print it: 10 lines "
        "per mm show contrast, 30 and 40 sharpness. Makers often call tangential lines meridional and state whether "
        "diffraction is included.",
        [&] { return petzval::mtf_chart_figure(colours, subject_z, *aberrations.mtf_chart, weights); });
  }
  if (aberrations.mtf) {
    add("mtf", "Contrast", "Contrast of fine lines. Where the curves of a field separate there is astigmatism or coma.",
        [&] {
          const auto& diffraction = aberrations.mtf_diffraction;
          return petzval::mtf_figure(colours, subject_z, *aberrations.mtf,
                                     diffraction ? *diffraction : petzval::Grid<petzval::MtfPoint>{{}, 1});
        });
  }
  if (aberrations.mtf_through_focus && !aberrations.mtf_through_focus->values.empty()) {
    add("mtf_focus", "Contrast through focus",
        "Contrast of 30 lines per mm on films in front of and behind the film. Peaks of tangential and sagittal curves "
        "at different films are astigmatism, of different fields curvature of field.",
        [&] {
          return petzval::mtf_focus_figure(colours, subject_z, petzval::mtf_film_shifts(aberrations),
                                           *aberrations.mtf_through_focus);
        });
  }
  if (aberrations.mtf_over_field && aberrations.mtf_over_field->size() > 0) {
    add("mtf_field", "Contrast over the field",
        "Contrast of lines of three widths from the centre to the edge. A drop towards the edge is curvature of field, "
        "astigmatism or lateral colour.",
        [&] { return petzval::mtf_field_figure(colours, subject_z, *aberrations.mtf_over_field); });
  }
  if (aberrations.longitudinal_aberration) {
    add("colour", "Spherical aberration and colour",
        "Where rays of the axial point cross the axis, over their height on the stop. A bent curve is spherical "
        "aberration; distances between the colours at the bottom are axial colour. On the right, if there are several "
        "wavelengths and fields: lateral colour.",
        [&] { return petzval::colour_figure(colours, subject_z, farthest); });
  }
  if (farthest != 0) {
    if (aberrations.field_curvature) {
      add("field", "Field curvature and distortion",
          "Where narrow beams are sharp, in both sections, and how far the image is from the projection. Two separate "
          "curves on the left are astigmatism.",
          [&] { return petzval::field_figure(lens, subject_z, farthest); });
    }
    if (aberrations.seidel) {
      add("seidel", "Seidel sums",
          "Third-order aberrations and colour that each surface contributes, for the largest field. Long bars of both "
          "signs that cancel make a lens sensitive to errors.",
          [&] { return petzval::seidel_figure(colours, subject_z, *aberrations.seidel, first); });
    }
    add("illumination", "Brightness",
        "Irradiance on the film from the centre to the edge of the field. Below cos\u2074 rims vignette; above it the "
        "pupil grows with the field, as in fisheyes and retrofocus lenses.",
        [&] { return petzval::illumination_figure(lens, subject_z, farthest); });
  }
  petzval::Grid<std::optional<double>> over_wavelength{{}, 1}, over_field{{}, 1};
  std::vector<double> steps_rad;
  if (light && light->visible) {
    over_wavelength = petzval::transmittance(*light->visible, examples::subject_z(r.subject, *light->visible), fields,
                                             examples::threads());
    add("transmittance", "Transmittance",
        "The fraction of the light that the lens passes, mean over the pupil. A slope colours the picture: less blue "
        "is warm.",
        [&] { return petzval::transmittance_figure(*light->visible, subject_z, fields, over_wavelength); });
  }
  if (light && farthest != 0) {
    constexpr int steps = 20;
    for (int k = 0; k <= steps; ++k) steps_rad.push_back(farthest * k / steps);
    over_field = petzval::transmittance(light->colours, subject_z, steps_rad, examples::threads());
    add("transmittance_field", "Transmittance over the field",
        "Steep rays at the edge lose more light. Vignetting is not included: the pupil counts as 1.",
        [&] { return petzval::transmittance_field_figure(light->colours, subject_z, steps_rad, over_field); });
  }
  draw_all();
  return result;
}

std::string lens_page(const Report& r, const petzval::LensReport& aberrations, const std::vector<LensFigure>& figures,
                      const std::optional<LightReport>& light, const GhostReport& ghosts) {
  const petzval::Lens& lens = r.loaded.lens;
  const std::string name = escaped_html(lens.name());
  std::ostringstream html;
  html.imbue(std::locale::classic());
  html << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>"
       << name << "</title>\n<style>\n"
       << page_style << "</style>\n</head>\n<body>\n<h1>" << name << "</h1>\n<p class=\"lead\">"
       << escaped_html(r.loaded.prescription.source_design) << "</p>\n<p class=\"lead\">"
       << escaped_html(conditions(r.subject)) << "</p>\n";
  html << "<h2>First order</h2>\n<p class=\"lead\">At " << number(lens.wavelengths_nm()[0])
       << " nm. Stop: " << stop_in_words(r) << "; " << numbering_in_words(r)
       << ". z counts from the first vertex towards the film.</p>\n";
  first_order_table(html, r);
  for (const LensFigure& figure : figures) {
    html << "<h2>" << figure.title << "</h2>\n<figure>\n<div class=\"scroll\">" << figure.svg << "</div><figcaption>"
         << figure.caption << "</figcaption>\n</figure>\n";
  }
  wavefront_table(html, r, aberrations);
  third_order_table(html, r, aberrations);
  if (light) light_table(html, *light);
  ghost_table(html, r, ghosts);
  html << "<h2>Lint</h2>\n";
  if (r.findings.empty()) html << "<p class=\"lead\">No findings: declared and computed values agree.</p>\n";
  if (!r.findings.empty()) {
    html << "<ul>\n";
    for (const petzval::Finding& finding : r.findings) html << "<li>" << escaped_html(finding.message) << "</li>\n";
    html << "</ul>\n";
  }
  html << "<h2>Table</h2>\n<p class=\"lead\">Millimetres; " << numbering_in_words(r)
       << ". Edge thickness: distance to the next surface along the axis, at the larger of the two semi-diameters; "
          "negative if the surfaces intersect below.</p>\n";
  surface_table(html, r);
  asphere_table(html, r);
  position_table(html, r);
  html << "<h2>Sources</h2>\n";
  sources(html, r.loaded.prescription);
  html << "</body>\n</html>\n";
  return with_contents(std::move(html).str());
}

}  // namespace examples
