// SPDX-License-Identifier: Apache-2.0
// Converts a lens between file formats; OUT's extension chooses the format. Reports assumptions and losses.
//
//   petzval convert lens.zmx lens.json
//   petzval convert zoom.txt tele.zmx --configuration tele --glasses hoya.agf --json
//   petzval convert table.dat lens.json --repair --match-glasses
//   petzval convert lenses.json lens.json --configuration 2004
//   petzval convert double_gauss_100mm_f2.0 camera.osl --wavelengths visible
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/exports/lens_metadata.hpp"
#include "petzval/exports/renderer_cameras.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/io/json.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;
using petzval::ImportWarning;
using petzval::Prescription;

struct Options {
  petzval::LensSource in;
  std::string out;
  std::vector<double> wavelengths_nm;  ///< for an OSL camera; empty: the reference wavelength
  bool strict = false, repair = false, json = false;
};

constexpr int refused_by_strict = 3;

/// An output format: the extension of its files, and its writer.
struct Output {
  std::string_view ending;
  std::vector<ImportWarning> (*write)(const Prescription& lens, const petzval::GlassCatalogue& glasses,
                                      const Options& options);
};

/// Reports the loss of zoom positions in a format without zoom lenses.
void lose_positions(const Prescription& lens, std::vector<ImportWarning>& losses) {
  if (lens.configurations.size() > 1) losses.push_back({0, "configurations", "only the first is kept"});
}

std::vector<ImportWarning> write_text(const petzval::ExportedLens& written, const std::filesystem::path& file) {
  examples::write_text(file, written.text);
  return written.losses;
}

/// Writes a file that describes the effect of a lens but not its construction.
std::vector<ImportWarning> write_effect(const Prescription& lens, const petzval::GlassCatalogue& glasses,
                                        const Options& options) {
  const petzval::Lens compiled = petzval::compile(lens, {.glasses = &glasses});
  const petzval::Film film = petzval::default_film(compiled, lens.image_diagonal_mm);
  if (options.out.ends_with(".exr")) {
    petzval::write_st_map(compiled, film, petzval::identity_of(lens), options.out, {}, examples::threads());
  } else {
    petzval::write_open_track_io(compiled, film, petzval::identity_of(lens), options.out);
  }
  std::vector<ImportWarning> losses{{0, "surfaces",
                                     "are lost; the file has only the effect of the lens on a picture of " +
                                         examples::number(film.width_mm, 4) + " x " +
                                         examples::number(film.height_mm, 4) + " mm"}};
  lose_positions(lens, losses);
  return losses;
}

// Longer extensions first: .opentrackio.json also ends in .json.
constexpr std::array outputs{
    Output{".opentrackio.json", write_effect},
    Output{".stmap.exr", write_effect},
    Output{".json",
           [](const Prescription& lens, const petzval::GlassCatalogue&, const Options& options) {
             petzval::write_prescription(lens, options.out);
             return std::vector<ImportWarning>();
           }},
    Output{".dat",
           [](const Prescription& lens, const petzval::GlassCatalogue& glasses, const Options& options) {
             return write_text(petzval::format_table(lens, &glasses), options.out);
           }},
    Output{".osl",
           [](const Prescription& lens, const petzval::GlassCatalogue& glasses, const Options& options) {
             const examples::LensFile file{.id = lens.id, .prescription = lens, .glasses = glasses};
             const bool colours =
                 petzval::compile(lens, examples::compile_options(file)).dispersion() != petzval::Dispersion::none;
             std::vector<double> nm = options.wavelengths_nm;
             if (nm.empty() || !colours) nm = {lens.reference_wavelength_nm};
             examples::write_text(options.out, petzval::format_osl_camera(examples::compiled_for(file, nm)));
             std::vector<ImportWarning> losses;
             if (nm.size() == 1) {
               losses = {{0, "wavelengths",
                          "the shader has only the indices at " + examples::number(nm[0]) + " nm" +
                              (colours ? "" : ", because the dispersion of a medium is unknown")}};
             }
             lose_positions(lens, losses);
             return losses;
           }},
    Output{".zmx",
           [](const Prescription& lens, const petzval::GlassCatalogue& glasses, const Options& options) {
             return write_text(petzval::format_zemax(lens, &glasses), options.out);
           }},
    Output{".seq",
           [](const Prescription& lens, const petzval::GlassCatalogue& glasses, const Options& options) {
             return write_text(petzval::format_codev(lens, &glasses), options.out);
           }},
};

