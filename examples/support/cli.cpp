// SPDX-License-Identifier: Apache-2.0
#include "cli.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <span>
#include <sstream>
#include <system_error>
#include <utility>

#include "interrupt.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/glass/glass.hpp"
#include "suggest.hpp"
#include "text.hpp"

namespace examples {
namespace {

std::string joined(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + number(value);
  return text;
}

bool quiet = false;
std::uint32_t thread_count = 0;  // 0: one per processor
std::string example, help_topic, command_line;
CommandText* description_wanted = nullptr;

std::string list_of(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : ",") + value;
  return text;
}

/// True for a terminal, unless the environment variable NO_COLOR is set.
bool coloured(int file) { return isatty(file) == 1 && !std::getenv("NO_COLOR"); }

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

Option* Option::required(bool value) { return option_->required(value), this; }
Option* Option::type_name(const std::string& name) { return option_->type_name(name), this; }
Option* Option::default_str(const std::string& text) { return option_->default_str(text), this; }
Option* Option::capture_default_str() { return option_->capture_default_str(), this; }
Option* Option::delimiter(char between) { return option_->delimiter(between), this; }
Option* Option::one_of(const std::vector<std::string>& values) {
  const auto check = [values](const std::string& value) -> std::string {
    if (std::ranges::find(values, value) != values.end()) return "";
    const std::string near = nearest(value, values);
    return '"' + value + "\"; must be one of " + list_of(values) + (near.empty() ? "" : "; did you mean " + near + "?");
  };
  option_->check(CLI::Validator(check, "{" + list_of(values) + "}"));
  return this;
}
Option* Option::needs(Option* other) { return option_->needs(other->option_), this; }
Option* Option::excludes(const std::string& other) { return option_->excludes(other), this; }
bool Option::given() const { return option_->count() > 0; }

App::App(const std::string& description, const std::string& name)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_help_flag("-h,--help", "print this help");
  app_->add_flag("--quiet", quiet, "no notes and no progress on standard error");
}
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
Option* App::add_option(const std::string& name, const std::function<void(const std::vector<std::string>&)>& set,
                        const std::string& help) {
  return kept(app_->add_option_function<std::vector<std::string>>(name, set, help));
}
Option* App::add_flag(const std::string& name, bool& value, const std::string& help) {
  return kept(app_->add_flag(name, value, help));
}
Option* App::get_option(const std::string& name) {
  CLI::Option* const option = app_->get_option_no_throw(name);
  return option ? kept(option) : nullptr;
}
std::vector<std::string> App::values(const std::string& name) const {
  const CLI::Option* const option = app_->get_option_no_throw(name);
  return option ? option->results() : std::vector<std::string>();
}

void App::want_other_files(const std::string& flag, const std::string& file) const {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return;
  for (const CLI::Option* option : app_->get_options()) {
    if (option->get_name() == flag) continue;
    for (const std::string& value : option->results()) {
      if (!std::filesystem::equivalent(file, value, error)) continue;
      throw petzval::Error(flag + " = " + file + ": is also the file of " + option->get_name() +
                           "; must be another file, because the input would be lost");
    }
  }
}

Option* App::kept(CLI::Option* option) {
  options_.push_back(Option(option));
  return &options_.back();
}

namespace {

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Parses a comma-separated list. Throws for a repeated number, because numbers name results: one would overwrite
/// another.
template <class Parse>
std::vector<double> parse_list(const std::string& where, std::string_view text, const Parse& parse) {
  std::vector<double> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    values.push_back(parse(without_blanks(text.substr(begin, end - begin))));
    begin = end + 1;
  }
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end()) {
    throw petzval::Error(where + ": " + number(*twice) + " occurs twice; numbers must differ");
  }
  return values;
}

