// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/ray_derivatives.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// The rungs of the ladder from the cheapest model of a lens to the most accurate one.
enum class ModelKind : std::uint8_t {
  pinhole,  ///< first order, all of it through the middle of the pupil
  thin,     ///< first order, with the iris in the lens: a disc as wide as the entrance pupil in the principal plane
  thin_two_disc,  ///< first order, with a pupil of two discs that move apart with the field, fitted to the real one's
  thick,          ///< first order: cardinal points and the paraxial pupils
  polynomial_3,   ///< rays as polynomials of film and pupil point; the number is the degree
  polynomial_5,
  polynomial_7,
  polynomial_9,
  polynomial_11,
  exact_float,  ///< every surface
  exact_double,
};

/// "pinhole", "thin", "thin_two_disc", "thick", "polynomial_3", ..., "exact_float", "exact_double".
PETZVAL_API std::string_view name(ModelKind model) noexcept;
/// The model of a name; nothing where no model has it.
PETZVAL_API std::optional<ModelKind> model_named(std::string_view name) noexcept;
/// All of them, in the order above.
PETZVAL_API std::span<const ModelKind> models() noexcept;

/// What a Camera needs to know of a lens: its pupils, and where lines of the film's space go on the scene's side and
/// back. A renderer's own model needs these three and can be given to sample_rays(). Two more are read where the film
/// is tilted: `ends_at_rims`, and pinhole_shifts() of a model that has it, as ParaxialModel's.
///
/// All calls are const, may come from many threads, never allocate, and write every slot of their results with finite
/// numbers; what a ray became says its fate.
template <class M>
concept RayModel = requires(const M& model, std::size_t count, const RayWavelengths& wavelengths, RayFate* fates,
                            const TwoPlaneRays<const float>& lines, const RayArrays<float>& rays,
                            const TwoPlaneRays<const double>& exact_lines, const RayArrays<double>& exact_rays,
                            const RayArrays<const double>& from_scene, const TwoPlaneRays<double>& to_lines) {
  /// The pupils that are sampled. A model without rims passes what lies within them, and no more.
  { model.pupils() }
  noexcept->std::convertible_to<const FilmPupilTable&>;
  /// Lines from the film as rays that leave the lens towards the scene; fates: N, never null.
  { model.to_scene(count, lines, wavelengths, rays, fates) }
  noexcept;
  { model.to_scene(count, exact_lines, wavelengths, exact_rays, fates) }
  noexcept;
  /// Rays from the scene (anywhere on their lines) as lines that meet the film.
  { model.to_film(count, from_scene, wavelengths, to_lines, fates) }
  noexcept;
};

/// Whether rays of a model end at rims: to_scene() alone says which of its lines pass, in its pupils or beside them.
template <class M>
inline constexpr bool ends_at_rims = false;

}  // namespace petzval::inline v0
