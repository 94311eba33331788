// SPDX-License-Identifier: Apache-2.0
// Compares rays with the 60-digit rays of tests/reference/make_rays.py, whose formulas are independent of the library.
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <fstream>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "../digits.hpp"
#include "../report.hpp"
#include "batches.hpp"

namespace reference_test {

using petzval::Ray;
using petzval::TracedRay;
using petzval::Travel;

struct Row {
  int line;
  std::string lens, fate;
  Travel travel;
  std::array<double, 6> in, out;
  int surface;
};

double parsed(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::vector<Row> rows() {
  std::ifstream file(std::string(PETZVAL_TEST_REFERENCE) + "/rays.csv");
  std::vector<Row> result;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.starts_with('#') || line.starts_with("lens,")) continue;
    std::vector<std::string> cells;
    std::istringstream cut(line);
    for (std::string cell; std::getline(cut, cell, ',');) cells.push_back(cell);
    if (cells.size() != 16) return {};
    Row row{number, cells[0], cells[8],           cells[1] == "to_film" ? Travel::to_film : Travel::to_scene,
            {},     {},       std::stoi(cells[9])};
    for (std::size_t i = 0; i < 6; ++i) {
      row.in[i] = parsed(cells[2 + i]);
      row.out[i] = parsed(cells[10 + i]);
    }
    result.push_back(row);
  }
  return result;
}

template <class T>
class ReferenceRays : public testing::Test {
 public:
  static constexpr double bound = std::is_same_v<T, float> ? 1e-5 : 1e-13;
};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(ReferenceRays, Plain);

/// Compares the end of a ray with its row and updates the largest error.
template <class T>
void judge(const TracedRay<T>& end, const Row& row, double size, double bound, double& worst, const std::string& how) {
  ASSERT_EQ(name(end.fate), row.fate) << "rays.csv:" << row.line << " " << how;
  ASSERT_EQ(end.surface, row.surface) << "rays.csv:" << row.line << " " << how;
  const std::array<T, 6> out{end.ray.origin.x,    end.ray.origin.y,    end.ray.origin.z,
                             end.ray.direction.x, end.ray.direction.y, end.ray.direction.z};
  // Errors of positions are relative to the size of the lens, or to the distance from the axis if larger; errors of
  // directions are absolute.
  const double scale = std::max(size, std::hypot(row.out[0], row.out[1]));
  for (std::size_t i = 0; i < 6; ++i) {
    const double error = std::abs(static_cast<double>(out[i]) - row.out[i]) / (i < 3 ? scale : 1);
    EXPECT_LE(error, bound) << "rays.csv:" << row.line << " column " << i << " " << how;
    worst = std::max(worst, error);
  }
}

TYPED_TEST(ReferenceRays, EqualTheReference) {
  using T = TypeParam;
  const auto reference = rows();
  ASSERT_GT(reference.size(), 600u);
  std::map<std::string, testing_lenses::Sample> lenses;
  double one = 0, fast = 0, reproducible = 0;
  for (const Row& row : reference) {
    const auto& sample = lenses.contains(row.lens)
                             ? lenses.at(row.lens)
                             : lenses.emplace(row.lens, testing_lenses::load(row.lens)).first->second;
    const auto& in = row.in;
    const Ray<T> ray{{static_cast<T>(in[0]), static_cast<T>(in[1]), static_cast<T>(in[2])},
                     {static_cast<T>(in[3]), static_cast<T>(in[4]), static_cast<T>(in[5])}};
    judge(petzval::trace(sample.lens, ray, {.travel = row.travel}), row, sample.size, this->bound, one, "one ray");
    for (const auto& options : testing_batches::every_batch(row.travel)) {
      TracedRay<T> end;
      petzval::trace<T>(sample.lens, std::span(&ray, 1), &end, options);
      ASSERT_EQ(name(end.fate), row.fate) << "rays.csv:" << row.line << " " << testing_batches::text(options);
      if (!end.transmitted()) continue;  // returned unchanged
      judge(end, row, sample.size, this->bound, options.arithmetic == petzval::Arithmetic::fast ? fast : reproducible,
            testing_batches::text(options));
    }
  }
  const std::string what = "rays of 14 lenses against 60-digit references, relative";
  const std::string limit = petzval::testing::digits(this->bound);
  testing_report::put(what, testing_report::one_ray<T>, one, limit);
  testing_report::put(what, testing_report::batch<T>,
                      petzval::testing::digits(fast, 2) + " / " + petzval::testing::digits(reproducible, 2), limit);
}

}  // namespace reference_test
