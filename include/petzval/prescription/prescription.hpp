// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/prescription/coating.hpp"

namespace petzval {

/// The medium behind a surface: air, a glass of a catalogue, or an index and an Abbe number.
///
/// A stated index applies at the reference wavelength of the prescription, and the glass supplies the dispersion.
/// Without a stated index the formula of the glass supplies both.
///
///     petzval::Medium{}                                    // air
///     petzval::Medium{.glass = "N-BK7"}                    // index and dispersion of the glass tables
///     petzval::Medium{.glass = "N-BK7", .nd = 1.5168}      // a printed index, the dispersion of the glass
///     petzval::Medium{.nd = 1.62, .vd = 60.3}              // an unknown glass
struct Medium {
  std::optional<std::string> glass{};         ///< "N-BK7"
  std::optional<std::string> catalogue{};     ///< catalogue of the glass; nullopt: any
  std::optional<std::string> glass_origin{};  ///< "matched": found by nd and vd, not printed in the source
  std::optional<double> nd{};                 ///< nullopt: index of the glass, or air without a glass
  std::optional<double> vd{};                 ///< 0: the index is nd at all wavelengths, unless the glass is known

  /// True if no glass is named and the index is 1 or absent.
  bool is_air() const noexcept { return !glass && nd.value_or(1) == 1; }
  /// True if all members are equal, or if both media are air.
  bool operator==(const Medium& other) const {
    if (is_air() || other.is_air()) return is_air() && other.is_air();
    return std::tie(glass, catalogue, glass_origin, nd, vd) ==
           std::tie(other.glass, other.catalogue, other.glass_origin, other.nd, other.vd);
  }
};

/// An aspheric term: adds coefficient * r^order to the sag.
struct AsphereTerm {
  int order = 4;           ///< 2 to 40, even or odd
  double coefficient = 0;  ///< mm^(1 - order)

  bool operator==(const AsphereTerm&) const = default;
};

/// The sections in which a surface is curved: both, or x or y for a cylinder.
enum class Section { both, x, y };

/// One row of a lens table: a surface and the space after that surface. Lengths in mm.
struct SurfaceRow {
  double radius = 0;                      ///< vertex radius; positive if the centre lies on the +z side; 0 for a plane
  double thickness = 0;                   ///< distance to the next vertex or the film; negative if light runs backwards
  Medium medium{};                        ///< medium behind the surface; for a mirror, the medium in front
  std::optional<double> semi_diameter{};  ///< clear aperture; nullopt: compile() computes it; infinite: unlimited
  bool semi_diameter_computed = false;    ///< true if with_apertures() computed the aperture, false if stated
  std::optional<double> obscuration_semi_diameter{};  ///< central obscuration, which blocks rays
  double conic = 0;                                   ///< k in c r^2 / (1 + sqrt(1 - (1+k) c^2 r^2))
  std::vector<AsphereTerm> aspheric{};
  bool stop = false;
  bool mirror = false;
  Section curved_in = Section::both;
  std::optional<Coating> coating{};      ///< layers from the object side; nullopt: not stated by the source
  std::optional<std::string> comment{};  ///< comment of the source on the surface

  bool operator==(const SurfaceRow&) const = default;
};

/// The quantity by which a design states the width of the beam.
enum class ApertureSetting : std::uint8_t {
  entrance_pupil_diameter,  ///< mm
  f_number,                 ///< focal length divided by the diameter of the paraxial entrance pupil
  working_f_number,         ///< 1 / (2 tan u') of the paraxial marginal ray
  object_na,                ///< n sin u in object space
  image_na,                 ///< n' sin u' in image space
  stop_size,                ///< the table states the semi-diameter of the stop
};

/// The width of the beam of a design.
struct DesignAperture {
  ApertureSetting setting = ApertureSetting::entrance_pupil_diameter;
  double value = 0;

