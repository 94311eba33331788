// SPDX-License-Identifier: Apache-2.0
#include "cli.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
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

Option* Option::required() { return option_->required(), this; }
Option* Option::type_name(const std::string& name) { return option_->type_name(name), this; }
Option* Option::default_str(const std::string& text) { return option_->default_str(text), this; }
Option* Option::capture_default_str() { return option_->capture_default_str(), this; }
Option* Option::delimiter(char between) { return option_->delimiter(between), this; }
Option* Option::one_of(const std::vector<std::string>& values) { return option_->check(CLI::IsMember(values)), this; }
Option* Option::needs(Option* other) { return option_->needs(other->option_), this; }
Option* Option::excludes(const std::string& other) { return option_->excludes(other), this; }
bool Option::given() const { return option_->count() > 0; }

App::App(const std::string& description, const std::string& name)
    : app_(std::make_unique<CLI::App>(description, name)) {}
App::~App() = default;

Option* App::add_option(const std::string& name, std::string& value, const std::string& help) {
  return kept(app_->add_option(name, value, help));
}
Option* App::add_option(const std::string& name, std::vector<std::string>& values, const std::string& help) {
  return kept(app_->add_option(name, values, help));
}
Option* App::add_option(const std::string& name, const std::function<void(const std::string&)>& set,
                        const std::string& help) {
  return kept(app_->add_option_function<std::string>(name, set, help));
}
Option* App::add_flag(const std::string& name, bool& value, const std::string& help) {
  return kept(app_->add_flag(name, value, help));
}
Option* App::get_option(const std::string& name) { return kept(app_->get_option(name)); }

Option* App::kept(CLI::Option* option) {
  options_.push_back(Option(option));
  return &options_.back();
}

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

Option* add_number(App& app, const std::string& flag, double& value, const Range& range, const std::string& help) {
  return app
      .add_option(
          flag, [&value, flag, range](const std::string& text) { value = parse_number(flag, text, range); }, help)
      ->type_name("NUMBER")
      ->default_str(number(value));
}

Option* add_numbers(App& app, const std::string& flag, std::vector<double>& values, const Range& range,
                    const std::string& help) {
  return app
      .add_option(
          flag, [&values, flag, range](const std::string& text) { values = parse_numbers(flag, text, range); }, help)
      ->type_name("NUMBER,...")
      ->default_str(joined(values));
}

Option* add_criterion(App& app, std::string& criterion) {
  return app
      .add_option("--criterion", criterion,
                  "criterion of focus, on axis: cardinal points (of a thin or the thick lens), least RMS blur or least "
                  "largest blur")
      ->one_of(names(focus_criteria))
      ->capture_default_str();
}

Option* add_count(App& app, const std::string& flag, std::uint32_t& value, const Range& range,
                  const std::string& help) {
  return app
      .add_option(
          flag,
          [&value, flag, range](const std::string& text) {
            const double number = parse_number(flag, text, range);
            value = static_cast<std::uint32_t>(number);
            if (value != number) throw petzval::Error(flag + ": found \"" + text + "\", wanted " + range.words);
          },
          help)
      ->type_name("N")
      ->default_str(std::to_string(value));
}

Option* add_samples(App& app, std::uint32_t& samples) {
  return add_count(app, "--samples", samples, {1, 1u << 26, "a whole number from 1 to 67108864"},
                   "rays per wavelength, 1 to 67108864");
}

int run(App& app, int argc, char** argv, const std::function<void()>& body) {
  const auto fail = [&app](const char* what) {
    std::cerr << app.app_->get_name() << ": " << one_line(what) << '\n';
    return 1;
  };
  try {
    app.app_->parse(argc, argv);
    body();
    std::cout.flush();
    return std::cout ? 0 : fail("cannot write to standard output");
  } catch (const CLI::Success& help) {
    return app.app_->exit(help);
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
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
  const std::size_t done = begun_++;
  if (!shown_) return;
  std::cerr << "\r\033[K" << title_ << ' ' << begun_ << '/' << steps_ << ": " << what;
  if (done > 0) {
    const double seconds = spent.count() / static_cast<double>(done) * static_cast<double>(steps_ - done);
    std::cerr << ", " << (seconds < 100 ? number(std::ceil(seconds)) + " s" : number(std::ceil(seconds / 60)) + " min")
              << " left";
  }
  std::cerr << std::flush;
}

}  // namespace examples
