// SPDX-License-Identifier: Apache-2.0
#include "trace_report.hpp"

#include <algorithm>
#include <cstdio>

namespace {

std::string rounds(const Result& r) {
  return digits(r.ns()) + " [" + digits(1e9 * r.times.median()) + ", " + digits(1e9 * r.times.max()) + "]";
}

void print_heading(const Row& row) {
  std::printf("\n%s, %zu surfaces, ray set %s", row.bench->name.c_str(), row.bench->lens.surface_count(),
              row.rays.c_str());
  if (row.rays == "mix") std::printf(" (%.1f %% reach the scene)", 100 * row.set->passing);
  std::printf(
      "\n\n"
      "| code          | isa      | precision | mode         | ns per ray: min [median, max] | per surface "
      "| x textbook | error, rad: rms | max     |\n"
      "|---------------|----------|-----------|--------------|------------------------------:|------------:"
      "|-----------:|----------------:|--------:|\n");
}

void print_line(const Result& r) {
  std::printf("| %-13s | %-8s | %-9s | %-12s | %29s | %11s | %10s | %14.2e%c | %.1e |\n", r.row.code.c_str(),
              petzval::name(r.row.isa).data(), r.row.precision(), petzval::name(r.row.mode).data(), rounds(r).c_str(),
              digits(r.ns() / r.surfaces(), 3).c_str(), r.textbook ? digits(*r.ratio(), 3).c_str() : "", r.error.rms,
              r.less_exact() ? '*' : ' ', r.error.max);
}

}  // namespace

std::string Row::name() const {
  std::string result = bench->id;
  for (const std::string_view part : {std::string_view(rays), std::string_view(code), petzval::name(isa),
                                      std::string_view(precision()), petzval::name(mode)}) {
    result += '/';
    result += part;
  }
  return result;
}

std::optional<double> Result::ratio() const {
  if (!textbook) return {};
  return textbook->times.min() / times.min();
}

bool Result::less_exact() const {
  return textbook && (error.rms > textbook->error.rms || error.max > textbook->error.max);
}

void print_results(const std::vector<Result>& results) {
  const Result* before = nullptr;
  for (const Result& r : results) {
    if (!before || !r.row.beside(before->row)) print_heading(r.row);
    print_line(r);
    before = &r;
  }
  const auto any = [&](const auto& what) { return std::any_of(results.begin(), results.end(), what); };
  if (any([](const Result& r) { return r.less_exact(); })) {
    std::printf("\n* larger error than the textbook tracer (rms or maximum).\n");
  } else if (any([](const Result& r) { return r.textbook != nullptr; })) {
    std::printf("\nNo row has a larger direction error than the textbook tracer.\n");
  }
}

void print_kinds(const std::vector<Result>& results) {
  if (results.empty()) return;
  std::printf(
      "\nLenses of 11 equal surfaces, every ray passes, batch, fast, %s\n\n"
      "| surfaces | precision | ns per ray: min [median, max] | per surface | x sphere |\n"
      "|----------|-----------|------------------------------:|------------:|---------:|\n",
      petzval::name(results.front().row.isa).data());
  for (const Result& r : results) {
    const auto sphere = std::find_if(results.begin(), results.end(),
                                     [&](const Result& s) { return s.row.in_double == r.row.in_double; });
    std::printf("| %-8s | %-9s | %29s | %11s | %8s |\n", r.row.bench->name.c_str(), r.row.precision(),
                rounds(r).c_str(), digits(r.ns() / r.surfaces(), 3).c_str(), digits(r.ns() / sphere->ns(), 3).c_str());
  }
}
