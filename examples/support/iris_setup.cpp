// SPDX-License-Identifier: Apache-2.0
#include "iris_setup.hpp"

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {

petzval::Iris IrisSetup::iris() const {
  return {.blades = static_cast<int>(blades), .roundness = roundness, .rotation_rad = petzval::radians(rotation_deg)};
}

double IrisSetup::f_number_by_corners() const {
  return area == "equal" ? petzval::equal_area_f_number(iris(), f_number) : f_number;
}

void add_iris(App& app, IrisSetup& setup) {
  add_number(app, "--f-number", setup.f_number, positive_number, "f-number to stop the lens down to (by exact rays)")
      ->default_str("wide open");
  add_iris_shape(app, setup);
}

void add_iris_shape(App& app, IrisSetup& setup) {
  constexpr Range blades{0, 20, "3 to 20, or 0 for a round iris"};
  add_count(app, "--blades", setup.blades, blades, "blades of the iris, 3 to 20; 0: round");
  add_number(app, "--roundness", setup.roundness, {-1, 1, "a number from -1 to 1"},
             "edges of the blades; 0: straight; 1: round; below 0: hollow");
  add_number(app, "--iris-rotation", setup.rotation_deg, finite_number,
             "rotation of the first corner from straight up (degrees); anticlockwise seen from behind the camera");
  app.add_option("--iris-area", setup.area,
                 "meaning of the f-number with blades. circumscribed: their corners lie on the round iris; equal: they "
                 "pass as much light as the round iris")
      ->one_of({"circumscribed", "equal"})
      ->capture_default_str();
}

petzval::Lens stopped_to(const petzval::Lens& lens, double f_number, const std::string& flag) {
  // Lens names are rounded: an "f/1.8" lens may open only to f/1.85.
  constexpr double name_tolerance = 1.04, rounding_tolerance = 1.005;
  const double fastest = f_number > 0 ? petzval::fastest_f_number(lens) : 0;
  if (!(f_number < fastest && fastest <= name_tolerance * f_number)) {
    return for_flag(flag, [&] { return petzval::with_f_number(lens, f_number); });
  }
  if (fastest > rounding_tolerance * f_number) {
    note(lens.name() + ": " + flag + " = " + number(f_number) + ": the lens opens to f/" + number(fastest, 4) +
         ", which is used");
  }
  return petzval::with_f_number(lens, fastest);
}

petzval::Lens stopped_down(const petzval::Lens& lens, const IrisSetup& setup) {
  if (setup.blades == 0) {
    const auto refuse = [](const std::string& found, const std::string& why) {
      throw petzval::Error(found + " needs --blades: a round iris has " + why);
    };
    if (setup.roundness != 0) refuse("--roundness", "no edges");
    if (setup.rotation_deg != 0) refuse("--iris-rotation", "no corners");
    if (setup.area == "equal") refuse("--iris-area = equal", "only one area");
  }
  const petzval::Lens shaped = for_flag("--blades", [&] { return petzval::with_iris(lens, setup.iris()); });
  if (setup.f_number > 0) return stopped_to(shaped, setup.f_number_by_corners(), setup.f_number_flag);
  if (setup.area == "equal" && !setup.iris().round()) {
    throw petzval::Error("--iris-area = equal needs " + setup.f_number_flag +
                         ": wide open, blades cannot open further");
  }
  return shaped;
}

}  // namespace examples
