// SPDX-License-Identifier: Apache-2.0
#include "lens_report.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iomanip>
#include <locale>
#include <sstream>
#include <string_view>
#include <utility>

#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// The declared kind of aperture, computed for this lens; nullopt if no rim limits the beam.
std::optional<double> computed_aperture(const petzval::Lens& lens, const petzval::DesignData& design,
                                        const petzval::LensReport::Section& section) {
  using enum petzval::ApertureSetting;
  if (!section.pupils) return {};
  const petzval::FirstOrder& first = section.first_order;
  const petzval::Pupil &entrance = section.pupils->entrance, &exit = section.pupils->exit;
  const double object = design.object_distance_mm;
  const bool by_exact_rays = std::isinf(object) && !first.afocal;
  const double image_z = petzval::paraxial_image_z(lens, -object, 0, section.meridian);
  const double slope = entrance.diameter / 2 / std::abs(entrance.z + object);
  const double image_slope = exit.diameter / 2 / std::abs(image_z - exit.z);
  switch (design.aperture->setting) {
    case entrance_pupil_diameter:
      return by_exact_rays ? std::abs(first.effective_focal_length) / petzval::real_f_number(lens) : entrance.diameter;
    case f_number:
      return by_exact_rays ? petzval::real_f_number(lens) : std::abs(first.effective_focal_length) / entrance.diameter;
    case working_f_number: return 1 / (2 * image_slope);
    case object_na: return first.object_index * std::sin(std::atan(slope));
    case image_na: return std::abs(first.image_index) * std::sin(std::atan(image_slope));
    case stop_size: return lens.surfaces()[section.pupils->stop].semi_diameter;
  }
  return {};
}

/// The declared value of an aperture; nullopt if the aperture is given by the stop in the table.
std::optional<double> declared_value(const petzval::DesignAperture& aperture) {
  const bool by_table = aperture.setting == petzval::ApertureSetting::stop_size && aperture.value == 0;
  return by_table ? std::nullopt : std::optional(aperture.value);
}

/// The members of an object, with more members behind some of its keys. These replace members of the same key.
Json merged(const Json& object, std::initializer_list<std::pair<std::string_view, Json>> more) {
  Json json = Json::object();
  for (const auto& [key, value] : object.items()) {
    json.emplace(key, Json(value));
    for (const auto& [behind, members] : more) {
      if (behind == key) json.update(members);
    }
  }
  return json;
}

}  // namespace

double subject_z(const ReportSubject& subject, const petzval::Lens& lens) {
  return petzval::origin_z(lens, subject.focus.origin) - subject.distance_mm;
}

petzval::LensReport::Conditions conditions(const Report& r, const petzval::Lens& colours) {
  return {.subject_z = subject_z(r.subject, colours),
          .fields_deg = r.subject.fields.degrees,
          .wavelength_weights = r.subject.light.weights,
          .first_surface_number = r.loaded.first_surface_number,
          .threads = threads(),
          .entrance_pupil_diameter = r.declared_pupil ? std::optional(r.declared_pupil->diameter) : std::nullopt};
}

std::vector<Entry> entries(const Report& r, const petzval::LensReport::Section& section) {
  const petzval::FirstOrder& first = section.first_order;
  const bool main = &section == &r.main();
  const bool in_air = std::abs(std::abs(first.image_index) - 1) < 0.01;  // also with the index of air
  std::vector<Entry> rows{
      {in_air ? "effective focal length" : "effective focal length in air (1 / power)", "mm",
       first.effective_focal_length},
      {"back focal distance (last vertex to rear focal point)", "mm", first.back_focal_distance},
      {"front focal distance (first vertex to front focal point)", "mm", first.front_focal_distance},
      {"front principal plane, z", "mm", first.front_principal_z},
      {"rear principal plane, z", "mm", first.rear_principal_z}};
  if (section.pupils) {
    const petzval::Pupil &entrance = section.pupils->entrance, &exit = section.pupils->exit;
    rows.push_back({"entrance pupil, z", "mm", entrance.z});
    rows.push_back({"entrance pupil, diameter (image of the rim of the stop)", "mm", entrance.diameter});
    rows.push_back({"exit pupil, z", "mm", exit.z});
    rows.push_back({"exit pupil, diameter", "mm", exit.diameter});
    if (main && r.first_order.f_number)
      rows.push_back({"f-number (exact ray to the rim of the stop)", "", *r.first_order.f_number});
    rows.push_back(
        {"f-number, paraxial (EFL / entrance pupil)", "", std::abs(first.effective_focal_length) / entrance.diameter});
  }
  if (main && r.declared_pupil) {
    rows.push_back({"entrance pupil as declared in the file (EPD of OpticStudio)", "mm", r.declared_pupil->diameter});
    rows.push_back({"EFL / declared pupil (image space F/# of OpticStudio)", "", r.declared_pupil->f_number});
  }
  rows.push_back({"Petzval sum", "1/mm", first.petzval_sum});
  return rows;
}

