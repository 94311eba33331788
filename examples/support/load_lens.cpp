// SPDX-License-Identifier: Apache-2.0
#include "load_lens.hpp"

#include <cmath>
#include <iostream>
#include <utility>

#include "petzval/core/units.hpp"
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

void say_what_limits(const LoadedLens& loaded) {
  if (!petzval::has_pupils(loaded.lens)) return;
  const petzval::Pupils pupils = petzval::pupils(loaded.lens);
  if (!pupils.stop_inferred) return;
  std::cerr << "note: " << loaded.id << (loaded.lens.stop() ? ": the stop has no rim" : ": no stop is marked")
            << "; surface " << pupils.stop << ", which limits the axial beam, serves as one\n";
}

}  // namespace

LoadedLens load_lens(const std::filesystem::path& file, std::span<const double> wavelengths_nm) {
  petzval::Prescription prescription = petzval::read_prescription(file);
  auto glasses = petzval::GlassCatalogue::load(petzval::data_directory() / "glass");
  petzval::Lens lens = petzval::compile(prescription, wavelengths_nm, with_stand_ins(glasses));
  LoadedLens loaded{file.stem().string(), std::move(prescription), std::move(glasses), std::move(lens)};
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
