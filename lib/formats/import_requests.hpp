// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace petzval::formats_detail {

/// A thickness that is determined by a marginal ray.
struct ThicknessSolve {
  int line = 0;
  std::string command;
  std::size_t surface = 0;              ///< surface before the thickness
  double height = 0;                    ///< ray height on the next surface (mm)
  std::optional<double> beam_radius{};  ///< ray height on the first surface (mm); needed if `height` is not 0
  double zone = 0;                      ///< fraction of the pupil radius, for an exact ray; 0 for first order
  double offset = 0;                    ///< added to the solution (mm)
  bool is_stated = true;                ///< false if the file omits the thickness
  bool is_taken = false;                ///< true if the solution replaces a stated thickness
};

/// A film without a position, to be put at the focus of light from infinity.
struct FilmAtFocus {
  int line = 0;
  std::string command;
  std::string reason;       ///< for the warning
  bool is_needed = false;   ///< true: the lens is refused if it has no such focus
  bool in_the_rows = true;  ///< false if only `configurations` lack the film position
  std::vector<std::size_t> configurations{};
};

/// A focal length that the file states, in mm.
struct StatedFocalLength {
  int line = 0;
  std::string command;
  double mm = 0;
  bool is_default = false;  ///< true if the program writes this number for every new lens
  /// True if the numbers were printed and copied: a lens whose focal length is off by more than 2 % is refused.
  bool proves_table = false;
};

/// A column of apertures that may be diameters or semi-diameters. The surfaces of the lens already have half of the
/// numbers.
struct UnknownApertures {
  int line = 0;
  bool likely_diameters = true;  ///< the meaning if the f-number does not decide
};

/// A configuration in a list of positions.
struct Position {
  std::optional<double> magnification{};  ///< determines the subject distance
  bool is_named = false;                  ///< true if the name is from the file
};

/// Positions for which the file states neither names nor the zoom position that they focus.
struct UnnamedPositions {
  int line = 0;
  std::vector<Position> list;  ///< one per configuration
};

/// Requests of a file beyond its prescription; complete() carries them out.
struct ImportRequests {
  std::vector<int> surface_lines;  ///< lines of the surfaces in the file; empty if unknown
  /// True if the aperture of the design is a rounded number that only describes the lens. It then defines no beam, and
  /// the rim of the stop, if the file states it, is the size of the stop.
  bool nominal_aperture = false;
  /// Value of the design's aperture per configuration; nullopt or too short if equal to the design.
  std::vector<std::optional<double>> position_apertures;
  bool last_plane_may_be_film = false;  ///< a plane in focus is the film if it is the last surface
  bool plane_may_be_stop = false;       ///< a plane in one medium is the stop if none is marked
  bool names_missing_apertures = false;
  std::optional<UnknownApertures> unknown_apertures;
  std::vector<ThicknessSolve> solves;  ///< from the first surface to the last
  std::optional<FilmAtFocus> film_at_focus;
  std::optional<StatedFocalLength> focal_length;
  int telecentric_line = 0;  ///< line that declares a telecentric object space; 0 if absent
  std::string telecentric_command;
  std::optional<UnnamedPositions> positions;
};

}  // namespace petzval::formats_detail
