// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "help.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "progress.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Shared code of the example programs; not part of the library.
namespace examples {

/// Valid range of a number on the command line. NaN is outside every range.
struct Range {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  const char* words = "a finite number";
};
inline constexpr Range finite_number{};
inline constexpr Range positive_length{std::numeric_limits<double>::min(), std::numeric_limits<double>::infinity(),
                                       "a number above 0, or inf"};
inline constexpr Range field_angle{-180, 180, "a number of degrees from -180 to 180"};
inline constexpr Range positive_number{std::numeric_limits<double>::min(), std::numeric_limits<double>::max(),
                                       "a finite number above 0"};

/// Parses the whole text as one decimal number, independent of the locale.
/// @throws petzval::Error that begins with `where`, if the text is not a number in the range
double parse_number(const std::string& where, std::string_view text, const Range& range);

/// Like parse_number() for a length in mm, or with a unit: um, mm, cm, m, km, in or ft ("3m").
double parse_length(const std::string& where, std::string_view text, const Range& range);

/// Parses "10", "0,10,20" or "0, 10, 20".
/// @throws petzval::Error that begins with `where`, if a number is invalid or repeated
std::vector<double> parse_numbers(const std::string& where, std::string_view text, const Range& range);

/// Like parse_numbers() for wavelengths in nm; letters are spectral lines: "F,d,C", "486.1, e".
/// "visible": 430 to 670 nm in steps of 10 nm; "rgb": 475, 510 and 650 nm.
std::vector<double> parse_wavelengths(const std::string& where, std::string_view text);

/// An option of a command line. Functions return the option itself. CLI11 stays in cli.cpp: it takes seconds to
/// compile.
class Option {
 public:
  Option* required(bool value = true);
  Option* type_name(const std::string& name);
  Option* default_str(const std::string& text);
  Option* capture_default_str();
  Option* delimiter(char between);
  Option* one_of(const std::vector<std::string>& values);
  Option* needs(Option* other);
  Option* excludes(const std::string& other);
  bool given() const;

 private:
  friend class App;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

/// The command line of a program: its --help text and its options.
class App {
 public:
  App(const std::string& description, const std::string& name);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  Option* add_option(const std::string& name, std::string& value, const std::string& help);
  Option* add_option(const std::string& name, std::vector<std::string>& values, const std::string& help);
  Option* add_option(const std::string& name, const std::function<void(const std::string&)>& set,
                     const std::string& help);
  Option* add_option(const std::string& name, const std::function<void(const std::vector<std::string>&)>& set,
                     const std::string& help);
  Option* add_flag(const std::string& name, bool& value, const std::string& help);
  /// The option of a name; null if no option has it.
  Option* get_option(const std::string& name);
  /// The values of an option on the command line; empty if it is not given or does not exist.
  std::vector<std::string> values(const std::string& name) const;
  bool given(const std::string& name) const { return !values(name).empty(); }
  /// @throws petzval::Error  if an existing file is the value of an option other than `flag`
  void want_other_files(const std::string& flag, const std::string& file) const;
  /// Adds a check that run() makes before the body.
  void add_check(std::function<void()> check) { checks_.push_back(std::move(check)); }
  /// Sets a function that run() applies to the messages of errors.
  void set_words(std::function<std::string(const std::string&)> words) { words_ = std::move(words); }

 private:
  friend int run(App& app, int argc, char** argv, const std::function<void()>& body);
  Option* kept(CLI::Option* option);

