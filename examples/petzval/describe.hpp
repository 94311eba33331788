// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace commands {

/// Print a man page and completions of all commands, made from their options.
void print_man_page();
void print_bash_completion();
void print_zsh_completion();

}  // namespace commands
