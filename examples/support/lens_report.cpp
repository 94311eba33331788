// SPDX-License-Identifier: Apache-2.0
#include "lens_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <utility>

#include "petzval/analysis/aberrations.hpp"
#include "petzval/analysis/seidel.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {
namespace {

MeridianReport in_meridian(const petzval::Lens& lens, petzval::Meridian meridian) {
  MeridianReport r{meridian, petzval::first_order(lens, 0, meridian), std::nullopt, {}};
  const petzval::FirstOrder& first = r.first_order;
  const bool in_air = std::abs(std::abs(first.image_index) - 1) < 0.01;  // also with the index of air
  r.entries = {
      {"effective_focal_length_mm", in_air ? "effective focal length" : "effective focal length in air (1 / power)",
       "mm", first.effective_focal_length},
      {"back_focal_distance_mm", "back focal distance (last vertex to rear focal point)", "mm",
       first.back_focal_distance},
      {"front_focal_distance_mm", "front focal distance (first vertex to front focal point)", "mm",
       first.front_focal_distance},
      {"front_principal_z_mm", "front principal plane, z", "mm", first.front_principal_z},
      {"rear_principal_z_mm", "rear principal plane, z", "mm", first.rear_principal_z}};

  // Without a rim that limits the beam there are no pupils.
  if (petzval::has_pupils(lens)) {
    r.pupils = petzval::pupils(lens, 0, meridian);
    const petzval::Pupil &entrance = r.pupils->entrance, &exit = r.pupils->exit;
    r.entries.insert(r.entries.end(),
                     {{"entrance_pupil_z_mm", "entrance pupil, z", "mm", entrance.z},
                      {"entrance_pupil_diameter_mm", "entrance pupil, diameter (image of the rim of the stop)", "mm",
                       entrance.diameter},
                      {"exit_pupil_z_mm", "exit pupil, z", "mm", exit.z},
                      {"exit_pupil_diameter_mm", "exit pupil, diameter", "mm", exit.diameter}});
    if (meridian == petzval::main_meridian(lens)) {
      r.entries.push_back(
          {"f_number", "f-number (exact ray to the rim of the stop)", "", petzval::aperture_state(lens).f_number});
    }
    r.entries.push_back({"f_number_paraxial", "f-number, paraxial (EFL / entrance pupil)", "",
                         std::abs(first.effective_focal_length) / entrance.diameter});
  }
  r.entries.push_back({"petzval_sum_per_mm", "Petzval sum", "1/mm", first.petzval_sum});
  return r;
}

/// The declared kind of aperture, computed for this lens; nullopt if no rim limits the beam.
std::optional<double> computed_aperture(const petzval::Lens& lens, const petzval::DesignData& design,
                                        const MeridianReport& r) {
  using enum petzval::ApertureSetting;
  if (!r.pupils) return {};
  const petzval::FirstOrder& first = r.first_order;
  const petzval::Pupil &entrance = r.pupils->entrance, &exit = r.pupils->exit;
  const double object = design.object_distance_mm;
  const bool by_exact_rays = std::isinf(object) && !first.afocal;
  const double image_z = petzval::paraxial_image_z(lens, -object, 0, r.meridian);
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
    case stop_size: return lens.surfaces()[r.pupils->stop].semi_diameter;
  }
  return {};
}

/// The declared value of an aperture; nullopt if the aperture is given by the stop in the table.
std::optional<double> declared_value(const petzval::DesignAperture& aperture) {
  const bool by_table = aperture.setting == petzval::ApertureSetting::stop_size && aperture.value == 0;
  return by_table ? std::nullopt : std::optional(aperture.value);
}

/// The numbers of one meridian; null if absent.
Json numbers(const MeridianReport& r) {
  Json json{{"afocal", r.first_order.afocal}};
  for (const char* key :
       {"entrance_pupil_z_mm", "entrance_pupil_diameter_mm", "exit_pupil_z_mm", "exit_pupil_diameter_mm", "f_number",
        "f_number_paraxial", "declared_entrance_pupil_diameter_mm", "declared_f_number"}) {
    json[key] = nullptr;
  }
  for (const Entry& entry : r.entries) json[entry.key] = finite_or_null(entry.value);
  return json;
}

