// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "petzval/camera/exact_model.hpp"
#include "petzval/camera/paraxial_model.hpp"
#include "petzval/camera/polynomial_model.hpp"
#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// Any rung of the ladder: visited once for a batch, not for a ray.
using AnyModel = std::variant<ParaxialModel, PolynomialModel, ExactModel<float>, ExactModel<double>>;

/// Builds a rung for a film no point of which is farther from the axis than film_radius (mm). Throws Error where the
/// model's own constructor does.
PETZVAL_API AnyModel make_model(ModelKind model, const Lens& lens, double film_radius);

/// The pupils that it samples.
PETZVAL_API const FilmPupilTable& film_pupil_table_of(const AnyModel& model) noexcept;

/// Which rung it is.
PETZVAL_API ModelKind kind_of(const AnyModel& model) noexcept;

}  // namespace petzval::inline v0
