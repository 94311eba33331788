// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval {

/// An assumption, change or omission of an importer.
struct ImportWarning {
  int line = 0;           ///< line of the file, from 1; 0: the whole file
  std::string command{};  ///< the word of the file that the warning refers to
  std::string message{};  ///< a single line

  bool operator==(const ImportWarning&) const = default;
};

/// The file of another program from which a prescription was read.
struct FileOrigin {
  std::string format{};      ///< "zemax", "codev", "oslo", "opticalbench", "flaresim", "table", "lentil", "optiland"
  std::string file{};        ///< file name without folders
  std::string units = "mm";  ///< unit of length in the file: "mm", "cm", "in" or "m"; a prescription is in mm
  std::string title{};
  std::vector<std::string> notes{};
  std::vector<ImportWarning> warnings{};
  std::string entry{};  ///< key of the lens in a file with several lenses; otherwise empty

  bool operator==(const FileOrigin&) const = default;
};

}  // namespace petzval
