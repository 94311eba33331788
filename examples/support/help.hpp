// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace examples {

/// The texts of an option.
struct OptionText {
  std::string flag, type, help;
  std::vector<std::string> values{};  ///< the allowed values; empty: by `type`
  std::string default_text{};
  bool required = false, positional = false, several = false;
};
/// The texts of a command.
struct CommandText {
  std::string description, usage, example;
  std::vector<OptionText> options;
};

/// Prints the help of a command. `topic` is empty for a short help, "all" for all texts, or the name of a group of
/// options, like "iris". Titles are bold if `colours`.
/// @throws petzval::Error  if the command has no group with this name
void print_help(std::ostream& out, const CommandText& command, std::string_view topic, bool colours);

/// The group of a flag, as in the headings of the help; "Other" for unknown flags.
std::string_view help_group(std::string_view flag);

}  // namespace examples
