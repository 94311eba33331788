// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "petzval/camera/camera.hpp"
#include "petzval/exports/calibration.hpp"
#include "petzval/exports/ray_map.hpp"
#include "support/files.hpp"

namespace commands {

/// Writes the two tables of Omniverse as EXR files of 32-bit float.
void write_omniverse(const petzval::OmniverseTables& tables, const std::filesystem::path& enter,
                     const std::filesystem::path& exit);

/// The description of a ray map: layout, units, frame, film, lens samples, wavelength and errors.
examples::Json head_of(const petzval::RayMap& map, const petzval::Camera& camera);

/// Writes a ray map as EXR, one part for each lens sample. The attribute "ray_map" of the first part is head_of().
void write_ray_map(const petzval::RayMap& map, const petzval::Camera& camera, const std::filesystem::path& file);

}  // namespace commands
