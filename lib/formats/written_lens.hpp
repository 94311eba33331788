// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "declared_beam.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::formats_detail {

/// A lens on its way into the format of another program: its text, and what is lost.
class Writer {
 public:
  /// The first configuration, with a marked stop where a surface limits its beam. Throws Error for an invalid lens.
  Writer(const Prescription& lens, const GlassCatalogue* glasses);

  const Prescription& lens() const noexcept { return lens_; }
  /// The prescription's name, for messages.
  const std::string& where() const noexcept { return where_; }
  /// Throws Error: "lens: surface 3: cylinder, wanted wanted".
  [[noreturn]] void refuse(std::size_t surface, const std::string& found, const std::string& wanted) const;
  void line(const std::string& text) { text_ += text + '\n'; }
  void lose(std::string_view what, const std::string& message) { losses_.push_back({0, std::string(what), message}); }
  /// Loses the lens's nominal data and sources, but for those that are kept and, in a format with design data, those
  /// that its aperture and its fields declare.
  void lose_nominal_data(bool design_data, std::initializer_list<std::string_view> kept);
  /// Loses a rim of the stop that is wider than the declared beam: programs launch the beam that the design declares.
  void lose_the_wider_stop();
  /// Throws Error for a rim with a semi-diameter of 0, in any configuration: such formats have no closed rim.
  void refuse_closed_rims(const std::string& format) const;
  /// Restates the indices at the d line, for formats with glasses. A medium with the index of its glass keeps no stated
  /// index. The reference wavelength becomes the wavelength of the design. Throws Error if the index of a glass is
  /// stated and the glass does not reach the d line.
  void state_indices_at_d();
  Lens at_primary_wavelength(const Prescription& rows) const {
    return formats_detail::at_primary_wavelength(rows, glasses_);
  }
  const GlassCatalogue& glasses();
  /// The glass of the tables that a medium names; null if there is none.
  const Glass* glass(const Medium& medium);
  /// Rows compiled for their reference wavelength.
  Lens compiled(const Prescription& rows) const { return compile(rows, {.glasses = glasses_}); }
  /// The index at the reference wavelength, as stated or of the glass. Throws Error if it is unknown.
  double index(const Medium& medium);
  WrittenLens take() { return {std::move(text_), std::move(losses_)}; }

 private:
  void mark_the_stop();

  Prescription lens_;
  std::string where_;
  const GlassCatalogue* glasses_;
  std::string text_;
  std::vector<ImportWarning> losses_;
};

}  // namespace petzval::formats_detail
