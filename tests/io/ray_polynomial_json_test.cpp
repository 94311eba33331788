// SPDX-License-Identifier: Apache-2.0
#include "io/ray_polynomial_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "../positioned.hpp"

namespace petzval {
namespace ray_polynomial_json_test {

using testing::expect_error;
using testing::expect_tokens;
using testing::message;
using testing::positioned;

RayPolynomial polynomial(int degree, std::size_t wavelengths, bool mirrors = false) {
  RayPolynomial::Domain domain{.space = {.film_z = 100.1, .pupil_z = -20.25},
                               .film_radius = 21.6,
                               .pupil_shift = -0.1,
                               .pupil_radius = 1.0 / 3,
                               .reference_z = 1e-5};
  if (mirrors) domain.along_x = {0.3, 1.0 / 7};
  const std::size_t terms =
      mirrors ? 2 * RayPolynomial::mirror_terms(degree).size() : RayPolynomial::terms(degree).size();
  std::vector<RayPolynomial::Fit> fits(wavelengths);
  double x = 0.1;
  for (RayPolynomial::Fit& fit : fits) {
    fit = {.wavelength_nm = 400 + x, .rms_rad = 1e-7 * x, .max_rad = 3e-7 * x, .rms_mm = 1e-5, .max_mm = 0};
    for (auto* list : {&fit.direction_by_film, &fit.direction_by_pupil, &fit.offset_by_film, &fit.offset_by_pupil}) {
      for (std::size_t k = 0; k < terms; ++k) {
        x = std::fmod(3.7 * x * (1 - x) + 1e-3, 1);
        list->push_back(std::pow(x - 0.5, 7) * (k % 5 == 0 ? 1e9 : 1));
      }
    }
  }
  return RayPolynomial(degree, domain, fits);
}

std::string bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The text of a valid file with one part replaced.
std::string with(const std::string& part, const std::string& instead) {
  std::string text = format_ray_polynomial(polynomial(3, 2));
  const auto at = text.rfind(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), instead);
}

std::string why(const std::string& text) {
  return message([&] { parse_ray_polynomial(text, "x.json"); });
}

/// Checks that a text is refused with line and column, followed by these words.
void expect_refused(const std::string& text, std::initializer_list<std::string_view> words,
                    std::string_view position = {}, int line = __builtin_LINE()) {
  const auto result = positioned(why(text), "x.json", words, position);
  if (!result) ADD_FAILURE_AT(__FILE__, line) << result.message();
}

TEST(RayPolynomialJson, RoundTripsToTheByte) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "ray_polynomial_json_test.json";
  for (const int n : {3, 5, 7, 9, 11, -3, -7, -11}) {  // negative: with mirror symmetry
    const int degree = std::abs(n);
    const RayPolynomial written = polynomial(degree, 3, n < 0);
    write_ray_polynomial(written, file);
    const std::string text = bytes(file);
    const RayPolynomial read = read_ray_polynomial(file);
    write_ray_polynomial(read, file);
    EXPECT_EQ(bytes(file), text);

    EXPECT_EQ(read.degree(), degree);
    const auto &a = read.domain(), &b = written.domain();
    EXPECT_EQ(a.space.film_z, b.space.film_z);
    EXPECT_EQ(a.space.pupil_z, b.space.pupil_z);
    EXPECT_EQ(a.film_radius, b.film_radius);
    EXPECT_EQ(a.pupil_shift, b.pupil_shift);
    EXPECT_EQ(a.pupil_radius, b.pupil_radius);
    EXPECT_EQ(a.reference_z, b.reference_z);
    ASSERT_EQ(a.along_x.has_value(), n < 0);
    if (n < 0) {
      EXPECT_EQ(a.along_x->pupil_shift, b.along_x->pupil_shift);
      EXPECT_EQ(a.along_x->pupil_radius, b.along_x->pupil_radius);
    }
    ASSERT_EQ(read.fits().size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto &c = read.fits()[i], &d = written.fits()[i];
      EXPECT_EQ(c.wavelength_nm, d.wavelength_nm);
      EXPECT_EQ(c.rms_rad, d.rms_rad);
      EXPECT_EQ(c.max_rad, d.max_rad);
      EXPECT_EQ(c.rms_mm, d.rms_mm);
      EXPECT_EQ(c.max_mm, d.max_mm);
      EXPECT_EQ(c.direction_by_film, d.direction_by_film);
      EXPECT_EQ(c.direction_by_pupil, d.direction_by_pupil);
      EXPECT_EQ(c.offset_by_film, d.offset_by_film);
      EXPECT_EQ(c.offset_by_pupil, d.offset_by_pupil);
    }
  }
  std::filesystem::remove(file);
}