/// Seidel sums and paraxial rays of the largest field; null if paraxial_rays() or seidel_sums() throws Error.
Json third_order(const Report& r, const petzval::Lens& lens) {
  Json json{
      {"seidel", nullptr}, {"seidel_sums", nullptr}, {"paraxial_rays", nullptr}, {"optical_invariant_mm", nullptr}};
  const ReportSubject& subject = r.subject;
  const petzval::ParaxialField field = largest_field(subject, lens);
  const bool coloured = subject.light.wavelengths_nm.size() > 1;
  try {
    const auto rays = petzval::paraxial_rays(lens, field);
    json["paraxial_rays"] = Json::array();
    for (std::size_t i = 0; i < rays.surfaces.size(); ++i) {
      const petzval::ParaxialRayPair& pair = rays.surfaces[i];
      json["paraxial_rays"].push_back({{"surface", r.surface_number(i)},
                                       {"marginal_y", pair.marginal_y},
                                       {"marginal_u", pair.marginal_u},
                                       {"chief_y", pair.chief_y},
                                       {"chief_u", pair.chief_u}});
    }
    json["optical_invariant_mm"] = rays.invariant;
    const auto found = report_seidel(r, lens);
    if (!found) return json;
    const petzval::SeidelSums& sums = *found;
    const auto terms = [&](Json row, const petzval::SeidelTerms& t) {
      const auto colour = [&](double value) { return coloured ? Json(value) : Json(nullptr); };
      row.update({{"S1", t.s1}, {"S2", t.s2}, {"S3", t.s3}, {"S4", t.s4}, {"S5", t.s5}});
      row.update({{"C1", colour(t.c1)}, {"C2", colour(t.c2)}});
      return row;
    };
    json["seidel"] = Json::array();
    for (std::size_t i = 0; i < sums.surfaces.size(); ++i) {
      json["seidel"].push_back(terms({{"surface", r.surface_number(i)}}, sums.surfaces[i]));
    }
    json["seidel_sums"] = terms(Json::object(), sums.sums);
  } catch (const petzval::Error&) {
    // The remaining values stay null.
  }
  return json;
}

/// 32768; fewer for lenses of more than 512 surfaces, so that their reports take seconds. The sampling errors grow
/// accordingly.
std::uint32_t rays_per_spot(const petzval::Lens& lens) {
  constexpr std::size_t most_hits = 1 << 24;  // rays times surfaces
  std::uint32_t rays = 32768;
  while (rays > 256 && rays * lens.surface_count() > most_hits) rays /= 2;
  return rays;
}

}  // namespace

double subject_z(const ReportSubject& subject, const petzval::Lens& lens) {
  return petzval::origin_z(lens, subject.focus.distance_origin()) - subject.distance_mm;
}

std::optional<petzval::SeidelSums> report_seidel(const Report& r, const petzval::Lens& colours) {
  const auto& nm = r.subject.light.wavelengths_nm;
  const auto [shortest, longest] = std::minmax_element(nm.begin(), nm.end());
  try {
    return petzval::seidel_sums(colours, largest_field(r.subject, colours), {},
                                colours.wavelength_index(petzval::Wavelength::nm(*shortest)),
                                colours.wavelength_index(petzval::Wavelength::nm(*longest)));
  } catch (const petzval::Error&) {
    return {};
  }
}

petzval::ParaxialField largest_field(const ReportSubject& subject, const petzval::Lens& lens) {
  petzval::ParaxialField field{.object_distance = lens.surfaces().front().vertex_z - subject_z(subject, lens)};
  for (const double degrees : subject.fields.degrees) {
    field.field_rad = std::max(field.field_rad, std::abs(petzval::radians(degrees)));
  }
  return field;
}

std::vector<std::optional<petzval::Wavefront>> report_wavefronts(const Report& r, const petzval::Lens& colours) {
  const std::size_t count = colours.wavelengths_nm().size();
  std::vector<std::optional<petzval::Wavefront>> result(r.subject.fields.degrees.size() * count);
  const double z = subject_z(r.subject, colours);
  petzval::parallel_for(result.size(), 1, examples::threads(), [&](std::size_t k, std::size_t) {
    const petzval::FieldPoint point{.field_rad = petzval::radians(r.subject.fields.degrees[k / count]), .z = z};
    const std::size_t directions = rays_per_spot(colours) < 32768 ? 12 : 48;
    result[k] = petzval::wavefront(colours, point, {.wavelength = k % count, .directions = directions});
  });
  return result;
}

