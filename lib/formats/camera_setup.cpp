// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/json.hpp"

#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "petzval/core/error.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval {

GlassCatalogue glasses_of(const LensSource& source, std::vector<GlassFile>* files) {
  if (!source.glasses.empty()) return GlassCatalogue(source.glasses);
  GlassCatalogue result = glass_tables();
  for (const std::string& name : source.glass_files) {
    GlassFile file = read_glasses(name);
    result = with_glasses(result, file.glasses);
    if (files) files->push_back(std::move(file));
  }
  return result;
}

Prescription read_lens(const LensSource& source, const GlassCatalogue* glasses) {
  if (source.prescription) return *source.prescription;
  const std::string entry = source.configuration.substr(0, source.configuration.find('/'));
  return read_lens(find_lens(source.file).value_or(source.file), {.glasses = glasses, .entry = entry});
}

std::optional<ConfigurationChoice> configuration_of(const LensSource& source, const Prescription& lens) {
  std::string position = source.configuration;
  if (!source.prescription && lens.imported && !lens.imported->entry.empty()) {
    const std::size_t slash = position.find('/');
    position = slash == std::string::npos ? "" : position.substr(slash + 1);
  }
  if (position.empty()) return {};
  double number = 0;
  const char* const end = position.data() + position.size();
  const auto read = std::from_chars(position.data(), end, number);
  return read.ec == std::errc() && read.ptr == end ? ConfigurationChoice(number) : ConfigurationChoice(position);
}

Lens compile(const CameraSetup& setup, const GlassCatalogue* glasses) {
  const LensSource& source = setup.lens;
  std::optional<GlassCatalogue> own;
  if (!glasses && !(source.glasses.empty() && source.glass_files.empty())) glasses = &own.emplace(glasses_of(source));
  const bool thin = source.thin_mm > 0;
  if (!thin && !source.prescription && !find_lens(source.file)) {
    throw Error("lens: file = \"" + source.file + "\"; must be an existing file or the name of a shipped lens");
  }
  Prescription lens = thin ? thin_elements(source.thin_mm, setup.f_number.value_or(0)) : read_lens(source, glasses);
  lens = configured(lens, configuration_of(source, lens).value_or(ConfigurationChoice()));
  if (source.match_glasses) lens = match_glasses(lens, glasses ? *glasses : glass_tables()).prescription;
  std::vector<double> nm = source.wavelengths_nm;
  if (nm.empty()) nm = {lens.reference_wavelength_nm};
  return compile(lens, nm,
                 {.glasses = glasses,
                  .missing_glass = source.require_glasses ? MissingGlass::error : MissingGlass::abbe,
                  .clamp_wavelengths = source.clamp_wavelengths,
                  .primary_nm = source.primary_nm});
}

Camera camera(const CameraSetup& setup) { return camera(setup, prepared(setup, compile(setup))); }

}  // namespace petzval
