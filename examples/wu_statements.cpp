// SPDX-License-Identifier: Apache-2.0
// Compares the statements of Wu et al. 2010 about their figure 7 with radial profiles, for two meanings of "in focus"
// and two origins of "distance from the lens".
//
//   wu_statements --html wu_statements.html
#include <algorithm>
#include <array>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"
#include "support/textbook_pupil.hpp"
#include "support/wu2010.hpp"

namespace {

using examples::Look;

struct Verdict {
  std::string lens;
  double focus_mm = 0;
  Look printed{};
  std::string criterion, origin;
  Look found{};
  bool agrees = false;
  double rms_radius = 0;
  examples::ProfileShape shape;
};

/// The five pictures of one lens for one interpretation of the text.
std::vector<Verdict> verdicts(const examples::WuRow& wu, const petzval::Lens& lens, const examples::BokehSetup& setup,
                              std::uint32_t samples) {
  std::vector<Verdict> row;
  std::size_t sharpest = 0;
  for (std::size_t i = 0; i < examples::wu_focus_mm.size(); ++i) {
    const double focus = examples::wu_focus_mm[i];
    const auto scene = examples::focused_scene(lens, focus, setup);
    const auto image =
        petzval::point_image(scene.lens, scene.light, {.samples = samples, .threads = examples::threads()});
    const auto shape = examples::profile_shape(image.radial_profile);
    row.push_back({.lens = wu.lens,
                   .focus_mm = focus,
                   .printed = wu.printed[i],
                   .criterion = std::string(petzval::name(setup.focus.criterion)),
                   .origin = setup.focus.origin == petzval::DistanceOrigin::film ? "film" : "front_vertex",
                   .found = examples::look(shape),
                   .agrees = false,
                   .rms_radius = image.size.rms_radius,
                   .shape = shape});
    if (row[i].rms_radius < row[sharpest].rms_radius) sharpest = i;
  }
  // Sharpness is tested only for the picture that the paper calls in focus.
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i].printed == Look::point && i == sharpest) row[i].found = Look::point;
    row[i].agrees = row[i].found == row[i].printed;
  }
  return row;
}

std::vector<Verdict> all_verdicts(std::uint32_t samples) {
  using petzval::DistanceOrigin, petzval::FocusCriterion;
  std::vector<Verdict> all;
  examples::Progress progress("statements", examples::wu_rows().size() * 4);
  for (const examples::WuRow& wu : examples::wu_rows()) {
    const auto file = petzval::data_directory() / "lenses" / (std::string(wu.lens) + ".json");
    const auto loaded = examples::load_lens({.file = file.string()}, std::array{petzval::d_line_nm});
    for (const FocusCriterion criterion : {FocusCriterion::paraxial, FocusCriterion::min_rms}) {
      for (const DistanceOrigin origin : {DistanceOrigin::front_vertex, DistanceOrigin::film}) {
        progress.step(wu.lens);
        const auto row =
            verdicts(wu, loaded.lens,
                     {.light_mm = examples::wu_light_mm, .focus = {.criterion = criterion, .origin = origin}}, samples);
        all.insert(all.end(), row.begin(), row.end());
      }
    }
  }
  return all;
}

std::array<std::string, 12> cells(const Verdict& v) {
  return {v.lens,
          examples::number(v.focus_mm),
          v.criterion,
          v.origin,
          words(v.printed),
          words(v.found),
          v.agrees ? "yes" : "NO",
          examples::fixed(v.rms_radius, 3),
          examples::fixed(v.shape.core, 2),
          examples::fixed(v.shape.brightest, 2) + " at " + examples::fixed(0.1 * v.shape.brightest_ring + 0.05, 2),
          examples::fixed(v.shape.darkest_inside, 2),
          examples::fixed(v.shape.deviation, 2)};
}

constexpr std::array<const char*, 12> headings{"lens",    "focus mm",       "criterion",      "distances from",
                                               "printed", "found",          "agrees",         "RMS mm",
                                               "core",    "brightest ring", "darkest inside", "deviation"};