TEST(RayPolynomialJson, RefusesInvalidFilesWithPosition) {
  const std::string format = "\"format\": \"petzval-ray-polynomial 1\"";
  expect_refused(with(format, "\"format\": \"petzval-lens 1\""), {"format", "\"petzval-lens 1\""});
  expect_refused(with(format + ",", ""), {"\"format\"", "missing"});
  expect_tokens(why(with("\"degree\": 3", "\"degree\": 4")), {"x.json", "degree", 4});
  expect_refused(with("\"degree\": 3", "\"degree\": 3.5"), {"degree", "3.5"});
  expect_refused(with("\"degree\": 3", "\"degree\": 1e300"), {"degree", "1e+300"});
  expect_tokens(why(with("\"degree\": 3", "\"degree\": 5")), {"x.json", "fit 0", "direction_by_film", 4, 10, 5});
  expect_refused(with("\"degree\": 3", "\"power\": 3"), {"\"power\""});
  expect_refused(with("\"degree\": 3", "\"pupil_shift_x\": 0.0, \"degree\": 3"), {"\"pupil_radius_x_mm\"", "missing"});
  expect_tokens(why(with("\"degree\": 3", "\"pupil_shift_x\": 0.0, \"pupil_radius_x_mm\": 2.0, \"degree\": 3")),
                {"x.json", "fit 0", "direction_by_film", 4, 12, 3});
  expect_refused(with("\"degree\": 3", "\"degree\": 3, \"degree\": 3"), {"\"degree\""});
  expect_refused(with("\"degree\": 3", "\"degree\": [3]"), {"degree", "a list"});
  expect_refused(with("\"degree\": 3", "\"degree\": \"3\""), {"degree", "\"3\""});
  expect_refused(with("\"film_z_mm\": 100.1", "\"film_z_mm\": null"), {"film_z_mm", "null"});
  expect_refused(with("\"film_z_mm\": 100.1", "\"film_z_mm\": 1e-999"), {"film_z_mm", "1e-999"});
  expect_tokens(why(with("\"film_radius_mm\": 21.6", "\"film_radius_mm\": -1.0")), {"x.json", "film_radius", -1});
  expect_refused(with("\"rms_mm\": ", "\"rms_um\": "), {"fit 1", "\"rms_um\""});
  expect_refused(with("\"max_mm\": 0.0,", ""), {"fit 1", "\"max_mm\"", "missing"});
  expect_refused(with("\"max_mm\": 0.0,", "\"max_mm\": true,"), {"fit 1", "max_mm", "true"});
  expect_refused(with("\"offset_by_film\": [", "\"offset_by_film\": [\"a\", "), {"fit 1", "offset_by_film", "\"a\""});
  expect_refused(with("\"offset_by_film\": [", "\"offset_by_film\": [["), {"fit 1", "offset_by_film", "a list"});
  expect_refused(with("\"offset_by_film\": [", "\"offset_by_film\": [{"), {"fit 1", "offset_by_film", "an object"});
  expect_refused(with("\"fits\": [", "\"fits\": [1, "), {"fits", "1"});
  expect_refused(with("\"fits\": [", "\"fits\": [[], "), {"fits", "a list"});
  expect_refused("[]", {"a list"});
  expect_refused("{}", {"\"format\"", "missing"});
  expect_refused("3", {"3"});
  expect_refused("", {"JSON"}, "1:1");
  expect_tokens(why(with("\n}\n", "")), {"JSON"});
  expect_refused(std::string("{\0}", 3), {"UTF-8"}, "1:2");
  expect_error([] { read_ray_polynomial("/nowhere/x.json"); }, {"/nowhere/x.json", "No such file"});
}

TEST(RayPolynomialJson, RefusesLargeFiles) {
  std::string numbers;
  for (int i = 0; i < 400; ++i) numbers += "1.0, ";
  expect_refused(with("\"offset_by_film\": [", "\"offset_by_film\": [" + numbers), {"fit 1", "offset_by_film", "392"});
  expect_tokens(why(std::string(1'000'000, '[')), {"x.json"});
  std::string one = format_ray_polynomial(polynomial(3, 1));
  const auto from = one.rfind("    {"), to = one.rfind("\n  ]");
  const std::string fit = one.substr(from, to - from);
  std::string fits;
  for (int i = 0; i < 10'000; ++i) fits += fit + ",\n";
  expect_tokens(why(one.insert(from, fits)), {"x.json", 10000, "fits"});
}

TEST(RayPolynomialJson, EveryCutAndEveryLostByteIsRefusedOrReads) {
  const std::string text = format_ray_polynomial(polynomial(3, 1));
  for (std::size_t i = 0; i < text.size(); ++i) {
    EXPECT_EQ(why(text.substr(0, i)) == "no error", i + 1 == text.size()) << i;
    const std::string found = why(text.substr(0, i) + text.substr(i + 1));
    EXPECT_TRUE(found == "no error" || found.starts_with("x.json")) << found;
  }
}

}  // namespace ray_polynomial_json_test
}  // namespace petzval
