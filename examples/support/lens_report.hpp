// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files.hpp"
#include "load_lens.hpp"
#include "petzval/lint/lint.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace examples {

/// One number of the report: its key in JSON, its label and unit in the table.
struct Entry {
  const char* key;
  const char* label;
  const char* unit;
  double value;
};

/// First-order data of a lens in one meridian.
struct MeridianReport {
  petzval::Meridian meridian;
  petzval::FirstOrder first_order;
  std::optional<petzval::Pupils> pupils;  ///< absent if nothing limits the beam
  std::vector<Entry> entries;
};

struct Report {
  LoadedLens loaded;
  std::vector<MeridianReport> meridians;  ///< the main one first; a lens of revolution has one
  std::vector<petzval::Finding> findings;

  const MeridianReport& main() const { return meridians.front(); }
};

Report report(LoadedLens loaded);

Json to_json(const Report& report);
std::string to_text(const Report& report);

/// "y-z" or "x-z".
const char* section_name(petzval::Meridian meridian);
/// "surface 5", with a remark if it is inferred.
std::string stop_in_words(const std::optional<petzval::Pupils>& pupils);
/// Four decimals; scientific notation for very small and large numbers.
std::string in_words(double value);

}  // namespace examples
