// SPDX-License-Identifier: Apache-2.0
#include "load_lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/apertures.hpp"
#include "suggest.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// Prints a note if the wavelengths need a dispersion that is known only in part.
void say_what_is_known(const LensFile& file, const petzval::Lens& lens) {
  const double reference = file.prescription.reference_wavelength_nm;
  const auto at_reference = [&](double nm) { return std::abs(nm - reference) <= 0.05; };  // as in MissingGlass::abbe
  if (lens.dispersion() == petzval::Dispersion::catalogue || std::ranges::all_of(lens.wavelengths_nm(), at_reference)) {
    return;
  }
  const std::string line = number(reference) + " nm";
  const std::size_t missing = lens.missing_glasses().size();
  if (missing == 0) return note(file.id + ": no medium has dispersion");
  note(file.id + ": " + std::to_string(missing) + (missing == 1 ? " medium has" : " media have") +
       " no glass in the tables; " +
       (lens.dispersion() == petzval::Dispersion::abbe ? "the n_d/V_d model is used away from " + line
                                                       : "without V_d the lens can be used at " + line + " only"));
}

void say_what_was_assumed(const LensFile& file) {
  const auto& imported = file.prescription.imported;
  if (!imported) return;
  for (const petzval::ImportWarning& warning : imported->warnings) {
    note(imported->file + ": " + (warning.line > 0 ? "line " + std::to_string(warning.line) + ": " : "") +
         warning.command + ' ' + warning.message);
  }
}

void say_what_limits(const LensFile& file, const petzval::Lens& lens) {
  if (!petzval::has_pupils(lens)) return;
  const petzval::Pupils pupils = petzval::pupils(lens);
  if (!pupils.stop_inferred) return;
  note(file.id + (lens.stop() ? ": the stop has no rim" : ": no stop is marked") + "; surface " +
       std::to_string(static_cast<int>(pupils.stop) + file.first_surface_number) +
       ", which limits the axial beam, serves as the stop");
}

/// The file of a lens: the path itself, or the file of a shipped lens with this name.
std::filesystem::path lens_path(const std::string& text) {
  if (const auto file = petzval::find_lens(text)) return *file;
  if (text.empty() || text.find('/') != text.npos || text.ends_with(".json")) return text;
  std::vector<std::string> names;
  for (const auto& file : entries(petzval::data_directory() / "lenses")) names.push_back(file.stem().string());
  const std::string near = nearest(text, names);
  throw petzval::Error("LENS = " + text + ": no file and no shipped lens has this name" +
                       (near.empty() ? "; petzval lenses lists them" : "; did you mean " + near + "?"));
}

constexpr const char* lens_help =
    "a shipped lens (petzval lenses) or a file: JSON as in data/lenses, .zmx, .seq, .len, .lens, OpticalBench or other "
    "tables, a page of a patent";

Option* add_lens_options(App& app, petzval::LensSource& input, Option* lens) {
  lens->type_name("FILE");
  app.add_option("--glasses", input.glass_files, "glass catalogues to search first (.agf, refractiveindex.info .yml)")
      ->type_name("FILE...")
      ->needs(lens);
  app.add_option("--configuration", input.configuration,
                 "position of a zoom lens, by name or by number from 0; or a lens of a database, by its key or name "
                 "(2004, or 2004/long)")
      ->default_str("the first")
      ->needs(lens);
  app.add_option("--embodiment", input.configuration,
                 "lens of a page with several tables, by its number (2, or 2/wide)")
      ->default_str("")
      ->needs(lens)
      ->excludes("--configuration");
  app.add_flag("--match-glasses", input.match_glasses,
               "replace media known only by n_d and V_d by the nearest glass; within 0.001 and 0.5, with a note")
      ->needs(lens);
  return lens;
}

}  // namespace

Option* add_lens(App& app, petzval::LensSource& input, const std::string& name, const std::string& remark) {
  Option* lens = app.add_option(name, input.file, lens_help + (remark.empty() ? "" : "; " + remark));
  if (name == "LENS" && remark.empty()) lens->required();
  return add_lens_options(app, input, lens);
}

Option* add_lenses(App& app, petzval::LensSource& input, std::vector<std::string>& lenses) {
  return add_lens_options(app, input, app.add_option("LENS", lenses, lens_help)->required());
}

Option* add_thin_lens(App& app, double& focal_length_mm) {
  return add_length(app, "--thin-lens", focal_length_mm, positive_number,
                    "focal length of a thin lens (mm) instead of LENS; needs --f-number")
      ->default_str("");
}

