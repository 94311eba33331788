// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval::glass_detail {

/// A name in lower case without dashes, blanks and underscores: "N-BK7" and "nbk7" are one glass.
PETZVAL_API std::string bare(std::string_view name);
/// True if two names are equal in bare letters.
PETZVAL_API bool same_bare(std::string_view a, std::string_view b) noexcept;

/// For messages: up to five names in the tables that differ from a name by a few letters: "N-BK7, K-BK7".
PETZVAL_API std::string similar_names(const GlassCatalogue& glasses, std::string_view name);

}  // namespace petzval::glass_detail