std::vector<petzval::Spot> report_spots(const Report& r, const petzval::Lens& colours) {
  std::vector<double> fields;
  for (const double degrees : r.subject.fields.degrees) fields.push_back(petzval::radians(degrees));
  return petzval::spot_diagram(colours, subject_z(r.subject, colours), fields, rays_per_spot(colours),
                               examples::threads());
}

std::vector<petzval::MtfPoint> report_mtf(const Report& r, std::span<const petzval::Spot> spots) {
  std::vector<double> frequencies;
  for (int k = 0; k <= 20; ++k) frequencies.push_back(5 * k);
  return petzval::geometric_mtf(spots, r.subject.light.wavelengths_nm.size(), frequencies, r.subject.light.weights,
                                examples::threads());
}

std::vector<petzval::MtfPoint> report_mtf_over_field(const Report& r, const petzval::Lens& colours) {
  constexpr int steps = 10;
  const std::uint32_t rays = rays_per_spot(colours) / 8;
  constexpr std::array frequencies{10.0, 20.0, 40.0};
  const double largest = largest_field(r.subject, colours).field_rad;
  if (largest == 0) return {};
  std::vector<double> fields;
  for (int k = 0; k <= steps; ++k) fields.push_back(largest * k / steps);
  return petzval::mtf_over_field(colours, subject_z(r.subject, colours), fields, frequencies, r.subject.light.weights,
                                 rays, examples::threads());
}

std::vector<double> report_film_shifts(const Report& r, const petzval::Lens& colours,
                                       std::span<const petzval::Spot> spots) {
  const auto step = petzval::through_focus_step(colours, spots, r.subject.light.weights);
  if (!step) return {};
  return {-2 * *step, -*step, 0, *step, 2 * *step};
}

