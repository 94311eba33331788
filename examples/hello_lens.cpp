// SPDX-License-Identifier: Apache-2.0
// The program of README.md: loads a lens, prints its focal length and f-number, traces a ray and focuses at 1 m.
//
//   hello_lens
#include <iostream>
#include <petzval/petzval.hpp>

int main() {
  using namespace petzval;
  const Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f1.35.json"));
  std::cout << lens.name() << "\nfocal length " << first_order(lens).effective_focal_length << " mm, f/"
            << real_f_number(lens) << '\n';
  const auto traced = trace(lens, Ray<double>{{0, 20, -50}, {0, 0, 1}});
  std::cout << "ray at 20 mm: " << name(traced.fate) << " at y = " << traced.ray.origin.y << " mm\n";
  const Lens focused = with_focus(lens, 1000);  // mm, from the front vertex
  std::cout << "at 1 m the film moves back " << focused.film_z() - lens.film_z() << " mm\n";
}