/// @throws petzval::Error  if the folder is not writable or cannot be created
void want_folder(const std::string& flag, const std::filesystem::path& folder) {
  const auto refuse = [&](const std::string& why) {
    throw petzval::Error(flag + " = " + folder.string() + ": cannot create the folder: " + why);
  };
  if (folder.empty()) refuse("it has no name");
  std::error_code error;
  std::filesystem::path existing_folder = folder;
  while (!std::filesystem::exists(existing_folder, error)) {
    if (error) refuse(error.message());
    const std::filesystem::path above = existing_folder.parent_path();
    existing_folder = above.empty() || above == existing_folder ? std::filesystem::path(".") : above;
  }
  if (!std::filesystem::is_directory(existing_folder, error)) refuse(existing_folder.string() + " is a file");
  if (access(existing_folder.c_str(), W_OK | X_OK) != 0) refuse(existing_folder.string() + ": " + std::strerror(errno));
}

/// @throws petzval::Error  if the file cannot be created
void want_file(const std::string& flag, const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    throw petzval::Error(flag + " = " + file.string() + ": cannot write the file: " + why);
  };
  std::error_code error;
  if (file.empty()) refuse("it has no name");
  if (!std::filesystem::exists(file, error) && error) refuse(error.message());
  if (std::filesystem::is_directory(file, error)) refuse("it is a folder");
  if (std::filesystem::is_other(file, error)) return;  // a device or a pipe
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, error)) refuse(folder.string() + " is not a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse(folder.string() + ": " + std::strerror(errno));
}

/// Parses a wavelength in nm: a number or the letter of a spectral line.
double parse_wavelength(const std::string& where, std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool letter = !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0;
  if (!letter || end == text.data() + text.size()) {
    return parse_number(where, text, {10, 1e5, "a number of nm from 10 to 100000, without a unit"});  // including "inf"
  }
  try {
    return petzval::spectral_line_nm(text);
  } catch (const petzval::Error& unknown) {
    throw petzval::Error(where + " = " + std::string(text) + ": " + unknown.what());
  }
}

}  // namespace

namespace {

/// A number followed by one of the units, each with its factor.
double parse_quantity(const std::string& where, std::string_view text, const Range& range,
                      std::span<const std::pair<std::string_view, double>> units) {
  double value = 0;
  if (where.ends_with("f-number") && (text.starts_with("f/") || text.starts_with("F/"))) text.remove_prefix(2);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
  bool read = error == std::errc() && unit.empty();
  for (const auto& [name, factor] : units) {
    if (error == std::errc() && unit == name) read = true, value *= factor;
  }
  if (!read || !(value >= range.least && value <= range.most)) {
    throw petzval::Error(where + " = \"" + std::string(text) + "\"; must be " + range.words +
                         (units.size() > 2 ? " (mm, or with a unit: um, mm, cm, m, km, in, ft)" : ""));
  }
  return value;
}

}  // namespace

double parse_number(const std::string& where, std::string_view text, const Range& range) {
  static constexpr std::pair<std::string_view, double> degrees[]{{"deg", 1}, {"°", 1}};
  const std::string_view rule = range.words;
  const bool angle = rule.find("angle") != rule.npos || rule.find("degrees") != rule.npos;
  return parse_quantity(where, text, range, angle ? degrees : std::span(degrees).first(0));
}

double parse_length(const std::string& where, std::string_view text, const Range& range) {
  static constexpr std::pair<std::string_view, double> units[]{{"um", 1e-3}, {"mm", 1},    {"cm", 10},   {"m", 1e3},
                                                               {"km", 1e6},  {"in", 25.4}, {"ft", 304.8}};
  return parse_quantity(where, text, range, units);
}

std::vector<double> parse_numbers(const std::string& where, std::string_view text, const Range& range) {
  return parse_list(where, text, [&](std::string_view item) { return parse_number(where, item, range); });
}

std::vector<double> parse_wavelengths(const std::string& where, std::string_view text) {
  if (text == "rgb") return {petzval::rgb_triple_nm.rbegin(), petzval::rgb_triple_nm.rend()};  // ascending
  constexpr std::string_view visible = "visible", stepped = "visible:";
  if (text == visible || text.starts_with(stepped)) {
    const double step =
        text == visible ? 10 : parse_number(where, text.substr(stepped.size()), {1, 60, "visible:STEP of 1 to 60 nm"});
    std::vector<double> values;
    for (int k = 0; 430 + k * step <= 670; ++k) values.push_back(430 + k * step);
    return values;
  }
  return parse_list(where, text, [&](std::string_view item) { return parse_wavelength(where, item); });
}