std::string in_words(const ReportSubject& subject) {
  std::string text = "subject ";
  text += std::isinf(subject.distance_mm) ? "at infinity"
                                          : number(subject.distance_mm) + " mm from the " + subject.focus.from();
  if (subject.distance_of_file) text += " (as in the file)";
  return text + "; film " + (subject.film_of_file ? "as in the file" : "in focus (" + subject.focus.criterion + ")");
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
  const petzval::Lens& lens = loaded.lens;
  const petzval::Meridian main = petzval::main_meridian(lens);
  std::vector<MeridianReport> meridians{in_meridian(lens, main)};
  if (!lens.rotationally_symmetric()) {
    meridians.push_back(in_meridian(lens, main == petzval::Meridian::y ? petzval::Meridian::x : petzval::Meridian::y));
  }
  if (declared_pupil) {
    auto& entries = meridians.front().entries;
    const auto petzval_sum = entries.end() - 1;
    entries.insert(
        petzval_sum,
        {{"declared_entrance_pupil_diameter_mm", "entrance pupil as declared in the file (EPD of OpticStudio)", "mm",
          declared_pupil->diameter},
         {"declared_f_number", "EFL / declared pupil (image space F/# of OpticStudio)", "", declared_pupil->f_number}});
  }
  auto findings = petzval::lint(loaded.prescription, loaded.glasses, loaded.first_surface_number);
  return {std::move(loaded), std::move(subject), declared_pupil, std::move(meridians), std::move(findings)};
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

Json to_json(const Report& r, const petzval::Lens& colours) {
  const petzval::Lens& lens = r.loaded.lens;
  const auto& pupils = r.main().pupils;
  Json json{{"name", lens.name()},
            {"dispersion", petzval::name(lens.dispersion())},
            {"wavelength_nm", lens.wavelengths_nm()[0]},
            {"surfaces_from", r.loaded.first_surface_number},
            {"stop_surface", pupils ? Json(r.surface_number(pupils->stop)) : Json(nullptr)},
            {"stop_inferred", pupils && pupils->stop_inferred}};
  json.update(numbers(r.main()));
  json["film_z_mm"] = finite_or_null(lens.film_z());
  json["design_aperture"] = nullptr;
  if (const auto& aperture = r.loaded.prescription.design.aperture) {
    const auto or_null = [](std::optional<double> value) { return value ? finite_or_null(*value) : Json(nullptr); };
    json["design_aperture"] = {{"setting", petzval::name(aperture->setting)},
                               {"value", or_null(declared_value(*aperture))},
                               {"computed", or_null(computed_aperture(lens, r.loaded.prescription.design, r.main()))}};
  }
  const ReportSubject& subject = r.subject;
  json["subject_distance_mm"] = finite_or_null(subject.distance_mm);
  json["subject_distance_of_file"] = subject.distance_of_file;
  json["distance_from"] = subject.focus.origin;
  json["film"] = subject.film_of_file ? "file" : "focus";
  json["criterion"] = subject.film_of_file ? Json() : Json(subject.focus.criterion);
  json["wavelengths_nm"] = subject.light.wavelengths_nm;
  json["wavelength_weights"] = subject.light.weights;
  json["wavelengths_of_file"] = subject.light.of_file;
  json["fields_deg"] = subject.fields.degrees;
  json["fields_of_file"] = subject.fields.of_file;
  json["meridian"] = r.main().meridian == petzval::Meridian::y ? "y" : "x";
  json["meridians"] = nullptr;
  if (r.meridians.size() > 1) {
    json["meridians"] = Json::object();
    for (const MeridianReport& meridian : r.meridians) {
      json["meridians"][meridian.meridian == petzval::Meridian::y ? "y" : "x"] = numbers(meridian);
    }
  }
  json.update(third_order(r, colours));
  json.update(exact_aberrations(r, colours));
  const auto& imported = r.loaded.prescription.imported;
  json["computed_apertures"] = computed_apertures(r);
  json["edge_thicknesses_mm"] = Json::array();
  for (const std::optional<double>& edge : petzval::edge_thicknesses(lens)) {
    json["edge_thicknesses_mm"].push_back(edge ? Json(*edge) : Json(nullptr));
  }
  json["format"] = imported ? imported->format : "petzval";
  json["warnings"] = Json::array();
  if (imported) {
    for (const petzval::ImportWarning& w : imported->warnings) {
      json["warnings"].push_back({{"line", w.line}, {"command", w.command}, {"message", w.message}});
    }
  }
  json["missing_glasses"] = lens.missing_glasses();
  json["lint"] = Json::array();
  for (const petzval::Finding& finding : r.findings) {
    json["lint"].push_back(
        {{"kind", petzval::name(finding.kind)},
         {"surface", finding.surface ? Json(*finding.surface + r.loaded.first_surface_number) : Json(nullptr)},
         {"found", finite_or_null(finding.found)},
         {"wanted", finite_or_null(finding.expected)},
         {"message", finding.message}});
  }
  return json;
}

const char* section_name(petzval::Meridian meridian) { return meridian == petzval::Meridian::y ? "y-z" : "x-z"; }

std::string stop_in_words(const Report& r) {
  const std::optional<petzval::Pupils>& pupils = r.main().pupils;
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
  const auto line = [&](const char* label, double value, const char* unit) {
    text << "  " << std::left << std::setw(58) << label << std::right << std::setw(14) << in_words(value)
         << (*unit ? " " : "") << unit << '\n';
  };
  for (const MeridianReport& meridian : r.meridians) {
    text << '\n';
    if (r.meridians.size() > 1) text << "in the section " << section_name(meridian.meridian) << ":\n";
    for (const Entry& entry : meridian.entries) line(entry.label, entry.value, entry.unit);
    if (&meridian == &r.main()) line("film, z", lens.film_z(), "mm");
    if (const auto& aperture = r.loaded.prescription.design.aperture; aperture && &meridian == &r.main()) {
      using enum petzval::ApertureSetting;
      const bool length = aperture->setting == entrance_pupil_diameter || aperture->setting == stop_size;
      const std::string label = "aperture of the file, " + std::string(petzval::name(aperture->setting));
      if (const auto value = declared_value(*aperture)) line(label.c_str(), *value, length ? "mm" : "");
      if (const auto value = computed_aperture(lens, r.loaded.prescription.design, meridian)) {
        line(declared_value(*aperture) ? "computed for this lens" : label.c_str(), *value, length ? "mm" : "");
      }
    }
    if (meridian.first_order.afocal) {
      text << (r.meridians.size() > 1 ? "\nIn this section the lens" : "\nThe lens")
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
