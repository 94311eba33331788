// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"

namespace petzval::inline v0 {

/// Reads polynomials of rays from their JSON (format "petzval-ray-polynomial 1"). Throws Error that names the file, the
/// fit (from 0), the key, what was found and what was wanted, or the byte where the text is no JSON. Every key must be
/// there once and no other; refused are numbers beyond double, lists longer than a polynomial of degree 11 has them,
/// more than 10,000 fits, and what the constructor of RayPolynomial refuses.
PETZVAL_API RayPolynomial read_ray_polynomial(const std::filesystem::path& file);

/// The same from memory; `where` stands for the file's name in messages.
PETZVAL_API RayPolynomial parse_ray_polynomial(std::string_view json, const std::string& where);

/// The JSON text: numbers as the shortest decimals that read back exactly, so that what is read back computes the same
/// bits. Writing what was read from such a text gives the same bytes.
PETZVAL_API std::string format_ray_polynomial(const RayPolynomial& polynomial);

/// That text into a file, as a whole or not at all. Throws Error that names the file.
PETZVAL_API void write_ray_polynomial(const RayPolynomial& polynomial, const std::filesystem::path& file);

}  // namespace petzval::inline v0
