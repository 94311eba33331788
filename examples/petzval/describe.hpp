// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "commands.hpp"
#include "support/cli.hpp"

namespace commands {

/// Calls use(command, texts) for every built command.
template <class Use>
void for_each(const Use& use) {
  for (const Group& group : groups()) {
    for (const Command& command : group.commands) {
      if (command.run) use(command, examples::described(command.run, std::string(command.name)));
    }
  }
}

/// Prints the commands for a task in any word ("mtf", "blender"). Returns false if no help has this word.
bool print_help_on(const std::string& word);
/// The first command for a task; empty if the word names no task.
std::string first_command_for(std::string_view word);

/// Print a man page and completions of all commands, made from their options.
void print_man_page();
void print_bash_completion();
void print_zsh_completion();

}  // namespace commands
