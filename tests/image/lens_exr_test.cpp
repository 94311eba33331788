// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/exr.hpp"

#include <ImathBox.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../exports/distorting_lenses.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace lens_exr_test {

using testing::data_lens;
using testing::data_prescription;
using testing::small_film;

/// A temporary file for the test.
struct TemporaryFile {
  std::filesystem::path path;

  explicit TemporaryFile(const std::string& name) : path(std::filesystem::path(::testing::TempDir()) / name) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path); }
};

TEST(LensExr, HasStandardAttributesWithTypesAndUnits) {
  const Prescription p = data_prescription("biogon_35mm_f2.8");
  const Lens lens =
      with_focus(with_coating(compile(p), Coating::quarter_wave()), 2000, {.origin = DistanceOrigin::film});
  const LensDistortion distortion(Camera(lens, small_film(36), {.model = ModelKind::exact_double}));
  const LensState state = lens_state(distortion);
  LensIdentity identity = identity_of(p);
  identity.make = "maker";
  ExrPart part{.width = 2, .height = 1, .channels = {{"R", {1, 2}}}};
  part.numbers["other"] = 0.1;
  add_lens_attributes(part, distortion, identity);
  const TemporaryFile file("lens_attributes.exr");
  write_exr({&part, 1}, file.path);

  Imf::MultiPartInputFile read(file.path.string().c_str());
  const Imf::Header& header = read.header(0);
  ASSERT_TRUE(Imf::hasFocus(header) && Imf::hasAperture(header));
  EXPECT_NEAR(Imf::focus(header), 2, 1e-6);  // metres
  EXPECT_NEAR(Imf::aperture(header), real_f_number(lens), 1e-6);
  const auto number = [&](const char* name) {
    return double{header.typedAttribute<Imf::FloatAttribute>(name).value()};
  };
  EXPECT_NEAR(number("nominalFocalLength"), p.focal_length_mm.value(), 1e-5);
  EXPECT_NEAR(number("effectiveFocalLength"), first_order(lens).effective_focal_length, 1e-5);
  EXPECT_NEAR(number("pinholeFocalLength"), distortion.pinhole().focal_length_mm.x, 1e-5);
  EXPECT_NEAR(number("entrancePupilOffset"), lens.film_z() - pupils(lens).entrance.z, 1e-5);  // mm
  EXPECT_NEAR(number("tStop"), state.t_number.value(), 1e-6);
  EXPECT_EQ(header.typedAttribute<Imf::V2fAttribute>("sensorOverallDimensions").value(), Imath::V2f(36, 24));

  const ExrPart again = read_exr_parts(file.path).front();
  EXPECT_EQ(again.texts.at("lensMake"), "maker");
  EXPECT_EQ(again.texts.at("lensModel"), p.name);
  EXPECT_FALSE(again.texts.contains("lensSerialNumber"));
  EXPECT_EQ(again.numbers.at("other"), 0.1);  // as a double
  EXPECT_EQ(again.pairs, part.pairs);
}

const std::vector<float>& channel(const ExrPart& part, const std::string& name) { return part.channels.at(name); }

/// The raster position that a pixel of a part shows; (0, 0) is the upper left corner of the film.
Vec2<double> shown(const ExrPart& part, const Film& film, int column, int row) {
  const std::size_t i = static_cast<std::size_t>(row + part.margin_y) * static_cast<std::size_t>(part.width) +
                        static_cast<std::size_t>(column + part.margin_x);
  return {double{channel(part, "R")[i]} * film.columns, (1 - double{channel(part, "G")[i]}) * film.rows};
}

TEST(StMapExr, RoundTrips) {
  const Film film = small_film(36);
  const TemporaryFile file("lens.stmap.exr");
  const Lens lens = data_lens("zoom_14-30mm_f4:wide");
  write_st_map(lens, film, {.model = "zoom"}, file.path);
  const std::vector<ExrPart> parts = read_exr_parts(file.path);
  ASSERT_EQ(parts.size(), 2u);
  const ExrPart &undistort = parts[0], &redistort = parts[1];
  EXPECT_EQ(undistort.name, "undistort");
  EXPECT_EQ(redistort.name, "redistort");
  EXPECT_EQ(redistort.width, film.columns);
  EXPECT_EQ(redistort.margin_x, 0);
  EXPECT_EQ(undistort.width, film.columns + 2 * undistort.margin_x);
  EXPECT_GT(undistort.margin_x, 10);
  EXPECT_NEAR(undistort.numbers.at("overscan"), 1.0 * undistort.width / film.columns, 0.02);
  EXPECT_EQ(undistort.texts.at("lensModel"), "zoom");

  Imf::MultiPartInputFile read(file.path.string().c_str());
  EXPECT_EQ(read.header(0).displayWindow(), Imath::Box2i({0, 0}, {film.columns - 1, film.rows - 1}));
  EXPECT_EQ(read.header(0).dataWindow().min, Imath::V2i(-undistort.margin_x, -undistort.margin_y));

  double worst = 0;
  int compared = 0;
  for (int row = 0; row < film.rows; row += 5) {
    for (int column = 0; column < film.columns; column += 5) {
      // Bilinear interpolation at the position in the first map.
      const Vec2<double> at = shown(redistort, film, column, row) - 0.5;
      const int left = static_cast<int>(std::floor(at.x)), top = static_cast<int>(std::floor(at.y));
      if (left < -undistort.margin_x || left + 1 >= film.columns + undistort.margin_x) continue;
      if (top < -undistort.margin_y || top + 1 >= film.rows + undistort.margin_y) continue;
      const double x = at.x - left, y = at.y - top;
      const Vec2<double> back =
          (1 - y) * ((1 - x) * shown(undistort, film, left, top) + x * shown(undistort, film, left + 1, top)) +
          y * ((1 - x) * shown(undistort, film, left, top + 1) + x * shown(undistort, film, left + 1, top + 1));
      worst = std::max(worst, std::hypot(back.x - column - 0.5, back.y - row - 0.5));
      ++compared;
    }
  }
  EXPECT_GT(compared, 6000);
  EXPECT_LT(worst, 0.005);  // pixels
}

TEST(StMapExr, IsUpright) {
  const Film film = small_film(36);
  const LensDistortion distortion(Camera(data_lens("zoom_14-30mm_f4:wide"), film, {.model = ModelKind::exact_double}));
  const auto parts = to_exr_parts(st_maps(distortion), distortion);
  // Barrel distortion: the corner of the distorted image shows a point outside the pinhole image, to the upper left.
  const Vec2<double> corner = shown(parts[1], film, 0, 0);
  EXPECT_LT(corner.x, 0);
  EXPECT_LT(corner.y, 0);
  EXPECT_LT(channel(parts[1], "R").front(), 0);
  EXPECT_GT(channel(parts[1], "G").front(), 1);
}

}  // namespace lens_exr_test
}  // namespace petzval
