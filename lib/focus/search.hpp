// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "model.hpp"

namespace petzval::inline v0::focus_detail {

/// The solvers for a model whose images can only be traced: the film of a subject is a function to evaluate, and
/// everything else a search in it, over the nearness of the subject (Conjugates), along which the paraxial film is
/// nearly the exact one.
///
/// The film moves out as the subject comes nearer, up to a limit: where it gets to infinity or, as rays with
/// aberrations never all leave parallel, turns back. What lies nearer is out of reach, so that the film and the subject
/// determine each other.
class Search {
 public:
  /// Throws Error where nothing can be traced from infinity.
  explicit Search(const FocusModel& model);

  FocusSolution focus(double distance) const;
  FocusSolution subject(double film_z) const;
  FocusSolution nearest() const;

 private:
  FocusSolution focus_from_film(double distance) const;
  FocusSolution too_near() const;
  FocusSolution farthest() const;
  FocusSolution at(FocusStatus status, double nearness) const;

  double subject_at(double nearness) const noexcept;
  std::optional<double> film(double nearness) const;
  double film_nearness(double film_z) const noexcept;
  double separation(double nearness) const;
  std::optional<double> nearness_for(double film_nearness) const;
  double limit() const;
  double turning_point() const;

  const FocusModel& model_;
  const Conjugates& c_;
  std::optional<double> infinite_film_;  ///< of a subject at infinity
  double cap_;                           ///< film nearness beyond that of all films
};

}  // namespace petzval::inline v0::focus_detail
