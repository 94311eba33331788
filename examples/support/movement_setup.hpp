// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "camera_setup.hpp"
#include "cli.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace examples {

/// Command line of the programs that move the film.
struct MovementOptions {
  CameraFlags setup;  ///< lens, f-number and film
  std::string model;

  std::string model_name() const { return !model.empty() ? model : setup.lens.thin_mm > 0 ? "thin" : "real"; }
};
void add_movement_options(App& app, MovementOptions& options);

/// The lens of the options with the chosen model.
struct MovingLens {
  std::string id, title;              ///< output files begin with id
  std::string conditions;             ///< "f/4, real model"
  std::optional<petzval::Lens> lens;  ///< nullopt for an ideal lens without a file
  petzval::IdealLens ideal;           ///< thin lens, or the cardinal points for thick and real
  bool exact = false;                 ///< the model is real: exact rays
  petzval::Film film;                 ///< the film size of the options
};
MovingLens moving_lens(const MovementOptions& options);

/// The reason why a point is not used, in words; empty if the point is used.
const char* in_words(petzval::TargetStatus status);

}  // namespace examples
