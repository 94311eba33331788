// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "petzval/analysis/psf_set.hpp"
#include "petzval/core/export.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// The name of the EXR part of a kernel, for example "10deg_1000mm_587.5618nm_f2.8".
PETZVAL_API std::string psf_part_name(const PsfSetPoint& point);
/// Converts a kernel of a PSF set to a part of a multi-part EXR file. The parts of a file may have any order.
///
/// Channels: Y (the light, shown by any EXR viewer), hits.x and hits.y. Attributes: the point (field_deg, distance_mm,
/// wavelength_nm, f_number), the numbers of PsfKernel by their names with anchor_x_mm and anchor_y_mm, `anchor`
/// (chief_ray or centroid), `diffraction`, and `checksum` over all channels and the other attributes.
PETZVAL_API ExrPart to_exr_part(const PsfKernel& kernel, const PsfSetPoint& point);

struct PsfPart {
  PsfSetPoint point;
  PsfKernel kernel;
};

/// Converts a part back to its kernel, bit for bit.
///
/// @throws Error with the name of the part, if data are missing or have changed
PETZVAL_API PsfPart from_exr_part(const ExrPart& part);

/// Reads a PSF set from an EXR file.
///
/// @throws Error if the file cannot be read, from_exr_part() rejects a part, or a node of the grid has no part
PETZVAL_API PsfSet read_psf_set(const std::filesystem::path& file);

/// Builds a PSF set from parts that have already been read, for programs that need further attributes of the parts.
///
/// @param parts   the parts of a file
/// @param file    file name for error messages
/// @throws Error  under the conditions of read_psf_set()
PETZVAL_API PsfSet psf_set_of(std::vector<ExrPart> parts, const std::filesystem::path& file);

}  // namespace petzval
