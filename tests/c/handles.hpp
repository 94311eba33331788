// SPDX-License-Identifier: Apache-2.0
/// \file
/// Lenses and cameras of the C interface that free themselves, for the tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "petzval/petzval.h"

namespace petzval::testing {

inline const std::string double_gauss = std::string(PETZVAL_TEST_DATA) + "/lenses/double_gauss_100mm_f2.0.json";

struct Free {
  void operator()(petzval_lens* lens) const { petzval_lens_free(lens); }
  void operator()(petzval_camera* camera) const { petzval_camera_free(camera); }
  void operator()(petzval_glasses* glasses) const { petzval_glasses_free(glasses); }
  void operator()(petzval_lens_rays* rays) const { petzval_lens_rays_free(rays); }
  void operator()(petzval_layers* layers) const { petzval_layers_free(layers); }
  void operator()(petzval_blur* blur) const { petzval_blur_free(blur); }
};
using LensHandle = std::unique_ptr<petzval_lens, Free>;
using CameraHandle = std::unique_ptr<petzval_camera, Free>;
using RaysHandle = std::unique_ptr<petzval_lens_rays, Free>;
using LayersHandle = std::unique_ptr<petzval_layers, Free>;
using BlurHandle = std::unique_ptr<petzval_blur, Free>;

inline LensHandle read_lens(const std::string& file = double_gauss, const petzval_lens_options* options = nullptr) {
  petzval_lens* lens = nullptr;
  EXPECT_EQ(petzval_lens_read(file.c_str(), options, &lens), PETZVAL_OK) << petzval_message();
  return LensHandle(lens);
}
inline CameraHandle create_camera(const LensHandle& lens, const petzval_film* film = nullptr,
                                  const petzval_camera_options* options = nullptr) {
  petzval_camera* camera = nullptr;
  EXPECT_EQ(petzval_camera_create(lens.get(), film, options, &camera), PETZVAL_OK) << petzval_message();
  return CameraHandle(camera);
}

}  // namespace petzval::testing