namespace {

/// Adds an option whose text `parse` turns into the value.
template <class Value, class Parse>
Option* add_parsed(App& app, const std::string& flag, Value& value, const std::string& type_name,
                   const std::string& default_text, const std::string& help, Parse parse) {
  return app
      .add_option(
          flag, [&value, parse](const std::string& text) { value = parse(text); }, help)
      ->type_name(type_name)
      ->default_str(default_text);
}

}  // namespace

Option* add_number(App& app, const std::string& flag, double& value, const Range& range, const std::string& help) {
  return add_parsed(app, flag, value, "NUMBER", number(value), help,
                    [=](const std::string& text) { return parse_number(flag, text, range); });
}

Option* add_number(App& app, const std::string& flag, std::optional<double>& value, const Range& range,
                   const std::string& help) {
  return add_parsed(app, flag, value, "NUMBER", "", help,
                    [=](const std::string& text) { return parse_number(flag, text, range); });
}

Option* add_angle(App& app, const std::string& flag, double& radians, const Range& range, const std::string& help) {
  return add_parsed(app, flag, radians, "NUMBER", number(exact_degrees(radians)), help,
                    [=](const std::string& text) { return petzval::radians(parse_number(flag, text, range)); });
}

double exact_degrees(double radians) {
  const double near = petzval::degrees(radians);
  const double rounded = std::round(1e9 * near) / 1e9;  // the angle of most command lines
  for (const double candidate : {rounded, near, std::nextafter(near, -1e9), std::nextafter(near, 1e9)}) {
    if (petzval::radians(candidate) == radians) return candidate;
  }
  return near;
}

Option* add_numbers(App& app, const std::string& flag, std::vector<double>& values, const Range& range,
                    const std::string& help) {
  return add_parsed(app, flag, values, "NUMBER,...", joined(values), help,
                    [=](const std::string& text) { return parse_numbers(flag, text, range); });
}

Option* add_length(App& app, const std::string& flag, double& value, const Range& range, const std::string& help) {
  return add_parsed(app, flag, value, "LENGTH", number(value), help,
                    [=](const std::string& text) { return parse_length(flag, text, range); });
}

Option* add_lengths(App& app, const std::string& flag, std::vector<double>& values, const Range& range,
                    const std::string& help) {
  return add_parsed(app, flag, values, "LENGTH,...", joined(values), help, [=](const std::string& text) {
    return parse_list(flag, text, [&](std::string_view item) { return parse_length(flag, item, range); });
  });
}

Option* add_threads(App& app) {
  return add_count(app, "--threads", thread_count, {1, 1024, "a whole number from 1 to 1024"},
                   "number of threads; results do not depend on it")
      ->default_str("one per processor");
}

int threads() { return thread_count > 0 ? static_cast<int>(thread_count) : petzval::processor_threads(); }

std::map<std::string, std::string> parameters() {
  return {{"Software", "petzval " PETZVAL_VERSION}, {"command", command_line}};
}

void set_help(std::string text, std::string topic) { example = std::move(text), help_topic = std::move(topic); }

CommandText described(int (*command)(int, char**), std::string name) {
  CommandText result;
  description_wanted = &result;
  char* arguments[]{name.data(), nullptr};
  command(1, arguments);
  description_wanted = nullptr;
  return result;
}

Option* add_wavelengths(App& app, const std::string& flag, std::vector<double>& values, const std::string& help) {
  return add_parsed(app, flag, values, "NM,...", joined(values),
                    help +
                        " (nm, spectral lines like F,d,C, or visible or rgb); visible: 430 to 670 nm in steps of 10, "
                        "visible:2 in steps of 2; "
                        "rgb: 475, 510, 650",
                    [=](const std::string& text) { return parse_wavelengths(flag, text); });
}

