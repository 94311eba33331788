// SPDX-License-Identifier: Apache-2.0
// Prints what a lens is to first order, its pupils and f-numbers, and what a careful reader would ask about its table.
//
//   lens_report data/lenses/double_gauss_100mm_f1.35.json
//   lens_report data/lenses/double_gauss_100mm_f1.35.json --json --wavelength-nm 486.1327
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "petzval/core/text.hpp"
#include "petzval/core/units.hpp"
#include "petzval/lint/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/pupil.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"

namespace {

using examples::finite_or_null;
using examples::Json;

/// One number of the report: its key in the JSON, and how the table says it.
struct Entry {
  const char* key;
  const char* label;
  const char* unit;
  double value;
};

struct Report {
  examples::LoadedLens loaded;
  petzval::FirstOrder first_order;
  std::optional<petzval::Pupils> pupils;  ///< none where nothing limits the beam
  std::vector<Entry> entries;
  std::vector<petzval::Finding> findings;
};

Report report(examples::LoadedLens loaded) {
  const petzval::Lens& lens = loaded.lens;
  const petzval::Meridian meridian = petzval::main_meridian(lens);
  const petzval::FirstOrder first = petzval::first_order(lens, 0, meridian);
  std::vector<Entry> entries{
      {"effective_focal_length_mm", "effective focal length", "mm", first.effective_focal_length},
      {"back_focal_distance_mm", "back focal distance (last vertex to rear focal point)", "mm",
       first.back_focal_distance},
      {"front_focal_distance_mm", "front focal distance (first vertex to front focal point)", "mm",
       first.front_focal_distance},
      {"front_principal_z_mm", "front principal plane, z", "mm", first.front_principal_z},
      {"rear_principal_z_mm", "rear principal plane, z", "mm", first.rear_principal_z}};

  // Pupils are images of the rim that limits the beam: without one there are none.
  std::optional<petzval::Pupils> pupils;
  const auto limits = [](const petzval::LensSurface& s) { return std::isfinite(s.semi_diameter); };
  if (std::ranges::any_of(lens.surfaces(), limits)) {
    pupils = petzval::pupils(lens, 0, meridian);
    entries.insert(
        entries.end(),
        {{"entrance_pupil_z_mm", "entrance pupil, z", "mm", pupils->entrance.z},
         {"entrance_pupil_diameter_mm", "entrance pupil, diameter", "mm", pupils->entrance.diameter},
         {"exit_pupil_z_mm", "exit pupil, z", "mm", pupils->exit.z},
         {"exit_pupil_diameter_mm", "exit pupil, diameter", "mm", pupils->exit.diameter},
         {"f_number", "f-number, paraxial", "", petzval::paraxial_f_number(lens)},
         {"f_number_real", "f-number by the exact ray to the rim of the stop", "", petzval::real_f_number(lens)}});
  }
  entries.push_back({"petzval_sum_per_mm", "Petzval sum", "1/mm", first.petzval_sum});
  entries.push_back({"film_z_mm", "film, z", "mm", lens.film_z()});
  auto findings = petzval::lint(loaded.prescription);
  return {std::move(loaded), first, pupils, std::move(entries), std::move(findings)};
}

Json to_json(const Report& r) {
  const petzval::Lens& lens = r.loaded.lens;
  Json json{{"name", lens.name()},
            {"dispersion", petzval::name(lens.dispersion())},
            {"wavelength_nm", lens.wavelengths_nm()[0]},
            {"afocal", r.first_order.afocal},
            {"stop_surface", r.pupils ? Json(r.pupils->stop) : Json(nullptr)},
            {"stop_inferred", r.pupils && r.pupils->stop_inferred}};
  for (const char* key : {"entrance_pupil_z_mm", "entrance_pupil_diameter_mm", "exit_pupil_z_mm",
                          "exit_pupil_diameter_mm", "f_number", "f_number_real"}) {
    json[key] = nullptr;
  }
  for (const Entry& entry : r.entries) json[entry.key] = finite_or_null(entry.value);
  json["lint"] = Json::array();
  for (const petzval::Finding& finding : r.findings) {
    json["lint"].push_back({{"kind", petzval::name(finding.kind)},
                            {"surface", finding.surface ? Json(*finding.surface) : Json(nullptr)},
                            {"found", finite_or_null(finding.found)},
                            {"wanted", finite_or_null(finding.wanted)},
                            {"message", finding.message}});
  }
  return json;
}

std::string stop_in_words(const std::optional<petzval::Pupils>& pupils) {
  if (!pupils) return "none: nothing limits the beam";
  return "surface " + std::to_string(pupils->stop) + (pupils->stop_inferred ? " (inferred: none is marked)" : "");
}

/// Fixed decimals as an optician reads them; small sums in scientific notation.
std::string in_words(double value) {
  if (std::isinf(value)) return value > 0 ? "infinite" : "-infinite";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << (value != 0 && (std::abs(value) < 0.01 || std::abs(value) >= 1e7) ? std::scientific : std::fixed)
       << std::setprecision(4) << value;
  return text.str();
}

std::string to_text(const Report& r) {
  const petzval::Lens& lens = r.loaded.lens;
  std::ostringstream text;
  text << lens.name() << '\n'
       << lens.surface_count() << (lens.surface_count() == 1 ? " surface" : " surfaces")
       << ", stop: " << stop_in_words(r.pupils) << "\nat " << petzval::number(lens.wavelengths_nm()[0])
       << " nm, dispersion: " << petzval::name(lens.dispersion())
       << "; z counts from the first vertex towards the film\n\n";
  for (const Entry& entry : r.entries) {
    text << "  " << std::left << std::setw(58) << entry.label << std::right << std::setw(14) << in_words(entry.value)
         << (*entry.unit ? " " : "") << entry.unit << '\n';
  }
  if (r.first_order.afocal) text << "\nThe lens is afocal: it has no focal length and no focal or principal points.\n";
  text << "\nlint: " << (r.findings.empty() ? "nothing to ask about" : "") << '\n';
  for (const petzval::Finding& finding : r.findings) {
    text << "  " << petzval::name(finding.kind) << ": " << finding.message << '\n';
  }
  return text.str();
}

}  // namespace

int main(int argc, char** argv) {
  std::string lens_file;
  double wavelength_nm = petzval::d_line_nm;
  bool json = false;

  CLI::App app(
      "Reports the first-order data, pupils, f-numbers and lint findings of a lens. Lengths in mm; z from the "
      "first vertex, towards the film. Findings are no failure.",
      "lens_report");
  app.add_option("LENS.json", lens_file, "lens prescription (JSON as in data/lenses)")->required();
  app.add_flag("--json", json, "print one JSON object; null stands for infinite and for what the lens has not");
  examples::add_number(app, "--wavelength-nm", wavelength_nm, examples::positive_number, "wavelength (nm)");

  return examples::run(app, argc, argv, [&] {
    const Report r = report(examples::load_lens(lens_file, std::array{wavelength_nm}));
    std::cout << (json ? to_json(r).dump(2) + '\n' : to_text(r));
  });
}
