// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "petzval/core/config.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval::glass_detail {

/// A name in lower case without dashes, blanks and underscores: "N-BK7" and "nbk7" become equal.
PETZVAL_API std::string bare(std::string_view name);
/// True if two names are equal after bare().
PETZVAL_API bool same_bare(std::string_view a, std::string_view b) noexcept;

/// Up to five names in the tables that differ from a name by a few letters, for messages: "N-BK7, K-BK7".
PETZVAL_API std::string similar_names(const GlassCatalogue& glasses, std::string_view name);

}  // namespace petzval::glass_detail
