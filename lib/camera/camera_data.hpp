// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/camera/camera.hpp"
#include "scene_side.hpp"

namespace petzval::inline v0 {

struct Camera::Data {
  Lens lens;
  Film film;
  AnyModel model;
  std::vector<double> scale;  ///< of weights and importance, by wavelength
  camera_detail::SceneSide scene;
};

}  // namespace petzval::inline v0
