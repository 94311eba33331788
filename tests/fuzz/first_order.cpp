// SPDX-License-Identifier: Apache-2.0
// Any lens: first-order data may be infinite, but never NaN.
#include "petzval/paraxial/first_order.hpp"

#include <initializer_list>

#include "laws.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"
#include "wild_lens.hpp"

namespace {

using namespace petzval;

void numbers(std::initializer_list<double> values, const char* law) {
  for (const double value : values) fuzz::require(!std::isnan(value), law);
}

void cardinal_points(const Lens& lens, Meridian meridian) {
  const FirstOrder f = first_order(lens, {}, meridian);
  numbers({f.power, f.effective_focal_length, f.front_focal_z, f.rear_focal_z, f.front_principal_z, f.rear_principal_z,
           f.front_nodal_z, f.rear_nodal_z, f.front_focal_distance, f.back_focal_distance, f.petzval_sum},
          "first-order data are not NaN");
  fuzz::require(f.afocal == (f.power == 0), "an afocal lens has power 0");
}

void ideal(const Lens& lens, fuzz::Bytes& bytes) {
  const IdealLens thick = thick_lens(lens);
  const Vec3<double> place{bytes.number(-500, 500), bytes.number(-500, 500), bytes.number(-1e4, 0)};
  const auto image = thick.image({place});
  if (!image) return;
  numbers(
      {image->position.x, image->position.y, image->position.z, image->slope_x, image->slope_y, image->diameter_per_mm},
      "an image contains no NaN");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const Lens lens = fuzz::wild_lens(bytes);
    for (const Meridian meridian : {Meridian::y, Meridian::x}) {
      cardinal_points(lens, meridian);
      const double object = bytes.number(-1e4, 100);
      if (!std::isnan(object))
        numbers({paraxial_image_z(lens, object, {}, meridian)}, "the position of a paraxial image is not NaN");
      fuzz::done([&] {
        const Pupils p = pupils(lens, {}, meridian);
        numbers({p.entrance.z, p.entrance.diameter, p.exit.z, p.exit.diameter}, "pupils contain no NaN");
        fuzz::require(p.stop < lens.surface_count(), "the stop is a surface");
      });
    }
    fuzz::done([&] { ideal(lens, bytes); });
    fuzz::done([&] { numbers({paraxial_f_number(lens), film_side_f_number(lens)}, "f-numbers are not NaN"); });
    fuzz::done([&] { fuzz::require(real_f_number(lens) >= 0, "an f-number is 0 or more"); });
    fuzz::done([&] {
      const double wanted = bytes.between(0.5, 64), found = real_f_number(with_f_number(lens, wanted));
      fuzz::require(std::abs(found - wanted) <= 0.006 * wanted, "a lens has the f-number that it is set to");
    });
  });
  return 0;
}
