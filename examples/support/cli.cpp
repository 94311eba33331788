// SPDX-License-Identifier: Apache-2.0
#include "cli.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <iostream>
#include <memory>

#include "petzval/core/error.hpp"
#include "text.hpp"

namespace examples {
namespace {

std::string joined(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + number(value);
  return text;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

double parse_number(const std::string& where, std::string_view text, const Range& range) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool read = error == std::errc() && end == text.data() + text.size();
  if (!read || !(value >= range.least && value <= range.most)) {
    throw petzval::Error(where + ": found \"" + std::string(text) + "\", wanted " + range.words);
  }
  return value;
}

std::vector<double> parse_numbers(const std::string& where, std::string_view text, const Range& range) {
  std::vector<double> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    values.push_back(parse_number(where, text.substr(begin, end - begin), range));
    begin = end + 1;
  }
  // These numbers name results: a repeated one would overwrite a result.
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end()) {
    throw petzval::Error(where + ": found " + number(*twice) + " twice, wanted every number once");
  }
  return values;
}

CLI::Option* add_number(CLI::App& app, const std::string& flag, double& value, const Range& range,
                        const std::string& help) {
  return app
      .add_option_function<std::string>(
          flag, [&value, flag, range](const std::string& text) { value = parse_number(flag, text, range); }, help)
      ->type_name("NUMBER")
      ->default_str(number(value));
}

CLI::Option* add_numbers(CLI::App& app, const std::string& flag, std::vector<double>& values, const Range& range,
                         const std::string& help) {
  return app
      .add_option_function<std::string>(
          flag, [&values, flag, range](const std::string& text) { values = parse_numbers(flag, text, range); }, help)
      ->type_name("NUMBER,...")
      ->default_str(joined(values));
}

CLI::Option* add_samples(CLI::App& app, std::uint32_t& samples) {
  return app
      .add_option_function<std::string>(
          "--samples",
          [&samples](const std::string& text) {
            constexpr Range range{1, 1u << 26, "a whole number from 1 to 67108864"};
            const double value = parse_number("--samples", text, range);
            samples = static_cast<std::uint32_t>(value);
            if (samples != value) throw petzval::Error("--samples: found \"" + text + "\", wanted " + range.words);
          },
          "rays per wavelength, 1 to 67108864")
      ->type_name("N")
      ->default_str(std::to_string(samples));
}

int run(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
  const auto fail = [&app](const char* what) {
    std::cerr << app.get_name() << ": " << one_line(what) << '\n';
    return 1;
  };
  try {
    app.parse(argc, argv);
    body();
    std::cout.flush();
    return std::cout ? 0 : fail("cannot write to standard output");
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

Progress::Progress(std::string title, std::size_t steps)
    : title_(std::move(title)), steps_(steps), shown_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::cerr << "\r\033[K";
}

void Progress::step(const std::string& what) {
  ++done_;
  if (shown_) std::cerr << "\r\033[K" << title_ << ' ' << done_ << '/' << steps_ << ": " << what << std::flush;
}

}  // namespace examples