petzval::GlassCatalogue glasses_of(const petzval::LensSource& input) {
  std::vector<petzval::GlassFile> files;
  petzval::GlassCatalogue glasses = petzval::glasses_of(input, &files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (const petzval::ImportWarning& warning : files[i].warnings) {
      note(input.glass_files[i] + ": line " + std::to_string(warning.line) + ": " + warning.command + ' ' +
           warning.message);
    }
  }
  return glasses;
}

petzval::Prescription read_whole(const petzval::LensSource& input, const petzval::GlassCatalogue& glasses) {
  if (!input.prescription) lens_path(input.file);
  return petzval::read_lens(input, &glasses);
}

petzval::Prescription with_matched_glasses(const petzval::LensSource& input, petzval::Prescription lens,
                                           const petzval::GlassCatalogue& glasses) {
  if (!input.match_glasses) return lens;
  petzval::MatchedGlasses result = petzval::match_glasses(lens, glasses);
  const auto say = [&](const std::vector<petzval::ImportWarning>& media, const char* verdict) {
    for (const petzval::ImportWarning& medium : media) {
      note(input.file + ": " + medium.command + ": " + verdict + medium.message);
    }
  };
  say(result.matched, "matched: ");
  say(result.unmatched, "not matched: ");
  return std::move(result.prescription);
}

LensFile read_lens(const petzval::LensSource& input) {
  auto glasses = examples::glasses_of(input);
  petzval::Prescription whole = read_whole(input, glasses);
  petzval::Prescription prescription = with_matched_glasses(
      input,
      for_flag("--configuration",
               [&] {
                 return petzval::configured(
                     whole, petzval::configuration_of(input, whole).value_or(petzval::ConfigurationChoice()));
               }),
      glasses);
  std::string id = input.prescription ? whole.id : lens_path(input.file).stem().string();
  if (!input.configuration.empty()) id += '_' + input.configuration;
  std::ranges::replace(id, '/', '_');
  constexpr std::array<std::string_view, 6> formats_from_1{"zemax",        "codev",       "oslo",
                                                           "opticalbench", "patent page", "table"};
  const bool from_1 =
      prescription.imported && std::ranges::find(formats_from_1, prescription.imported->format) != formats_from_1.end();
  return {std::move(id), std::move(prescription), std::move(glasses), from_1, std::move(whole), input};
}

LoadedLens compiled(LensFile file, std::span<const double> wavelengths_nm, std::optional<double> primary_nm) {
  petzval::Lens lens = compiled_for(file, wavelengths_nm, primary_nm);
  say_what_was_assumed(file);
  say_what_limits(file, lens);
  return {std::move(file), std::move(lens)};
}

std::optional<double> primary_among(std::span<const double> wavelengths_nm, std::optional<double> primary_nm) {
  const bool used = primary_nm && std::ranges::find(wavelengths_nm, *primary_nm) != wavelengths_nm.end();
  return used ? primary_nm : std::nullopt;
}

LoadedLens load_lens(const petzval::LensSource& input, std::span<const double> wavelengths_nm) {
  return compiled(examples::read_lens(input), wavelengths_nm, input.primary_nm);
}

LoadedLens load_lens(const petzval::CameraSetup& setup, std::span<const double> wavelengths_nm) {
  const std::optional<double> primary_nm = primary_among(wavelengths_nm, setup.lens.primary_nm);
  if (!(setup.lens.thin_mm > 0)) return compiled(examples::read_lens(setup.lens), wavelengths_nm, primary_nm);
  LensFile file{"thin_lens", petzval::thin_elements(setup.lens.thin_mm, *setup.f_number),
                examples::glasses_of(setup.lens)};
  petzval::Lens lens = compiled_for(file, wavelengths_nm, primary_nm);
  return {std::move(file), std::move(lens)};
}

double half_field_deg(const LensFile& file, const petzval::Lens& lens) {
  if (file.prescription.half_field_deg) return *file.prescription.half_field_deg;
  const auto declared = petzval::declared_half_field(file.prescription, lens);
  return declared ? std::round(100 * petzval::degrees(*declared)) / 100 : 10;
}

petzval::CompileOptions compile_options(const LensFile& file, std::optional<double> primary_nm) {
  return {.glasses = &file.glasses,
          .missing_glass = file.source.require_glasses ? petzval::MissingGlass::error : petzval::MissingGlass::abbe,
          .clamp_wavelengths = file.source.clamp_wavelengths,
          .primary_nm = primary_nm};
}

petzval::Lens compiled_for(const LensFile& file, std::span<const double> wavelengths_nm,
                           std::optional<double> primary_nm) {
  petzval::Lens lens = petzval::compile(file.prescription, wavelengths_nm, compile_options(file, primary_nm));
  say_what_is_known(file, lens);
  return lens;
}

}  // namespace examples