std::string in_words(const ReportSubject& subject) {
  std::string text = "subject ";
  text += std::isinf(subject.distance_mm)
              ? "at infinity"
              : number(subject.distance_mm) + " mm from the " + in_words(subject.focus.origin);
  if (subject.distance_of_file) text += " (as in the file)";
  return text + "; film " +
         (subject.film_of_file ? "as in the file" : "in focus (" + in_words(subject.focus.criterion) + ")");
}

std::string in_words(const ReportLight& light) {
  std::string text;
  for (std::size_t i = 0; i < light.wavelengths_nm.size(); ++i) {
    text += (i == 0 ? "" : ", ") + number(light.wavelengths_nm[i], 6) + " nm";
    if (light.wavelengths_nm.size() > 1) text += " (weight " + number(light.weights[i], 3) + ")";
  }
  return text;
}

std::string in_words(const ReportFields& fields) {
  std::string text;
  for (const double field : fields.degrees) text += (text.empty() ? "" : ", ") + number(field, 5);
  return text + " degrees";
}

Report report(LoadedLens loaded, ReportSubject subject, const std::optional<DeclaredPupil>& declared_pupil) {
  auto first_order = petzval::lens_report(loaded.lens);
  auto findings = petzval::lint(loaded.prescription, loaded.glasses, loaded.first_surface_number);
  return {std::move(loaded), std::move(subject), declared_pupil, std::move(first_order), std::move(findings)};
}

/// Numbers of the surfaces whose aperture the source does not state.
std::vector<int> computed_apertures(const Report& r) {
  std::vector<int> result;
  const auto& surfaces = r.loaded.prescription.surfaces;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i].semi_diameter_computed) result.push_back(r.surface_number(i));
  }
  return result;
}

Json to_json(const Report& r, const petzval::LensReport& aberrations) {
  const petzval::Lens& lens = r.loaded.lens;
  const auto declared = [](const std::optional<DeclaredPupil>& pupil) {
    return Json{{"declared_entrance_pupil_diameter_mm", pupil ? finite_or_null(pupil->diameter) : Json()},
                {"declared_f_number", pupil ? finite_or_null(pupil->f_number) : Json()}};
  };
  Json aperture;
  if (const auto& stated = r.loaded.prescription.design.aperture) {
    const auto value = [](std::optional<double> one) { return one ? finite_or_null(*one) : Json(); };
    aperture = {{"setting", petzval::name(stated->setting)},
                {"value", value(declared_value(*stated))},
                {"computed", value(computed_aperture(lens, r.loaded.prescription.design, r.main()))}};
  }
  const ReportSubject& subject = r.subject;
  const Json stated_conditions{
      {"design_aperture", aperture},
      {"subject_distance_mm", finite_or_null(subject.distance_mm)},
      {"subject_distance_of_file", subject.distance_of_file},
      {"distance_from", petzval::name(subject.focus.origin)},
      {"film", subject.film_of_file ? "file" : "focus"},
      {"criterion", subject.film_of_file ? Json() : Json(petzval::name(subject.focus.criterion))},
      {"wavelengths_nm", subject.light.wavelengths_nm},
      {"wavelength_weights", subject.light.weights},
      {"wavelengths_of_file", subject.light.of_file},
      {"fields_deg", subject.fields.degrees},
      {"fields_of_file", subject.fields.of_file}};
  Json warnings = Json::array(), findings = Json::array();
  const auto& imported = r.loaded.prescription.imported;
  for (std::size_t i = 0; imported && i < imported->warnings.size(); ++i) {
    const petzval::ImportWarning& w = imported->warnings[i];
    warnings.push_back({{"line", w.line}, {"command", w.command}, {"message", w.message}});
  }
  for (const petzval::Finding& finding : r.findings) {
    findings.push_back({{"kind", petzval::name(finding.kind)},
                        {"surface", finding.surface ? Json(*finding.surface + r.loaded.first_surface_number) : Json()},
                        {"found", finite_or_null(finding.found)},
                        {"wanted", finite_or_null(finding.expected)},
                        {"message", finding.message}});
  }
  Json json =
      merged(Json::parse(petzval::to_json(aberrations)),
             {{"f_number_paraxial", declared(r.declared_pupil)},
              {"film_z_mm", stated_conditions},
              {"failures", {{"computed_apertures", computed_apertures(r)}}},
              {"edge_thicknesses_mm", {{"format", imported ? imported->format : "petzval"}, {"warnings", warnings}}},
              {"missing_glasses", {{"lint", findings}}}});
  for (auto& [meridian, section] : json["meridians"].items()) {
    const bool main = meridian == json["meridian"];
    section = merged(section, {{"f_number_paraxial", declared(main ? r.declared_pupil : std::nullopt)}});
  }
  return json;
}

