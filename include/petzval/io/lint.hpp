// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

/// Subject of a Finding.
enum class FindingKind : std::uint8_t {
  focal_length,   ///< the computed focal length differs from the declared value by more than 2 %
  f_number,       ///< the f-number of an exact ray differs from the declared value by more than 2 %
  overlap,        ///< neighbouring surfaces intersect inside their clear apertures
  semi_diameter,  ///< beyond the end of the surface (LensSurface), or 0 on a surface that is not the stop
  no_stop,
  several_stops,
  image_distance,  ///< the film is off the paraxial image by more than 2 % of the focal length
  units,           ///< the focal length is 10, 25.4 or 1000 times the declared value, or the inverse
  apertures,       ///< diameters or half semi-diameters given as semi-diameters, by the declared f-number
  idle_stop,       ///< another rim clips the axial beam to less than 0.7 times the radius that the stop passes
  glass_index,     ///< n_d differs from n_d of the named glass
  film_size,       ///< the film is more than 3 times as large as the image circle, or smaller than a fiftieth
  pixel_shape,     ///< pixels are not square within 0.5 % and one pixel of film height
};

/// "focal_length", "f_number", "overlap", ...
PETZVAL_API std::string_view name(FindingKind kind) noexcept;

/// A doubtful entry of a prescription or film. The lens can still be traced.
struct Finding {
  FindingKind kind{};
  std::optional<int> surface;  ///< index of the surface, from 0
  double found = 0;            ///< the value of the prescription, film or lens
  double expected = 0;         ///< the value or limit that it should meet
  std::string message;         ///< one line, with units; surfaces count from 0 unless lint() is told otherwise
};

/// Checks the declared data of a prescription against computed values.
///
/// Uses the first configuration and the reference wavelength. The film position is compared with the image of the
/// design object.
///
/// @throws Error if the prescription is invalid, or a glass without a stated index is missing in glass_tables()
PETZVAL_API std::vector<Finding> lint(const Prescription& prescription);

/// Checks a prescription with the glasses of a catalogue: n_d of a medium must be within 0.005 of n_d of its glass.
///
/// @param prescription          the lens
/// @param glasses               the catalogue
/// @param first_surface_number  number of the first surface in messages; patents count from 1. Finding::surface counts
///                              from 0.
PETZVAL_API std::vector<Finding> lint(const Prescription& prescription, const GlassCatalogue& glasses,
                                      int first_surface_number = 0);

/// Edge thickness of each surface in mm: the distance along the axis to the next surface, at one height.
///
/// The height is the larger of the two clear semi-diameters that the prescription states, so that an element holds its
/// rims. Behind a mirror, where light travels backwards, the distance is measured along the light. A negative value
/// means that the surfaces intersect below this height.
///
/// @param lens  the lens
/// @return      a value for each surface; nullopt for the last surface, and if a semi-diameter of the two surfaces is
///              unlimited, one surface does not reach the height, or one is a cylinder, whose sag depends on the
///              section
PETZVAL_API std::vector<std::optional<double>> edge_thicknesses(const Lens& lens);

/// Repairs the findings of lint() that have an unambiguous solution.
///
/// In this order: `units` and `apertures` are scaled by the factor found, `several_stops` keeps the first stop, and
/// `image_distance` moves the film to the paraxial image. A change that would make the lens invalid is not made. If the
/// prescription has several configurations, only the stops are repaired.
///
/// @param prescription  the lens to repair
/// @param glasses       as in CompileOptions
/// @return              the changes; command: the kind of the finding
/// @throws Error        under the conditions of lint()
PETZVAL_API std::vector<ImportWarning> repair(Prescription& prescription, const GlassCatalogue* glasses = nullptr);

/// Checks the film of a camera against the image circle of its lens, and the shape of its pixels.
///
/// film_size: `found` is the diameter of the circle about the axis that contains the film, `expected` the diameter of
/// image_circle_mm() with any light. Films up to three times as large are accepted. pixel_shape: `found` is the width
/// of a pixel divided by its height, `expected` is 1. Pixels of lenses with cylindrical surfaces may have any shape.
///
/// @throws Error if the film has no area or no pixels or is invalid for a Camera; also under the conditions of
///               with_film() and image_circle_mm()
PETZVAL_API std::vector<Finding> lint(const Lens& lens, const Film& film);

/// A prescription with glass names, and the lists of matched and unmatched media.
struct MatchedGlasses {
  Prescription prescription;
  std::vector<ImportWarning> matched;    ///< command: "surfaces 0, 4"; message: the medium and its glass
  std::vector<ImportWarning> unmatched;  ///< the same, with the reason
};

/// Assigns to each unnamed medium the catalogue glass nearest to its n_d and V_d.
///
/// A matched medium has the dispersion of the glass instead of the n_d/V_d model.
///
/// @param prescription  the lens; named media, air and mirrors are kept
/// @param glasses       the catalogue, searched with nearest_glasses()
/// @param nd            largest difference of n_d. Tables print n_d to five digits or to three, and V_d to one; two
///                      glasses of a catalogue differ by more.
/// @param vd            largest difference of V_d. Media beyond a limit or without V_d keep their numbers and are
///                      listed in `unmatched`.
/// @return              the lens; a matched medium has glass, catalogue and glass_origin "matched", and keeps its n_d
///                      and V_d
/// @throws Error        if a limit is negative or not finite
PETZVAL_API MatchedGlasses match_glasses(const Prescription& prescription, const GlassCatalogue& glasses,
                                         double nd = 0.001, double vd = 0.5);

}  // namespace petzval