Option* add_wavelength(App& app, const std::string& flag, double& value, const std::string& help) {
  return add_parsed(app, flag, value, "NM", number(value), help + " (nm, or a spectral line like F)",
                    [=](const std::string& text) { return parse_wavelength(flag, text); });
}

Option* add_out_folder(App& app, std::string& folder, const std::string& help, const std::string& flag) {
  Option* out = app.add_option(flag, folder, help)->type_name("DIR");
  app.add_check([out, &folder, flag] {
    if (!out->given()) return;
    want_folder(flag, folder);
    clean_on_signals(folder, false);
  });
  return out;
}

Option* add_out_file(App& app, std::string& file, const std::string& help, const std::string& type_name,
                     const std::string& flag) {
  Option* out = app.add_option(flag, file, help)->type_name(type_name);
  app.add_check([&app, out, &file, flag] {
    if (!out->given()) return;
    want_file(flag, file);
    app.want_other_files(flag, file);
    clean_on_signals(std::filesystem::absolute(file).parent_path(), false);
  });
  return out;
}

std::string in_words(petzval::DistanceOrigin origin) {
  std::string words(name(origin));
  std::replace(words.begin(), words.end(), '_', ' ');
  return origin == petzval::DistanceOrigin::front_principal ? words + " plane" : words;
}

Option* add_distance_origin(App& app, petzval::DistanceOrigin& origin) {
  return add_choice(app, "--from", origin, distance_origins,
                    "origin of all distances; they are positive towards the scene", names(distance_origins));
}

void add_focus(App& app, petzval::FocusOptions& focus) {
  add_distance_origin(app, focus.origin);
  add_criterion(app, focus.criterion);
}

Option* add_film_choice(App& app, std::string& film, const std::string& default_words) {
  return app
      .add_option("--film-position", film,
                  "position of the film: file (as in the lens file) or focus (the subject is in focus by --criterion)")
      ->one_of({"file", "focus"})
      ->default_str(default_words);
}

void note(const std::string& text) {
  static std::set<std::string> said;
  if (!quiet && said.insert(text).second) std::cerr << "note: " << text << '\n';
}

namespace {

constexpr const char* criterion_help =
    "meaning of \"in focus\", on the axis unless fields are given: thin or paraxial (cardinal points of the thin or "
    "the thick lens), min_rms or min_max (exact rays: smallest RMS blur or smallest maximum blur)";

}  // namespace

Option* add_criterion(App& app, petzval::FocusCriterion& criterion, const std::vector<std::string>& allowed) {
  return add_choice(app, "--criterion", criterion, focus_criteria, criterion_help, allowed);
}

Option* add_criteria(App& app, std::vector<std::string>& criteria) {
  return app.add_option("--criterion", criteria, criterion_help)
      ->delimiter(',')
      ->one_of(names(focus_criteria))
      ->capture_default_str();
}

namespace {

template <class Count>
Option* add_whole(App& app, const std::string& flag, Count& value, const Range& range, const std::string& help) {
  return add_parsed(app, flag, value, "N", std::to_string(value), help, [=](const std::string& text) {
    const double number = parse_number(flag, text, range);
    if (number != std::floor(number)) throw petzval::Error(flag + " = \"" + text + "\"; must be " + range.words);
    return static_cast<Count>(number);
  });
}

}  // namespace

Option* add_count(App& app, const std::string& flag, std::uint32_t& value, const Range& range,
                  const std::string& help) {
  return add_whole(app, flag, value, range, help);
}
Option* add_count(App& app, const std::string& flag, int& value, const Range& range, const std::string& help) {
  return add_whole(app, flag, value, range, help);
}

Option* add_samples(App& app, std::uint32_t& samples) {
  return add_count(app, "--rays", samples, {1, 1u << 26, "a whole number from 1 to 67108864"},
                   "rays per wavelength, 1 to 67108864");
}

