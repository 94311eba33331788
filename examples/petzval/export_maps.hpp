// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "petzval/analysis/calibration.hpp"

namespace commands {

/// Writes the two tables of Omniverse as EXR files of 32-bit float.
void write_omniverse(const petzval::OmniverseTables& tables, const std::filesystem::path& enter,
                     const std::filesystem::path& exit);

}  // namespace commands
