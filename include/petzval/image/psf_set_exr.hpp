// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "petzval/analysis/psf_set.hpp"
#include "petzval/core/export.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// One part of a multi-part EXR file for each kernel of a PSF set, in any order.
///
/// Channels: Y, the light, and hits.x, hits.y. Attributes: the point (field_deg, distance_mm, wavelength_nm, f_number),
/// the numbers of PsfKernel by their names with anchor_x_mm and anchor_y_mm, `anchor` (chief_ray or centroid),
/// `diffraction`, and `checksum` over all of these. Any reader of EXR shows Y.
///
/// The part's name tells the point: "10deg_1000mm_587.5618nm_f2.8".
PETZVAL_API std::string psf_part_name(const PsfSetPoint& point);
PETZVAL_API ExrPart to_exr_part(const PsfKernel& kernel, const PsfSetPoint& point);

struct PsfPart {
  PsfSetPoint point;
  PsfKernel kernel;
};

/// The kernel of a part, bit for bit. Throws Error that names the part where anything is missing or not as it was
/// written.
PETZVAL_API PsfPart from_exr_part(const ExrPart& part);

/// The set of a file's parts. Throws Error that names the file, for parts that from_exr_part refuses, and for nodes of
/// the grid that no part holds.
PETZVAL_API PsfSet read_psf_set(const std::filesystem::path& file);

/// The same of parts that were read, whose other attributes a program wants to see. file: for messages.
PETZVAL_API PsfSet psf_set_of(std::vector<ExrPart> parts, const std::filesystem::path& file);

}  // namespace petzval
