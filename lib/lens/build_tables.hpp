// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"

namespace petzval::detail {

/// The way of a batch, with what it points to.
template <class R>
struct CourseTables {
  std::vector<kernel::Step<R>> steps;
  std::vector<kernel::Bend<R>> bends;
  std::vector<R> n_first, per_n_last;
  kernel::Course<R> course;  ///< its pointers are set by view()

  kernel::Course<R> view() const noexcept {
    auto seen = course;
    seen.steps = steps.data();
    seen.bends = bends.data();
    seen.n_first = n_first.data();
    seen.per_n_last = per_n_last.data();
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
  CourseTables<R> course_to_film, course_to_scene;
  std::size_t wavelengths = 0;
  std::int32_t stop = -1;

  kernel::LensView<R> view() const noexcept {
    return {surfaces.data(), aspheres.data(), to_film.data(), to_scene.data(),       surfaces.size(),
            vertex_z.data(), wavelengths,     stop,           course_to_film.view(), course_to_scene.view()};
  }
};

/// stop: position of the surface that is it. indices: [wavelength][space], one space more than surfaces.
template <class R>
Tables<R> build_tables(std::span<const LensSurface> surfaces, std::optional<std::size_t> stop,
                       std::span<const double> indices, std::size_t wavelengths);

/// The way of a batch: the surfaces in the order of travel.
template <class R>
CourseTables<R> build_course(std::span<const LensSurface> surfaces, std::optional<std::size_t> stop,
                             std::span<const double> indices, std::size_t wavelengths, Travel travel);

}  // namespace petzval::detail
