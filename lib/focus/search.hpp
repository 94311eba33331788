// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solver.hpp"

namespace petzval::focus_detail {

/// The solvers by exact rays. The film of a subject can only be traced; everything else is a search over the vergence
/// of the subject (Conjugates), along which the paraxial film is nearly the exact one.
///
/// The film moves out as the subject comes nearer, up to a limit: there it is at infinity or, since rays with
/// aberrations never all leave parallel, turns back. Nearer subjects are out of reach, so that film and subject
/// determine each other.
class Search {
 public:
  /// Throws Error if nothing can be traced from infinity.
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
  std::optional<double> infinite_film_;  ///< of a subject at infinity
  double cap_;                           ///< film vergence beyond that of all films
};

}  // namespace petzval::focus_detail