  bool operator==(const DesignAperture&) const = default;
};

/// The quantity by which a design states its fields.
enum class FieldKind : std::uint8_t {
  angle_deg,         ///< angle of the chief ray in object space, degrees
  object_height,     ///< object height, mm
  paraxial_image,    ///< paraxial image height, mm
  real_image_height  ///< image height of the exact chief ray, mm
};

/// The name of a setting ("entrance_pupil_diameter", ...) or of a kind ("angle_deg", ...).
PETZVAL_API std::string_view name(ApertureSetting setting) noexcept;
PETZVAL_API std::string_view name(FieldKind kind) noexcept;

/// One field with its vignetting factors.
///
/// The beam is the full pupil decentred by (decentre_x, decentre_y) and compressed by (compress_x, compress_y), all in
/// units of the pupil radius, in axes rotated by angle_deg.
struct DesignField {
  double x = 0, y = 0;
  double weight = 1;
  double decentre_x = 0, decentre_y = 0;
  double compress_x = 0, compress_y = 0;
  double angle_deg = 0;

  bool operator==(const DesignField&) const = default;
};

/// One wavelength of a design and its weight.
struct DesignWavelength {
  double nm = 0;
  double weight = 1;

  bool operator==(const DesignWavelength&) const = default;
};

/// The data of a design other than its surfaces.
///
/// Functions ignore these data unless their documentation says otherwise: a renderer chooses its own fields,
/// wavelengths and stop.
struct DesignData {
  std::optional<DesignAperture> aperture{};
  double object_distance_mm = std::numeric_limits<double>::infinity();  ///< distance from the first surface
  FieldKind field_kind = FieldKind::angle_deg;
  std::vector<DesignField> fields{};
  std::vector<DesignWavelength> wavelengths{};
  std::size_t primary_wavelength = 0;  ///< index into wavelengths

  bool operator==(const DesignData&) const = default;
};

/// The changes of one surface in a configuration. Absent members keep the value of the row.
struct SurfaceChange {
  int surface = 0;  ///< from 0
  std::optional<double> thickness{};
  std::optional<double> radius{};
  std::optional<double> conic{};
  std::optional<double> semi_diameter{};
  std::optional<Medium> medium{};

  bool operator==(const SurfaceChange&) const = default;
};

/// One position of a lens with moving groups: a zoom position, or the focus of a zoom position at a near subject.
struct Configuration {
  std::string name{};
  /// Name of the zoom position that this configuration focuses; nullopt for a zoom position.
  std::optional<std::string> focus_of{};
  std::optional<double> subject_distance_mm{};  ///< from the first surface, positive; nullopt: infinity
  std::optional<int> stop{};                    ///< stop surface; nullopt: the stop of the rows
  std::optional<double> focal_length_mm{};      ///< nominal, as printed in the source
  std::optional<double> f_number{};
  std::optional<double> half_field_deg{};
  std::optional<double> image_diagonal_mm{};
  std::vector<SurfaceChange> changes{};

  bool operator==(const Configuration&) const = default;
};

/// A configuration, chosen by name or by number from 0.
///
/// Fractions interpolate: 0.5 is halfway from the first to the second configuration.
class ConfigurationChoice {
 public:
  ConfigurationChoice() = default;
  ConfigurationChoice(std::string name) : choice_(std::move(name)) {}
  ConfigurationChoice(std::string_view name) : choice_(std::string(name)) {}
  ConfigurationChoice(const char* name) : choice_(std::string(name)) {}
  template <class Number>
    requires((std::integral<Number> && !std::same_as<Number, bool>) || std::floating_point<Number>)
  ConfigurationChoice(Number number) : choice_(static_cast<double>(number)) {}

  const std::variant<double, std::string>& value() const noexcept { return choice_; }

 private:
  std::variant<double, std::string> choice_ = 0.0;
};

/// An assumption, change or omission of an importer.
struct ImportWarning {
  int line = 0;           ///< line of the file, from 1; 0: the whole file
  std::string command{};  ///< the word of the file that the warning refers to
  std::string message{};  ///< a single line

  bool operator==(const ImportWarning&) const = default;
};

/// The file of another program from which a prescription was read.
struct FileOrigin {
  std::string format{};      ///< the name of the format in the list of read_lens(): "zemax", "codev", "lentil", ...
  std::string file{};        ///< file name without folders
  std::string units = "mm";  ///< unit of length in the file: "mm", "cm", "in" or "m"; a prescription is in mm
  std::string title{};
  std::vector<std::string> notes{};
  std::vector<ImportWarning> warnings{};
  std::string entry{};  ///< key of the lens in a file with several lenses; otherwise empty

