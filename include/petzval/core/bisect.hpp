// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace petzval::detail {

/// The last parameter with a property, between one that has it and one that has not: bisection down to neighbouring
/// doubles.
template <class Property>
double last_with(double with, double without, const Property& property) {
  for (;;) {
    const double middle = with + (without - with) / 2;
    if (middle == with || middle == without) return with;
    (property(middle) ? with : without) = middle;
  }
}

}  // namespace petzval::detail
