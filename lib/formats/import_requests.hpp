// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace petzval::formats_detail {

/// A thickness that a ray of the axis determines.
struct ThicknessSolve {
  int line = 0;
  std::string command;
  std::size_t surface = 0;              ///< in front of the thickness
  double height = 0;                    ///< ray height on the next surface (mm)
  std::optional<double> beam_radius{};  ///< ray height on the first surface (mm); needed if `height` is not 0
  double zone = 0;                      ///< fraction of the radius of the pupil, for an exact ray; 0: to first order
  double offset = 0;                    ///< added to the solution (mm)
  bool is_stated = true;                ///< false: the file leaves the thickness out
  bool is_taken = false;                ///< true: the solution replaces a thickness that the file states
};

/// A film without a position: it is put at the focus of light from infinity.
struct FilmAtFocus {
  int line = 0;
  std::string command;
  std::string reason;       ///< for the warning
  bool is_needed = false;   ///< true: a lens without such a focus is refused
  bool in_the_rows = true;  ///< false: only `configurations` have no position of the film
  std::vector<std::size_t> configurations{};
};

/// A focal length that the file states, in mm.
struct StatedFocalLength {
  int line = 0;
  std::string command;
  double mm = 0;
  bool is_default = false;  ///< the program writes the number for a new lens: it may mean nothing
};

/// A column of apertures that may be diameters or semi-diameters. The rows have half of the numbers.
struct UnknownApertures {
  int line = 0;
  bool likely_diameters = true;  ///< the meaning if the f-number does not tell
};

/// A configuration of a list of positions.
struct Position {
  std::optional<double> magnification{};  ///< gives the subject distance
  bool is_named = false;                  ///< true: the name is from the file
};

/// Positions for which the file says neither the names nor which of them focus which zoom position.
struct UnnamedPositions {
  int line = 0;
  std::vector<Position> list;  ///< for each configuration
};

/// Requests of a file beyond its prescription, as data: complete() carries them out.
struct ImportRequests {
  std::vector<int> surface_lines;  ///< lines of the surfaces in the file; empty: unknown
  /// True if the design's aperture is a rounded number that describes the lens. It launches no beam: the rim of the
  /// stop, if the file has one, is the size of the stop.
  bool nominal_aperture = false;
  /// Value of the design's aperture by configuration; nullopt or too short if it does not differ from the design.
  std::vector<std::optional<double>> position_apertures;
  bool last_plane_may_be_film = false;  ///< the last surface is the film if it is a plane in the focus
  bool plane_may_be_stop = false;       ///< without a marked stop, a plane in one medium is the stop
  bool names_missing_apertures = false;
  std::optional<UnknownApertures> unknown_apertures;
  std::vector<ThicknessSolve> solves;  ///< from the first surface to the last
  std::optional<FilmAtFocus> film_at_focus;
  std::optional<StatedFocalLength> focal_length;
  int telecentric_line = 0;  ///< line that asks for a telecentric object space; 0: no line
  std::string telecentric_command;
  std::optional<UnnamedPositions> positions;
};

}  // namespace petzval::formats_detail