namespace {

/// The texts of a command line.
CommandText text_of(const CLI::App& app) {
  CommandText text;
  text.description = app.get_description(), text.usage = app.get_name(), text.example = example;
  for (const CLI::Option* option : app.get_options()) {
    OptionText line;
    line.flag = option->get_name(false, true);  // "-h,--help"
    line.flag.erase(0, line.flag.find(',') + 1);
    line.positional = option->get_positional();
    line.type = option->get_type_name();
    if (const std::size_t values = line.type.find(":{"); values != std::string::npos) {
      std::istringstream list(line.type.substr(values + 2, line.type.size() - values - 3));
      for (std::string value; std::getline(list, value, ',');) line.values.push_back(value);
    }
    line.help = option->get_description();
    line.default_text = option->get_default_str();
    if (line.default_text.starts_with('['))
      line.default_text = line.default_text.substr(1, line.default_text.size() - 2);
    line.required = option->get_required();
    line.several = option->get_expected_max() > 1;
    if (line.positional) {
      const std::string name = line.flag + (line.several ? "..." : "");
      text.usage += line.required ? ' ' + name : " [" + name + ']';
    }
    text.options.push_back(line);
  }
  text.usage += " [options]";
  return text;
}

/// The words of a command line that determine the results: without --out and the options that change only the work.
std::string words_of_results(int argc, char** argv) {
  std::string words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quiet" || word == "--resume" || word.starts_with("--out=")) continue;
    if (word == "--out" || word == "--threads") {
      ++i;
      continue;
    }
    words += word.find(' ') == std::string::npos ? ' ' + word : " '" + word + '\'';
  }
  return words;
}

}  // namespace

int run(App& app, int argc, char** argv, const std::function<void()>& body) {
  const auto fail = [&app](const char* what) {
    hide_progress();
    const bool red = coloured(STDERR_FILENO);
    std::cerr << (red ? "\033[31m" : "") << app.app_->get_name() << ": " << one_line(what) << (red ? "\033[0m" : "")
              << '\n';
    return 1;
  };
  if (description_wanted) return *description_wanted = text_of(*app.app_), 0;
  command_line = app.app_->get_name() + words_of_results(argc, argv);
  try {
    app.app_->parse(argc, argv);
    const bool resumes = app.app_->get_option_no_throw("--resume") != nullptr;
    end_on_signals(std::string("note: interrupted") + (resumes ? "; the same command with --resume continues" : ""));
    if (!quiet) show_progress(app.app_->get_name());
    for (const auto& check : app.checks_) check();
    body();
    hide_progress();
    std::cout.flush();
    return std::cout ? 0 : fail("cannot write to standard output");
  } catch (const CLI::Success&) {
    try {
      print_help(std::cout, text_of(*app.app_), help_topic, coloured(STDOUT_FILENO));
    } catch (const petzval::Error& unknown) {
      return fail(unknown.what());
    }
    return 0;
  } catch (const CLI::ParseError& error) {
    // A mistyped flag comes before its consequences: missing or surplus arguments.
    std::vector<std::string> extras = app.app_->remaining();
    std::stable_partition(extras.begin(), extras.end(), [](const std::string& word) { return word.starts_with('-'); });
    const bool mistyped = !extras.empty() && extras.front().starts_with('-');
    if (!mistyped && !dynamic_cast<const CLI::ExtrasError*>(&error)) return fail(error.what());
    if (!extras.empty() && !extras.front().starts_with('-')) {
      return fail(('"' + extras.front() + "\": the command has all its arguments (see --help)").c_str());
    }
    std::vector<std::string> flags;
    for (const CLI::Option* option : app.app_->get_options()) {
      if (!option->get_positional()) flags.push_back(option->get_name());
    }
    const std::string near = extras.empty() ? "" : nearest_flag(extras.front(), flags);
    return fail(((extras.empty() ? "an argument" : extras.front()) + ": must be an option of this command" +
                 (near.empty() ? " (see --help)" : "; did you mean " + near + "?"))
                    .c_str());
  } catch (const std::exception& error) {
    return fail(app.words_(error.what()).c_str());
  }
}

}  // namespace examples
