// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/config.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// Renders a PSF as an RGB image: irradiance relative to the light on the paraxial entrance pupil, per mm^2.
///
/// Images of one light through different lenses and apertures have the same scale. The sum of all pixels times the
/// pixel area is the throughput, less the rays outside the image. The image is rotated by 180 degrees relative to the
/// film, as a photograph: left and down are +x and +y of the film, and a light beyond the focus shows the iris upright.
///
/// @param psf      the PSF
/// @param weights  linear RGB weights, one triple per wavelength, from rgb_weights()
/// @throws Error   if the number of weights is wrong, or the PSF lacks a count for a pixel and wavelength
PETZVAL_API RgbImage render(const Psf& psf, std::span<const std::array<double, 3>> weights);

/// Renders an image with diffraction, with the same units and orientation.
///
/// @param psf      the image
/// @param weights  linear RGB weights, one triple per wavelength, from rgb_weights()
/// @throws Error   if the number of weights is wrong, or the image lacks a value for a pixel and wavelength
PETZVAL_API RgbImage render(const DiffractionPsf& psf, std::span<const std::array<double, 3>> weights);

/// Converts a PSF to a spectral image for write_exr(): one channel per wavelength, and R, G, B of render() for viewers.
///
/// The channel of 587.5618 nm is named S0.587,5618nm (a point would start a layer). Its values are the irradiance of
/// that wavelength with the unit of render(), without weight. Attributes state the version of the layout and the unit
/// mm^-2.
///
/// @throws Error under the conditions of render()
///
/// Source: Fichet, Pacanowski, Wilkie, An OpenEXR Layout for Spectral Images, JCGT 10(3), 2021.
PETZVAL_API ExrPart spectral_image(const Psf& psf, std::span<const std::array<double, 3>> weights);

/// The name of the EXR part of a kernel, for example "10deg_1000mm_587.5618nm_f2.8".
PETZVAL_API std::string psf_part_name(const PsfSetPoint& point);
/// Converts a kernel of a PSF set to a part of a multi-part EXR file. The parts of a file may have any order.
///
/// Channels: Y (the light, shown by any EXR viewer), hits.x and hits.y. Attributes: the point (field_deg, distance_mm,
/// wavelength_nm, f_number), the numbers of PsfKernel by their names with anchor_x_mm and anchor_y_mm, `anchor`
/// (chief_ray or centroid), `diffraction`, and `checksum` over all channels and the other attributes.
PETZVAL_API ExrPart to_exr_part(const PsfKernel& kernel, const PsfSetPoint& point);

/// Converts a part back to its point and kernel, bit for bit.
///
/// @throws Error with the name of the part, if data are missing or have changed
PETZVAL_API std::pair<PsfSetPoint, PsfKernel> from_exr_part(const ExrPart& part);

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