  std::unique_ptr<CLI::App> app_;
  std::deque<Option> options_;
  std::vector<std::function<void()>> checks_;
  std::function<std::string(const std::string&)> words_ = [](const std::string& message) { return message; };
};

/// Runs work and returns its result. Adds the flag to the message of a petzval::Error unless the message begins with a
/// flag.
template <class Work>
auto for_flag(const std::string& flag, const Work& work) {
  try {
    return work();
  } catch (const petzval::Error& error) {
    const std::string message = error.what();
    throw petzval::Error(message.starts_with("--") ? message : flag + ": " + message);
  }
}

/// Add options read by the functions above. --help shows the value of the variable as the default.
Option* add_number(App& app, const std::string& flag, double& value, const Range& range, const std::string& help);
Option* add_number(App& app, const std::string& flag, std::optional<double>& value, const Range& range,
                   const std::string& help);
Option* add_numbers(App& app, const std::string& flag, std::vector<double>& values, const Range& range,
                    const std::string& help);

/// Adds an angle in degrees for a value in radians.
Option* add_angle(App& app, const std::string& flag, double& radians, const Range& range, const std::string& help);
/// The degrees of an angle that give the same double in radians.
double exact_degrees(double radians);

/// Add lengths in mm, with or without a unit.
Option* add_length(App& app, const std::string& flag, double& value, const Range& range, const std::string& help);
Option* add_lengths(App& app, const std::string& flag, std::vector<double>& values, const Range& range,
                    const std::string& help);

/// Add wavelengths in nm, as numbers or spectral lines.
Option* add_wavelength(App& app, const std::string& flag, double& value, const std::string& help);
Option* add_wavelengths(App& app, const std::string& flag, std::vector<double>& values, const std::string& help);

/// Add --out, the folder or file for results. run() checks that the path can be written before the body starts.
Option* add_out_folder(App& app, std::string& folder, const std::string& help = "folder for the results",
                       const std::string& flag = "--out");
Option* add_out_file(App& app, std::string& file, const std::string& help, const std::string& type_name,
                     const std::string& flag = "--out");

/// Adds --threads: the number of threads that threads() returns.
Option* add_threads(App& app);
/// The number of --threads, else one thread per processor.
int threads();

/// The program with its version, and the command line of run() without --out and --threads, as attributes of
/// pictures.
std::map<std::string, std::string> parameters();

/// Sets the example and the topic of the help of the command that runs next; see print_help().
void set_help(std::string example, std::string topic = "");

/// Runs a command that calls run(), and returns its texts instead of the work.
CommandText described(int (*command)(int, char**), std::string name);

/// Adds a whole number. The ends of the range are whole numbers of at least 0.
Option* add_count(App& app, const std::string& flag, std::uint32_t& value, const Range& range, const std::string& help);
Option* add_count(App& app, const std::string& flag, int& value, const Range& range, const std::string& help);

/// The focus criteria and the origins of distances.
inline constexpr std::array focus_criteria{petzval::FocusCriterion::thin, petzval::FocusCriterion::paraxial,
                                           petzval::FocusCriterion::min_rms, petzval::FocusCriterion::min_max};
inline constexpr std::array distance_origins{petzval::DistanceOrigin::front_vertex, petzval::DistanceOrigin::film,
                                             petzval::DistanceOrigin::entrance_pupil,
                                             petzval::DistanceOrigin::front_principal};

template <class Enum, std::size_t count>
std::vector<std::string> names(const std::array<Enum, count>& all) {
  std::vector<std::string> result;
  for (const Enum e : all) result.emplace_back(name(e));
  return result;
}

/// The enumerator with the given name, which must exist.
template <class Enum, std::size_t count>
Enum named(const std::string& text, const std::array<Enum, count>& all) {
  return *std::find_if(all.begin(), all.end(), [&](Enum e) { return name(e) == text; });
}

/// Adds an option for an enumerator by its name, which must be in `allowed`.
template <class Enum, std::size_t count>
Option* add_choice(App& app, const std::string& flag, Enum& value, const std::array<Enum, count>& all,
                   const std::string& help, const std::vector<std::string>& allowed) {
  return app
      .add_option(
          flag, [&value, all](const std::string& text) { value = named(text, all); }, help)
      ->one_of(allowed)
      ->default_str(std::string(name(value)));
}

/// Adds --from, for all distances of a program.
Option* add_distance_origin(App& app, petzval::DistanceOrigin& origin);

/// Adds --criterion: the meaning of "in focus", by one name or by several names separated by commas. --help shows the
/// value of the variable as the default.
Option* add_criterion(App& app, petzval::FocusCriterion& criterion,
                      const std::vector<std::string>& allowed = names(focus_criteria));
Option* add_criteria(App& app, std::vector<std::string>& criteria);

/// Adds --from and --criterion.
void add_focus(App& app, petzval::FocusOptions& focus);

/// Adds --film: "file" for the film position of the lens file, "focus" for the position that focuses the subject.
/// default_words: the default in words.
Option* add_film_choice(App& app, std::string& film, const std::string& default_words);

/// "front vertex", "film", "entrance pupil" or "front principal plane".
std::string in_words(petzval::DistanceOrigin origin);
inline std::string in_words(petzval::FocusCriterion criterion) { return std::string(name(criterion)); }

/// Prints "note: TEXT" on standard error, each text once.
void note(const std::string& text);

/// Adds --rays: rays per wavelength, 1 to 2^26.
Option* add_samples(App& app, std::uint32_t& samples);

/// Reads the command line and runs the body. Returns the exit status: 0, or 1 after one line with the reason on
/// standard error.
int run(App& app, int argc, char** argv, const std::function<void()>& body);

}  // namespace examples
