// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lens/lens_view.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "spectrum.hpp"

namespace petzval::lens_detail {

/// A SurfaceSequence and the arrays to which it points.
template <class R>
struct SurfaceSequenceTables {
  std::vector<kernel::Step<R>> steps;
  std::vector<kernel::RefractionConstants<R>> bends;
  std::vector<R> bend_rows, n_first, per_n_last;
  std::vector<kernel::SquaredIndex<R>> media;
  kernel::SurfaceSequence<R> sequence;  ///< its pointers are set by view()

  kernel::SurfaceSequence<R> view() const noexcept {
    auto seen = sequence;
    seen.steps = steps.data();
    seen.bends = bends.data();
    seen.bend_rows = bend_rows.data();
    seen.n_first = n_first.data();
    seen.per_n_last = per_n_last.data();
    seen.media = media.data();
    return seen;
  }
};

/// The constants of the kernels for one storage type, computed in double and rounded once.
template <class R>
struct Tables {
  std::vector<kernel::SurfaceTable<R>> surfaces;
  std::vector<kernel::Asphere<R>> aspheres;
  std::vector<kernel::Interface<R>> to_film, to_scene;
  std::vector<R> vertex_z;
  std::vector<kernel::StopEdge<R>> iris;
  SurfaceSequenceTables<R> sequence_to_film, sequence_to_scene;
  std::size_t wavelengths = 0, primary = 0;
  std::int32_t stop = -1;

  kernel::LensView<R> view() const noexcept {
    return {.surfaces = surfaces.data(),
            .aspheres = aspheres.data(),
            .to_film = to_film.data(),
            .to_scene = to_scene.data(),
            .count = surfaces.size(),
            .vertex_z = vertex_z.data(),
            .wavelengths = wavelengths,
            .primary = primary,
            .stop = stop,
            .iris = iris,
            .sequence_to_film = sequence_to_film.view(),
            .sequence_to_scene = sequence_to_scene.view()};
  }
};

/// Tables and the view of them. The view is built once, because building it takes longer than tracing a ray.
template <class R>
struct SharedTables {
  const Tables<R> tables;
  const kernel::LensView<R> view = tables.view();

  explicit SharedTables(Tables<R>&& built) : tables(std::move(built)) {}
  SharedTables(const SharedTables&) = delete;
  SharedTables& operator=(const SharedTables&) = delete;
};

/// Builds the tables of a lens.
/// @param aspheres the aspheric surfaces (describe_aspheres)
/// @param stop position of the stop
/// @param indices [wavelength][space], one space more than surfaces
template <class R>
Tables<R> build_tables(std::span<const LensSurface> surfaces, std::span<const kernel::Asphere<double>> aspheres,
                       std::optional<std::size_t> stop, const Iris& iris, std::span<const double> indices,
                       std::size_t wavelengths, const Spectrum& spectrum);

/// The surfaces in the order of travel.
template <class R>
SurfaceSequenceTables<R> build_sequence(std::span<const LensSurface> surfaces, std::optional<std::size_t> stop,
                                        std::span<const double> indices, std::size_t wavelengths,
                                        const Spectrum& spectrum, Travel travel);

}  // namespace petzval::lens_detail
