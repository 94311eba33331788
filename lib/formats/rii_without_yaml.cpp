// SPDX-License-Identifier: Apache-2.0
#include "glass_reader.hpp"

namespace petzval::formats_detail {

void read_rii(std::string, const std::string&, GlassReader& reader) {
  reader.refuse(1, "a page of refractiveindex.info",
                "an .agf or a glass table: this library was built without yaml-cpp (PETZVAL_WITH_YAML)");
}

}  // namespace petzval::formats_detail
