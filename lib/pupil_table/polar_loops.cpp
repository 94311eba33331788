// SPDX-License-Identifier: Apache-2.0
// Samples of the pupils of lenses of revolution, compiled once for each instruction set.
#include "lens/look_up.hpp"
#include "polygon_blocks.hpp"
#include "polygon_loops.hpp"

namespace petzval::pupil_table_detail {

const PolarLoops PETZVAL_LOOPS{
    {{sample<1, float>, areas<1, float>}, {sample<1, double>, areas<1, double>}, sample_one<1, double>},
    lens_detail::find_nearest};

}  // namespace petzval::pupil_table_detail
