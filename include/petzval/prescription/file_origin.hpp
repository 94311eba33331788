// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval {

/// What an importer assumed, changed or left out.
struct ImportWarning {
  int line = 0;           ///< of the file, from 1; 0: the file as a whole
  std::string command{};  ///< the word of the file that it is about
  std::string message{};  ///< one line

  bool operator==(const ImportWarning&) const = default;
};

/// The file of another program from which a prescription was read.
struct FileOrigin {
  std::string format{};      ///< "zemax", "codev", "oslo", "opticalbench", "flaresim", "table", "lentil", "optiland"
  std::string file{};        ///< its name without folders
  std::string units = "mm";  ///< of its lengths: "mm", "cm", "in" or "m"; those of the prescription are mm
  std::string title{};
  std::vector<std::string> notes{};
  std::vector<ImportWarning> warnings{};
  std::string entry{};  ///< the lens of a file that holds several, by its key; else empty

  bool operator==(const FileOrigin&) const = default;
};

}  // namespace petzval
