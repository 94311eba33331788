// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "petzval/core/config.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {

/// Reads ray polynomials from a JSON file of the format "petzval-ray-polynomial 1".
///
/// @throws Error with file, line, column, fit (from 0), key, value and rule: for missing, unknown and duplicate keys
///               (pupil_shift_x and pupil_radius_x_mm occur with mirror symmetry only), numbers outside the range of
///               double, lists longer than a polynomial of degree 11, more than 10,000 fits, and polynomials that the
///               constructor of RayPolynomial refuses
PETZVAL_API RayPolynomial read_ray_polynomial(const std::filesystem::path& file);

/// Reads ray polynomials from memory, like read_ray_polynomial(). `where` is the name of the source in messages.
PETZVAL_API RayPolynomial parse_ray_polynomial(std::string_view json, const std::string& where);

/// Formats a ray polynomial as JSON.
///
/// Numbers are the shortest decimals that read back exactly: after writing and reading, a polynomial gives rays with
/// the same bits, and the same text.
PETZVAL_API std::string format_ray_polynomial(const RayPolynomial& polynomial);

/// Writes the result of format_ray_polynomial() to a file.
///
/// @throws Error if write_file() throws
PETZVAL_API void write_ray_polynomial(const RayPolynomial& polynomial, const std::filesystem::path& file);

}  // namespace petzval
