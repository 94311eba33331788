// SPDX-License-Identifier: Apache-2.0
// Prints published numbers of other programs and the numbers of petzval as Markdown tables: lib/docs/other_programs.md.
#include <exception>
#include <iostream>

#include "comparisons.hpp"

int main() {
  try {
    for (const petzval::testing::NamedTable& table : petzval::testing::comparison_tables()) {
      std::cout << petzval::testing::markdown(table.compute()) << '\n';
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