/// Entrance pupils by steps 1 to 8 of the paper for the light at 1000 mm, compared with the images of the stop.
using PupilCells = std::array<std::string, 4>;
std::vector<PupilCells> pupils() {
  std::vector<PupilCells> rows{{"lens", "textbook pupil mm", "limited by surface", "image of the stop mm"}};
  for (const examples::WuRow& wu : examples::wu_rows()) {
    const auto file = petzval::data_directory() / "lenses" / (std::string(wu.lens) + ".json");
    const petzval::Lens lens = examples::load_lens({.file = file.string()}, std::array{petzval::d_line_nm}).lens;
    const auto textbook = examples::textbook_entrance_pupil(lens, -examples::wu_light_mm);
    rows.push_back({wu.lens, examples::fixed(textbook.diameter, 3), std::to_string(textbook.limiting),
                    examples::fixed(petzval::pupils(lens).entrance.diameter, 3)});
  }
  return rows;
}

/// Columns side by side, each as wide as its longest cell.
template <std::size_t n>
std::string to_text(const std::vector<std::array<std::string, n>>& rows) {
  std::array<std::size_t, n> widths{};
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::ostringstream text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text << row[c] << (c + 1 < row.size() ? std::string(widths[c] - row[c].size() + 2, ' ') : "\n");
    }
  }
  return text.str();
}

std::string to_text(const std::vector<Verdict>& all) {
  std::vector<std::array<std::string, 12>> rows(1);
  std::copy(headings.begin(), headings.end(), rows[0].begin());
  for (const Verdict& v : all) rows.push_back(cells(v));
  return to_text(rows);
}

/// A table for the gallery: one line per statement, the four interpretations side by side.
std::string to_html(const std::vector<Verdict>& all) {
  std::ostringstream html;
  html << "<table class=\"statements\">\n<thead><tr><th rowspan=\"2\">lens</th><th rowspan=\"2\">focus</th>"
          "<th rowspan=\"2\">the paper says</th><th colspan=\"2\">film at the paraxial focus</th>"
          "<th colspan=\"2\">film at least RMS blur</th></tr>\n<tr>";
  for (int i = 0; i < 2; ++i) html << "<th>from front vertex</th><th>from film</th>";
  html << "</tr></thead>\n<tbody>\n";
  const std::size_t columns = examples::wu_focus_mm.size();
  for (std::size_t lens = 0; lens < examples::wu_rows().size(); ++lens) {
    for (std::size_t i = 0; i < columns; ++i) {
      const Verdict* first = &all[lens * 4 * columns + i];
      html << "<tr" << (i == 0 ? " class=\"first\"" : "") << '>';
      if (i == 0) html << "<th rowspan=\"" << columns << "\">" << examples::wu_rows()[lens].title << "</th>";
      html << "<td>" << examples::number(first->focus_mm) << " mm</td><td>" << words(first->printed) << "</td>";
      for (std::size_t reading = 0; reading < 4; ++reading) {
        const Verdict& v = first[reading * columns];
        html << "<td class=\"" << (v.agrees ? "yes\">&#10003; " : "no\">&#10007; ") << words(v.found) << "</td>";
      }
      html << "</tr>\n";
    }
  }
  html << "</tbody></table>\n";
  return html.str();
}

}  // namespace

int main(int argc, char** argv) {
  std::string html_file;
  std::uint32_t samples = 1u << 18;
  examples::App app(
      "Compares the statements of Wu et al. 2010 about their figure 7 with radial profiles, and prints a table.\n"
      "Irradiances are relative to the mean of the disc: core (within 0.2 of the radius), brightest of ten rings, "
      "darkest ring inside the brightest ring, and deviation (RMS over the area). Appearances:\n"
      "uniform: deviation below 0.25, core and innermost tenth below 1.25\n"
      "nearly uniform with a bright core: core or innermost tenth above 1.25\n"
      "ring: the brightest ring is in the outer half; with a slight core if the core is at least 1.5 times as bright "
      "as the darkest ring\n"
      "core: the brightest ring is in the inner half; with a dark centre if the innermost tenth is below 0.95 of the "
      "brightest ring\n"
      "sharpest: smallest RMS radius\n"
      "A second table has the entrance pupils by the paper's steps 1 to 8.",
      "wu_statements");
  examples::add_samples(app, samples);
  examples::add_out_file(app, html_file, "HTML file for the table", "FILE", "--html");

  return examples::run(app, argc, argv, [&] {
    const std::vector<Verdict> all = all_verdicts(samples);
    if (!html_file.empty()) examples::write_text(html_file, to_html(all));
    std::cout << to_text(all) << '\n' << to_text(pupils());
  });
}