const Output& output_for(const std::string& file) {
  const auto found = std::ranges::find_if(outputs, [&](const Output& o) { return file.ends_with(o.ending); });
  if (found != outputs.end()) return *found;
  std::string known;
  for (const Output& o : outputs) known += (known.empty() ? "" : ", ") + std::string(o.ending);
  throw petzval::Error(file + ": unknown extension; must be " + known);
}

Json maybe(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json declared(const Prescription& p) {
  Json json{{"focal_length_mm", maybe(p.focal_length_mm)},
            {"f_number", maybe(p.f_number)},
            {"half_field_deg", maybe(p.half_field_deg)},
            {"image_diagonal_mm", maybe(p.image_diagonal_mm)},
            {"object_distance_mm", examples::finite_or_null(p.design.object_distance_mm)}};
  json["aperture"] = nullptr;
  if (const auto& set = p.design.aperture) json["aperture"] = {{"setting", name(set->setting)}, {"value", set->value}};
  json["fields"] = p.design.fields.size();
  json["field_kind"] = name(p.design.field_kind);
  json["wavelengths_nm"] = Json::array();
  for (const auto& wavelength : p.design.wavelengths) json["wavelengths_nm"].push_back(wavelength.nm);
  json["primary_wavelength"] = p.design.primary_wavelength;
  return json;
}

Json to_json(const std::vector<ImportWarning>& warnings) {
  Json json = Json::array();
  for (const ImportWarning& w : warnings) {
    json.push_back({{"line", w.line}, {"command", w.command}, {"message", w.message}});
  }
  return json;
}

Json report(const Prescription& whole, const Prescription& lens, const petzval::GlassCatalogue& glasses,
            const std::vector<ImportWarning>& warnings, const std::vector<ImportWarning>& losses,
            const std::vector<ImportWarning>& repairs) {
  const petzval::Lens compiled = petzval::compile(lens, {.glasses = &glasses});
  const petzval::Meridian main = petzval::main_meridian(compiled);
  const auto& imported = lens.imported;
  Json json{{"format", imported ? imported->format : "petzval"},
            {"title", imported && !imported->title.empty() ? imported->title : whole.name},
            {"units", imported ? imported->units : "mm"},
            {"surfaces", lens.surfaces.size()},
            {"stop", compiled.stop() ? Json(*compiled.stop()) : Json(nullptr)},
            {"effective_focal_length_mm",
             examples::finite_or_null(petzval::first_order(compiled, {}, main).effective_focal_length)},
            {"f_number", petzval::has_pupils(compiled) ? examples::finite_or_null(petzval::real_f_number(compiled))
                                                       : Json(nullptr)},
            {"wavelength_nm", lens.reference_wavelength_nm},
            {"declared", declared(lens)},
            {"warnings", to_json(warnings)},
            {"losses", to_json(losses)},
            {"repairs", to_json(repairs)}};
  json["lint"] = Json::array();
  for (const petzval::Finding& finding : petzval::lint(lens, glasses)) {
    json["lint"].push_back({{"kind", name(finding.kind)}, {"message", finding.message}});
  }
  json["configurations"] = Json::array();
  for (const petzval::Configuration& c : whole.configurations) {
    const petzval::Lens position = petzval::compile(whole, {.glasses = &glasses, .configuration = c.name});
    json["configurations"].push_back(
        {{"name", c.name},
         {"focus_of", c.focus_of ? Json(*c.focus_of) : Json(nullptr)},
         {"subject_distance_mm", maybe(c.subject_distance_mm)},
         {"effective_focal_length_mm",
          examples::finite_or_null(petzval::first_order(position, {}, main).effective_focal_length)},
         {"declared", {{"focal_length_mm", maybe(c.focal_length_mm)}, {"f_number", maybe(c.f_number)}}}});
  }
  return json;
}

void say(const char* kind, const std::string& file, const std::vector<ImportWarning>& warnings) {
  for (const ImportWarning& w : warnings) {
    std::cerr << kind << ": " << file << ": ";
    if (w.line > 0) std::cerr << "line " << w.line << ": ";
    std::cerr << w.command << ' ' << w.message << '\n';
  }
}

/// Converts the file. Returns false if --strict prevented the conversion.
bool convert(const Options& options) {
  const Output& output = output_for(options.out);
  if (!options.wavelengths_nm.empty() && output.ending != ".osl") {
    throw petzval::Error("--wavelengths: OUT = " + options.out + "; must end in .osl");
  }
  const auto glasses = examples::glasses_of(options.in);
  Prescription whole = examples::read_whole(options.in, glasses);
  const auto configuration = petzval::configuration_of(options.in, whole);
  const std::vector<ImportWarning> warnings = whole.imported ? whole.imported->warnings : std::vector<ImportWarning>();
  // A petzval-lens file keeps the warnings of the file it was converted from.
  const bool of_another = whole.imported && whole.imported->file != std::filesystem::path(options.in.file).filename();
  say("warning", of_another ? options.in.file + ", converted from " + whole.imported->file : options.in.file, warnings);
  if (options.strict && !warnings.empty()) {
    std::cerr << "petzval convert: " << options.in.file << ": " << warnings.size()
              << (warnings.size() == 1 ? " assumption" : " assumptions") << "; must be 0 with --strict\n";
    if (options.json) std::cout << Json{{"refused_by_strict", true}, {"warnings", to_json(warnings)}}.dump(2) << '\n';
    return false;
  }
  std::vector<ImportWarning> repairs;
  if (options.repair) {
    repairs = petzval::repair(whole, &glasses);
    say("repaired", options.in.file, repairs);
  }
  whole = examples::with_matched_glasses(options.in, std::move(whole), glasses);
  Prescription lens = examples::for_flag("--configuration", [&] {
    return petzval::configured(whole, configuration.value_or(petzval::ConfigurationChoice()));
  });
  // With --configuration only the chosen position is written, otherwise all positions.
  const auto losses = output.write(configuration ? lens : whole, glasses, options);
  say("lost", options.out, losses);
  if (options.json) std::cout << report(whole, lens, glasses, warnings, losses, repairs).dump(2) << '\n';
  return true;
}

}  // namespace