  bool operator==(const FileOrigin&) const = default;
};

/// A lens as printed in its source: plain data that a program may edit. compile() turns it into a Lens.
///
///     petzval::Prescription singlet;
///     singlet.name = "singlet";
///     singlet.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12, .stop = true},
///                         {.radius = -50, .thickness = 48, .semi_diameter = 12}};
///     petzval::Lens lens = petzval::compile(singlet);
///
/// Strings keep the words of the file and are not interpreted.
struct Prescription {
  std::string id{};
  std::string name{};
  std::string source_design{};
  std::string source_numbers{};
  std::optional<double> focal_length_mm{};  ///< nominal, as printed in the source
  std::optional<double> f_number{};
  std::optional<double> half_field_deg{};
  std::optional<double> image_diagonal_mm{};
  double reference_wavelength_nm = d_line_nm;   ///< wavelength of the stated indices
  std::optional<std::string> semi_diameters{};  ///< origin of the semi-diameters
  std::optional<std::string> stop_size{};
  std::optional<std::string> image_distance{};
  std::optional<std::string> glass_names{};
  std::optional<std::string> notes{};
  std::vector<std::string> aliases{};
  std::optional<FileOrigin> imported{};  ///< nullopt for a lens in the library's own format
  DesignData design{};
  Medium object_space{};               ///< medium in front of the first surface; air unless a lens was reversed
  std::vector<SurfaceRow> surfaces{};  ///< from the object side to the film
  /// Zoom positions in order, and the positions that focus a zoom position. configured() applies a configuration.
  std::vector<Configuration> configurations{};

  bool operator==(const Prescription&) const = default;
};

/// Checks a prescription.
///
/// @param prescription  the lens
/// @param where         the name of the file or of the lens, the beginning of the message
/// @throws Error if a rule is broken:
/// - lens: 1 to 10,000 surfaces; all numbers are finite (clear apertures and subject distances may be infinite);
///   f-numbers are positive; wavelengths are 10 to 100,000 nm;
/// - surface: |radius| is at least 1e-12 mm, or 0 for a plane; |thickness| is below 1e10 mm (an object at infinity is
///   not a surface); the central obscuration is smaller than the semi-diameter; radius / sqrt|1 + conic| is at least
///   1e-15 mm; orders of aspheric terms are 2 to 40 and unique, and the slope of a term is below 1 up to 1e-12 mm;
/// - medium: the index is 0.1 to 5; V_d is not negative and needs an index or a glass; a mirror has the same medium on
///   both sides;
/// - coating: as validate() of a Coating;
/// - configurations: at most 1,000, with unique names; the first is a zoom position, and focus positions belong to zoom
///   positions; a configuration changes a surface at most once, and its surfaces obey the rules.
PETZVAL_API void validate(const Prescription& prescription, const std::string& where);

/// The lens in one of its configurations, with the rows, the stop and the nominal data of the configuration.
///
/// The list keeps the chosen zoom position and the positions that focus it, so that compile() knows how the lens
/// focuses. Between two adjacent zoom positions, thicknesses, conics and semi-diameters are linear; radii are linear if
/// both have the same sign; otherwise the curvature is linear. Nominal data that differ become absent. Positions that
/// focus both zoom positions at the same distance are interpolated as well. A prescription without configurations is
/// its own configuration 0.
///
/// @throws Error with the names of the configurations if the choice does not exist; for a fraction, if one of the two
///               configurations focuses another, or if their media or stops differ
PETZVAL_API Prescription configured(const Prescription& prescription, const ConfigurationChoice& choice);

/// The lens scaled by a factor. Powers of two add no rounding error.
///
/// @throws Error if `factor` is not finite and positive, or if a number leaves the normal range of double
PETZVAL_API Prescription scale(const Prescription& prescription, double factor);

/// The reversed lens: the last surface becomes the first, and the old image space becomes object space.
///
/// Light enters towards +z again: z in the old lens frame becomes z_last - z, or z - z_last with an odd number of
/// mirrors, with z_last the z of the old last vertex. The position of the new film is unknown: the last thickness is 0.
/// Data that apply to one side are dropped: f_number, half_field_deg, image_diagonal_mm, image_distance, design,
/// positions that focus, and changes of the thickness in front of the film.
///
/// @throws Error if the lens has no surface
PETZVAL_API Prescription reverse(const Prescription& prescription);

}  // namespace petzval