const char* section_name(petzval::Meridian meridian) { return meridian == petzval::Meridian::y ? "y-z" : "x-z"; }

std::string stop_in_words(const Report& r) {
  const auto& pupils = r.main().pupils;
  if (!pupils) return "none: no rim limits the beam";
  return "surface " + std::to_string(r.surface_number(pupils->stop)) +
         (pupils->stop_inferred ? " (inferred: no surface with a rim is marked)" : "");
}

std::string numbering_in_words(const Report& r) {
  return "surfaces are numbered from " + std::to_string(r.loaded.first_surface_number);
}

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
       << ", stop: " << stop_in_words(r) << "\nat " << number(lens.wavelengths_nm()[0])
       << " nm, dispersion: " << petzval::name(lens.dispersion()) << "; " << numbering_in_words(r)
       << "; z counts from the first vertex towards the film\n"
       << in_words(r.subject) << '\n';
  const auto line = [&](const std::string& label, double value, const char* unit) {
    text << "  " << std::left << std::setw(58) << label << std::right << std::setw(14) << in_words(value)
         << (*unit ? " " : "") << unit << '\n';
  };
  const auto& sections = r.first_order.sections;
  for (const petzval::LensReport::Section& meridian : sections) {
    text << '\n';
    if (sections.size() > 1) text << "in the section " << section_name(meridian.meridian) << ":\n";
    for (const Entry& entry : entries(r, meridian)) line(entry.label, entry.value, entry.unit);
    if (&meridian == &r.main()) line("film, z", lens.film_z(), "mm");
    if (const auto& aperture = r.loaded.prescription.design.aperture; aperture && &meridian == &r.main()) {
      using enum petzval::ApertureSetting;
      const bool length = aperture->setting == entrance_pupil_diameter || aperture->setting == stop_size;
      const std::string label = "aperture of the file, " + std::string(petzval::name(aperture->setting));
      if (const auto value = declared_value(*aperture)) line(label, *value, length ? "mm" : "");
      if (const auto value = computed_aperture(lens, r.loaded.prescription.design, meridian)) {
        line(declared_value(*aperture) ? "computed for this lens" : label, *value, length ? "mm" : "");
      }
    }
    if (meridian.first_order.afocal) {
      text << (sections.size() > 1 ? "\nIn this section the lens" : "\nThe lens")
           << " is afocal: it has no focal length and no focal or principal points.\n";
    }
  }
  if (const auto computed = computed_apertures(r); !computed.empty()) {
    text << "\nclear apertures computed from the beam because the source states no value: surface"
         << (computed.size() == 1 ? " " : "s ");
    for (const int i : computed) text << (i == computed.front() ? "" : ", ") << i;
    text << '\n';
  }
  if (const auto& imported = r.loaded.prescription.imported) {
    text << "\nread from " << imported->file << " (" << imported->format << ", lengths in " << imported->units
         << "); assumed:" << (imported->warnings.empty() ? " nothing" : "") << '\n';
    for (const petzval::ImportWarning& w : imported->warnings) {
      text << "  " << (w.line > 0 ? "line " + std::to_string(w.line) + ": " : "") << w.command << ' ' << w.message
           << '\n';
    }
  }
  std::string missing;
  for (std::size_t space = 1; space <= lens.surface_count(); ++space) {
    const petzval::Medium& medium = r.loaded.prescription.surfaces[space - 1].medium;
    if (medium == petzval::Medium{} || r.loaded.prescription.surfaces[space - 1].mirror) continue;
    if (petzval::glass_of(medium, r.loaded.glasses) || !medium.nd) continue;
    missing += (missing.empty() ? "" : ", ") + std::to_string(r.surface_number(space - 1));
    if (medium.glass) missing += " (" + *medium.glass + ")";
  }
  if (!missing.empty()) {
    text << "\nmedia without a glass in the tables, after surfaces " << missing
         << "\n  --match-glasses takes the nearest glasses, --glasses FILE adds a catalogue\n";
  }
  text << "\nlint: " << (r.findings.empty() ? "no findings" : "") << '\n';
  for (const petzval::Finding& finding : r.findings) {
    text << "  " << petzval::name(finding.kind) << ": " << finding.message << '\n';
  }
  return text.str();
}

}  // namespace examples
