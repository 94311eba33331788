// SPDX-License-Identifier: Apache-2.0
#include "help.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "petzval/core/error.hpp"

namespace examples {
namespace {

/// A heading of the help and its flags. The short help of a command with many options gives only the names of the flags
/// of a brief group.
struct Group {
  std::string_view title;
  bool brief;
  std::string_view flags;
};
constexpr std::array all_groups{
    Group{"Scene", false, " --scene --image --deep --depth --table --points --keys --balls --light "},
    Group{"Lens", false, " --thin-lens --singlet --model --budget --f-number --blades "},
    Group{"Focus", false,
          " --focus --at --fields --from --criterion --film-position --defocus --tilt --swing --max-tilt --fit-tilt "
          "--robust --blur --points "},
    Group{"Picture", false,
          " --film --fov --size --width --columns --title --white-point --normalisation --exposure --frames --fps "
          "--travel "},
    Group{"Work", false,
          " --integrator --diffraction --film-reflectance --wavelengths --spp --rays --noise --time --compare "},
    Group{"Window", false, " --replay --log --panels --screenshot "},
    Group{"Output", false,
          " --out --camera --all --calibration --ray-map --povray --format --json --check --strict --repair "
          "--precision --surfaces-from "},
    Group{"Quality", true,
          " --lens-samples --half --tolerance --layers --jitter --supersample --highlights-above --compare-rays "
          "--pairs --ghosts --starburst "},
    Group{"Depths", true,
          " --part --holdout --holdout-part --depth-kind --depth-unit --near --far --contrast --white "},
    Group{"Files", true,
          " --deep-out --pair-layers --setup --glasses --configuration --embodiment --coatings --match-glasses "
          "--ignore-apertures "},
    Group{"Iris", true,
          " --roundness --iris-rotation --iris-area --iris-image --lens-ratio --rate-of-change --keep-light "
          "--weight-distribution --weight-strength --weight-map "},
    Group{"Aberrations", true, " --power-spline --curvature-points --dispersion --from-lens --kind --beta "},
    Group{"Running", true, " --seed --shard --resume --threads --quiet --help "},
};
constexpr std::size_t many_options = 20;

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// The first part of a text, up to a semicolon, a colon or the end of a sentence.
std::string_view first_part(std::string_view text) {
  std::size_t end = text.size();
  for (const std::string_view mark : {"; ", ": ", ". ", "\n"}) end = std::min(end, text.find(mark));
  text = text.substr(0, end);
  if (text.ends_with('.')) text.remove_suffix(1);
  return text;
}

std::string joined(std::span<const std::string> words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : between).append(word);
  return text;
}

/// Prints a text in lines of at most 100 columns that begin with `indent` blanks; the first continues a line at
/// `column`.
void print_wrapped(std::ostream& out, std::string_view text, std::size_t indent, std::size_t column) {
  constexpr std::size_t width = 100;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    if (column > indent && column + 1 + end > width) out << '\n', column = 0;
    if (column == 0) {
      out << std::string(indent, ' '), column = indent;
    } else if (column > indent) {
      out << ' ', ++column;
    }
    out << text.substr(0, end), column += end;
    if (end < text.size() && text[end] == '\n') out << '\n', column = 0;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  out << '\n';
}

constexpr std::size_t short_list = 20;

/// "--model NAME", "--wavelengths d|rgb".
std::string spelled(const OptionText& option) {
  const std::string values = joined(option.values, "|");
  const std::string type = values.empty() ? option.type : values.size() <= short_list ? values : "NAME";
  if (option.positional) return option.flag;
  return option.flag + (type.empty() ? "" : ' ' + type);
}

void print_option(std::ostream& out, const OptionText& option, bool whole) {
  constexpr std::size_t indent = 26;
  const std::string name = "  " + spelled(option);
  out << name;
  const bool fits = name.size() + 2 <= indent;
  out << (fits ? std::string(indent - name.size(), ' ') : "\n" + std::string(indent, ' '));
  std::string text(whole ? std::string_view(option.help) : first_part(option.help));
  const bool listed = spelled(option).find('|') != std::string::npos;
  const std::string values = joined(option.values, ", ");
  if (!listed && !values.empty() && (whole || values.size() <= 3 * short_list)) text += ": " + values;
  if (option.required) {
    text += " (required)";
  } else if (!option.default_text.empty()) {
    text += " [" + option.default_text + ']';
  }
  print_wrapped(out, text, indent, indent);
}

}  // namespace

std::string_view help_group(std::string_view flag) {
  if (!flag.starts_with('-')) return "Arguments";
  for (const Group& group : all_groups) {
    if (group.flags.find(' ' + std::string(flag) + ' ') != std::string_view::npos) return group.title;
  }
  return "Other";
}

void print_help(std::ostream& out, const CommandText& command, std::string_view topic, bool colours) {
  const auto heading = [&](std::string_view title) -> std::ostream& {
    return out << (colours ? "\033[1m" : "") << title << (colours ? "\033[0m" : "");
  };
  const auto members = [&](std::string_view title) {
    std::vector<const OptionText*> found;
    for (const OptionText& option : command.options) {
      if (help_group(option.flag) == title) found.push_back(&option);
    }
    return found;
  };
  std::vector<std::string> brief;
  std::vector<std::string_view> titles{"Arguments"};
  for (const Group& group : all_groups) titles.push_back(group.title);
  titles.push_back("Other");
  const bool every = topic == "all";
  if (!topic.empty() && !every) {
    std::vector<std::string> known;
    for (const std::string_view title : titles) {
      const auto options = members(title);
      if (options.empty()) continue;
      known.push_back(lower(title));
      if (known.back() != lower(topic)) continue;
      for (const OptionText* option : options) print_option(out, *option, true);
      return;
    }
    throw petzval::Error("help topic = \"" + std::string(topic) + "\"; must be all, " + joined(known, ", "));
  }
  if (every) {
    print_wrapped(out, command.description, 0, 0);
  } else {
    print_wrapped(out, std::string(first_part(command.description)) + '.', 0, 0);
  }
  heading("Usage:") << ' ' << command.usage << '\n';
  for (const std::string_view title : titles) {
    const auto options = members(title);
    if (options.empty()) continue;
    const auto group = std::ranges::find(all_groups, title, &Group::title);
    if (!every && command.options.size() > many_options && group != all_groups.end() && group->brief) {
      std::string line = lower(title) + ':';
      for (const OptionText* option : options) line += ' ' + option->flag;
      brief.push_back(line);
      continue;
    }
    heading(title) << '\n';
    for (const OptionText* option : options) print_option(out, *option, every);
  }
  const std::string help_command = "petzval help " + command.usage.substr(8, command.usage.find(' ', 8) - 8);
  if (!brief.empty()) {
    heading("More") << " (" << help_command << " all, or a group like "
                    << brief.front().substr(0, brief.front().find(':')) << ")\n";
    for (const std::string& line : brief) print_wrapped(out, "  " + line, 4, 0);
  } else if (!every) {
    heading("More") << "  " << help_command << " all\n";
  }
  if (!command.example.empty()) heading("Example:") << ' ' << command.example << '\n';
}

}  // namespace examples
