// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "petzval/trace/trace.hpp"
#include "table.hpp"
#include "trace_rays.hpp"
#include "trace_work.hpp"

/// A row of the tables. Scalar codes are IEEE code compiled for the baseline.
struct Row {
  const BenchLens* bench;
  const RaySet* set;
  std::string rays, code;
  bool in_double;
  petzval::InstructionSet isa = petzval::InstructionSet::baseline;
  petzval::Arithmetic mode = petzval::Arithmetic::reproducible;
  std::function<std::unique_ptr<Work>()> make{};

  const char* precision() const { return in_double ? "double" : "float"; }
  std::string name() const;
  /// True if both rows have the same lens and rays.
  bool beside(const Row& other) const { return bench == other.bench && rays == other.rays; }
};

/// Errors of directions against long double, over rays that pass in both; rad.
struct DirectionError {
  double rms = 0, max = 0;
};

/// The results of a row.
struct Result {
  Row row;
  Rounds::Line times;
  DirectionError error;
  const Result* textbook = nullptr;  ///< on the same rays, if measured

  double surfaces() const { return static_cast<double>(row.bench->lens.surface_count()); }
  double ns() const { return 1e9 * times.min(); }
  std::optional<double> ratio() const;
  bool less_exact() const;
};

/// A table in Markdown for each lens and set of rays.
void print_results(const std::vector<Result>& results);

/// Lenses of one kind of surface each, the first of them spheres, as a table in Markdown.
void print_kinds(const std::vector<Result>& results);
