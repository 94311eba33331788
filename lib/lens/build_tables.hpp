// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"

namespace petzval::detail {

/// The constants of the kernels for one storage type, computed in double and rounded once.
template <class R>
struct Tables {
  std::vector<kernel::SurfaceTable<R>> surfaces;
  std::vector<kernel::Asphere<R>> aspheres;
  std::vector<kernel::Interface<R>> to_film, to_scene;
  std::vector<R> vertex_z;
  std::size_t wavelengths = 0;

  kernel::LensView<R> view() const noexcept {
    return {surfaces.data(), aspheres.data(), to_film.data(), to_scene.data(),
            surfaces.size(), vertex_z.data(), wavelengths};
  }
};

/// indices: [wavelength][space], one space more than surfaces.
template <class R>
Tables<R> build_tables(std::span<const LensSurface> surfaces, std::span<const double> indices, std::size_t wavelengths);

}  // namespace petzval::detail