int commands::convert(int argc, char** argv) {
  Options options;
  bool refused = false;
  examples::App app(
      "Converts a lens of any format (petzval JSON, Zemax .zmx, CODE V .seq, OSLO .len, FlareSim .lens, LensHH "
      ".lhlt, crayg .fx, OpticalBench and other tables, lentil, optiland and DeepLens JSON; detected by content) to "
      "the format of OUT's extension. Warnings name the lines of IN that were not taken literally. The exit status is "
      "0 if OUT was written, 3 if --strict prevented the conversion.",
      "petzval convert");
  examples::add_lens(app, options.in, "IN", "lens to convert")->required();
  examples::add_out_file(app, options.out, "file to write: .json .dat .zmx .seq .osl .opentrackio.json .stmap.exr",
                         "FILE", "OUT")
      ->required();
  app.add_flag("--strict", options.strict, "write nothing if an entry of IN had to be assumed or left out");
  app.add_flag("--repair", options.repair, "repair faults with an unambiguous correction, and list the changes");
  examples::add_wavelengths(app, "--wavelengths", options.wavelengths_nm,
                            "wavelengths of an .osl camera, one for each sample")
      ->default_str("the reference wavelength");
  app.add_flag("--json", options.json, "print a report of IN as one JSON object");
  examples::add_threads(app);
  const int status = examples::run(app, argc, argv, [&] { refused = !convert(options); });
  return status == 0 && refused ? refused_by_strict : status;
}
