// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "declared_beam.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval::formats_detail {

/// Collects the text of a lens in the format of another program, and the data that are lost.
class Writer {
 public:
  /// Starts with the first configuration; a stop is marked if a surface limits the beam.
  /// @throws Error if the lens is invalid
  Writer(const Prescription& lens, const GlassCatalogue* glasses);

  const Prescription& lens() const noexcept { return lens_; }
  /// Name of the prescription, for messages.
  const std::string& where() const noexcept { return where_; }
  /// Throws Error: "lens: surface 3: found; must be wanted".
  [[noreturn]] void refuse(std::size_t surface, const std::string& found, const std::string& rule) const;
  void line(const std::string& text) { text_ += text + '\n'; }
  void lose(std::string_view what, const std::string& message) { losses_.push_back({0, std::string(what), message}); }
  /// Records the loss of nominal data and sources, except the `kept` data and, in a format with design data, the data
  /// that the format stores as its aperture and its fields.
  void lose_nominal_data(bool design_data, std::initializer_list<std::string_view> kept);
  /// Records the loss of a stop rim that is wider than the declared beam: other programs use only the declared beam.
  void lose_the_wider_stop();
  /// Throws Error if a semi-diameter is 0 in any configuration, because such formats cannot store a closed rim.
  void refuse_closed_rims(const std::string& format) const;
  /// Converts indices to the d line, for formats with glasses. If the index of a medium equals the index of its glass,
  /// no index is stated. The reference wavelength becomes the wavelength of the design.
  /// @throws Error if the index of a glass is stated and the glass does not reach the d line
  void state_indices_at_d();
  Lens at_primary_wavelength(const Prescription& rows) const {
    return formats_detail::at_primary_wavelength(rows, glasses_);
  }
  const GlassCatalogue& glasses();
  /// The glass of a medium in the tables; null if absent.
  const Glass* glass(const Medium& medium);
  /// Compiles rows for their reference wavelength.
  Lens compiled(const Prescription& rows) const { return compile(rows, {.glasses = glasses_}); }
  /// The index at the reference wavelength, as stated or from the glass.
  /// @throws Error if the index is unknown
  double index(const Medium& medium);
  ExportedLens take() { return {std::move(text_), std::move(losses_)}; }

 private:
  void mark_the_stop();
  void lose_the_coatings();

  Prescription lens_;
  std::string where_;
  const GlassCatalogue* glasses_;
  std::string text_;
  std::vector<ImportWarning> losses_;
};

}  // namespace petzval::formats_detail
