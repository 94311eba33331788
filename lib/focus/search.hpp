// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solver.hpp"

namespace petzval::focus_detail {

/// Focus solvers by exact rays. Tracing gives the film of a subject. All other results are found by a search over the
/// vergence of the subject (Conjugates), for which the paraxial film nearly equals the exact film.
///
/// The film moves away from the lens as the subject comes nearer, up to a limit. At the limit the film is at infinity
/// or, because rays with aberrations are never all parallel, starts to move back. Nearer subjects count as unreachable,
/// so that each film has one subject.
class Search {
 public:
  /// Throws Error as FocusSolver::image() does for a subject at infinity.
  explicit Search(const FocusSolver& solver);

  FocusSolution focus(double distance) const;
  FocusSolution subject(double film_z) const;
  FocusSolution nearest() const;

 private:
  FocusSolution focus_from_film(double distance) const;
  FocusSolution too_near() const;
  FocusSolution farthest() const;
  FocusSolution at(FocusStatus status, double vergence) const;

  double subject_at(double vergence) const noexcept;
  std::optional<double> film(double vergence) const;
  double film_vergence(double film_z) const noexcept;
  double separation(double vergence) const;
  std::optional<double> vergence_for(double film_vergence) const;
  double limit() const;
  double turning_point() const;

  const FocusSolver& solver_;
  const Conjugates& c_;
  std::optional<double> infinite_film_;  ///< film of a subject at infinity
  double cap_;                           ///< limit of film vergences, above the vergence of every film
};

}  // namespace petzval::focus_detail
