// SPDX-License-Identifier: Apache-2.0
#include "load_lens.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <utility>

#include "petzval/core/units.hpp"
#include "petzval/files/glass_files.hpp"
#include "petzval/files/lens_file.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "text.hpp"

namespace examples {
namespace {

petzval::CompileOptions with_stand_ins(const petzval::GlassCatalogue& glasses) {
  return {.glasses = &glasses, .missing_glass = petzval::MissingGlass::abbe};
}

void say_what_is_known(const LoadedLens& loaded) {
  if (loaded.lens.dispersion() == petzval::Dispersion::catalogue) return;
  const std::size_t missing = loaded.lens.missing_glasses().size();
  const std::string line = number(loaded.prescription.reference_wavelength_nm) + " nm";
  std::cerr << "note: " << loaded.id << ": ";
  if (missing == 0) {
    std::cerr << "no medium disperses\n";
    return;
  }
  std::cerr << missing << (missing == 1 ? " medium is" : " media are") << " in no glass table; "
            << (loaded.lens.dispersion() == petzval::Dispersion::abbe
                    ? "the n_d/V_d model is used away from " + line
                    : "without V_d the lens can be used at " + line + " only")
            << '\n';
}

void say_what_was_assumed(const LoadedLens& loaded) {
  const auto& imported = loaded.prescription.imported;
  if (!imported) return;
  for (const petzval::ImportWarning& warning : imported->warnings) {
    std::cerr << "note: " << imported->file << ": ";
    if (warning.line > 0) std::cerr << "line " << warning.line << ": ";
    std::cerr << warning.command << ' ' << warning.message << '\n';
  }
}

void say_what_limits(const LoadedLens& loaded) {
  if (!petzval::has_pupils(loaded.lens)) return;
  const petzval::Pupils pupils = petzval::pupils(loaded.lens);
  if (!pupils.stop_inferred) return;
  std::cerr << "note: " << loaded.id << (loaded.lens.stop() ? ": the stop has no rim" : ": no stop is marked")
            << "; surface " << pupils.stop << ", which limits the axial beam, serves as one\n";
}

}  // namespace

Option* add_lens(App& app, LensInput& input, const std::string& name, const std::string& remark) {
  Option* lens = app.add_option(name, input.file,
                                "a lens: JSON as in data/lenses, .zmx, .seq, .len, OpticalBench or renderers' tables" +
                                    (remark.empty() ? "" : "; " + remark));
  if (name == "LENS" && remark.empty()) lens->required();
  lens->type_name("FILE");
  app.add_option("--glasses", input.glass_files,
                 "glass catalogues to look into first (.agf, refractiveindex.info .yml)")
      ->type_name("FILE...")
      ->needs(lens);
  app.add_option("--configuration", input.configuration, "position of a zoom lens, by name or by number from 0")
      ->default_str("the first")
      ->needs(lens);
  return lens;
}

petzval::GlassCatalogue glasses_of(const LensInput& input) {
  petzval::GlassCatalogue glasses = petzval::glass_tables();
  for (const std::string& file : input.glass_files) {
    petzval::GlassFile more = petzval::read_glasses(file);
    for (const petzval::ImportWarning& warning : more.warnings) {
      std::cerr << "note: " << file << ": line " << warning.line << ": " << warning.command << ' ' << warning.message
                << '\n';
    }
    glasses = petzval::with_glasses(glasses, std::move(more.glasses));
  }
  return glasses;
}

petzval::ConfigurationChoice configuration_of(const LensInput& input) {
  const std::string& text = input.configuration;
  if (text.empty()) return {};
  double number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status == std::errc() && end == text.data() + text.size()) return number;
  return text;
}

LoadedLens load_lens(const LensInput& input, std::span<const double> wavelengths_nm) {
  auto glasses = glasses_of(input);
  const petzval::Prescription whole = petzval::read_prescription(input.file, {.glasses = &glasses});
  petzval::Prescription prescription = petzval::configured(whole, configuration_of(input));
  petzval::Lens lens = petzval::compile(prescription, wavelengths_nm, with_stand_ins(glasses));
  std::string id = std::filesystem::path(input.file).stem().string();
  if (!input.configuration.empty()) id += '_' + input.configuration;
  LoadedLens loaded{std::move(id), std::move(prescription), std::move(glasses), std::move(lens)};
  say_what_was_assumed(loaded);
  say_what_is_known(loaded);
  say_what_limits(loaded);
  return loaded;
}

double half_field_deg(const LoadedLens& loaded) {
  const petzval::Prescription& p = loaded.prescription;
  if (p.half_field_deg) return *p.half_field_deg;
  const petzval::Meridian meridian = petzval::main_meridian(loaded.lens);
  const double focal_length = std::abs(petzval::first_order(loaded.lens, {}, meridian).effective_focal_length);
  if (p.image_diagonal_mm && std::isfinite(focal_length)) {
    return std::round(100 * petzval::degrees(std::atan(*p.image_diagonal_mm / 2 / focal_length))) / 100;
  }
  return 10;
}

petzval::Lens compiled_for(const LoadedLens& loaded, std::span<const double> wavelengths_nm) {
  return petzval::compile(loaded.prescription, wavelengths_nm, with_stand_ins(loaded.glasses));
}

}  // namespace examples
