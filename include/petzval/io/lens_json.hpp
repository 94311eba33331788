// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

/// Reads a lens from a JSON file (format "petzval-lens 1"; data/README.md has its keys). Surfaces without a clear
/// aperture get the aperture of with_apertures(). read_lens() of petzval::formats reads a file of this or any other
/// format. Throws Error as parse_prescription does, and for a file that cannot be read.
PETZVAL_API Prescription read_prescription(const std::filesystem::path& file);

/// Reads a lens from JSON in memory, without additions. `where` is the name of the source in messages. Throws
/// Error that names it, line and column, the surface (from 0), the key, its value and the rule. It refuses unknown and
/// duplicate keys, comments, NaN, numbers out of range of double, brackets nested deeper than the format has them,
/// lists of more than 10,000 entries, and all that `validate` refuses. Time is proportional to the size of the file,
/// memory at most 4 times its size (8 times for a file that is one number of megabytes).
PETZVAL_API Prescription parse_prescription(std::string_view json, const std::string& where);

/// The lens as JSON: one surface a line, numbers as the shortest decimals that read back exactly. Reading and writing
/// such a text again gives the same bytes.
PETZVAL_API std::string format_prescription(const Prescription& prescription);

/// Writes that text as write_file does. Throws Error that names the file.
PETZVAL_API void write_prescription(const Prescription& prescription, const std::filesystem::path& file);

/// Reads ray polynomials from a JSON file (format "petzval-ray-polynomial 1"). Throws Error that names the file, line
/// and column, the fit (from 0), the key, its value and the rule. Every key must occur once, pupil_shift_x and
/// pupil_radius_x_mm with mirror symmetry only, and no other. It refuses numbers out of range of double, lists longer
/// than a polynomial of degree 11 has, more than 10,000 fits, and all that the constructor of RayPolynomial
/// refuses.
PETZVAL_API RayPolynomial read_ray_polynomial(const std::filesystem::path& file);

/// The same from memory. `where` is the name of the source in messages.
PETZVAL_API RayPolynomial parse_ray_polynomial(std::string_view json, const std::string& where);

/// The polynomial as JSON. Numbers are the shortest decimals that read back exactly: a polynomial that was written and
/// read gives rays with the same bits, and the same text again.
PETZVAL_API std::string format_ray_polynomial(const RayPolynomial& polynomial);

/// Writes that text as write_file does. Throws Error that names the file.
PETZVAL_API void write_ray_polynomial(const RayPolynomial& polynomial, const std::filesystem::path& file);

}  // namespace petzval
