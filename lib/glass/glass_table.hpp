// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval::glass_detail {

inline constexpr std::string_view glass_table_header =
    "catalogue,name,nd,vd,formula,wl_min_um,wl_max_um,coefficients,origin";

/// Appends the glasses of a table in this library's own form.
/// @param stream, where the table and its file name, for messages
/// @throws Error, with the line, if a glass is invalid
PETZVAL_API void read_glass_table(std::istream& stream, const std::string& where, std::vector<Glass>& glasses);

}  // namespace petzval::glass_detail
