// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli.hpp"
#include "load_lens.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/focus/image_rays.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace examples {

/// Command line of the programs that move the film.
struct MovementOptions {
  LensInput lens_file;
  std::string model = "real", film_mm = "36x24";
  double f_number = 0, focal_length_mm = 0;  // 0: not given
  bool film_given = false;
};
void add_movement_options(App& app, MovementOptions& options);

/// The lens of the options with the chosen model.
struct MovingLens {
  std::string id, title;              ///< output files begin with id
  std::string conditions;             ///< "f/4, real model"
  std::optional<petzval::Lens> lens;  ///< absent for an ideal lens without a file
  petzval::IdealLens ideal;           ///< thin, or (thick and real) the cardinal points
  bool exact = false;                 ///< the model is real: exact rays
  petzval::Film film;                 ///< its size

  /// Exact rays to the film and to the images of these places beside it: so many of each, fewer of many places (2^22 of
  /// all). Needs a lens.
  petzval::ImageRays bundles(std::span<const petzval::ScenePoint> places, std::size_t rays) const;
};
MovingLens moving_lens(const MovementOptions& options);

/// The use of a point in words; empty if it is used.
const char* in_words(petzval::TargetUse use);

}  // namespace examples
