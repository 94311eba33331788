// SPDX-License-Identifier: Apache-2.0
#include "describe.hpp"

#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"

namespace commands {
namespace {

/// A text for roff: hyphens and backslashes are literal, and no line begins with a control character.
std::string roff(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) {
      result += std::string("\\&") + c;
    } else if (c == '\n') {
      result += "\n.br\n";
    } else {
      result += c;
    }
  }
  return result;
}

/// A text in single quotes for a shell; brackets and colons are literal in descriptions of zsh.
std::string quoted(std::string_view text, bool zsh) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else if (c == '\n') {
      result += ' ';
    } else {
      if (zsh && (c == '[' || c == ']' || c == ':')) result += '\\';
      result += c;
    }
  }
  return result + "'";
}

/// The type of a value, "NAME" of "NAME:{a,b}".
std::string type_of(const examples::OptionText& option) { return option.type.substr(0, option.type.find(":{")); }

std::string joined(const std::vector<std::string>& values, const char* between) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : between) + value;
  return text;
}

/// The names of all built commands.
std::string names() {
  std::string text;
  for_each([&](const Command& command, const examples::CommandText&) { text += ' ' + std::string(command.name); });
  return text;
}

}  // namespace

void print_man_page() {
  std::cout << ".TH PETZVAL 1 \"\" \"petzval " PETZVAL_VERSION
               "\"\n.SH NAME\npetzval \\- real lenses for renderers\n"
               ".SH SYNOPSIS\n.B petzval\n.I COMMAND\n[\\fILENS\\fR] [options]\n.SH DESCRIPTION\n"
               "LENS is a file or the name of a shipped lens. Lengths are millimetres or have a unit: 3m, 50cm, 2in.\n"
               ".ad l\n.SH COMMANDS\n";
  for_each([](const Command& command, const examples::CommandText& text) {
    std::cout << ".SS " << roff(command.name) << '\n'
              << roff(text.description) << "\n.PP\nExample: " << roff("petzval " + std::string(command.name) + ' ')
              << roff(command.example) << '\n';
    for (const examples::OptionText& option : text.options) {
      std::cout << ".TP\n\\fB" << roff(option.flag) << "\\fR " << roff(type_of(option)) << '\n' << roff(option.help);
      if (!option.values.empty()) std::cout << ": " << roff(joined(option.values, ", "));
      std::cout << '\n';
    }
  });
  std::cout << ".SH EXIT STATUS\n0: success. 1: error, with one line on standard error. 2: unknown command. "
               "3: not converted because of \\-\\-strict. 130: interrupted (SIGINT or SIGTERM).\n"
               ".SH ENVIRONMENT\n.TP\nNO_COLOR\nIf set, help and messages have no colours.\n"
               ".TP\nPETZVAL_INSTRUCTION_SET\nThe widest instructions to use: baseline, avx2 or avx512.\n"
               ".SH FILES\nIn the folder of the installation:\n"
               ".TP\nshare/petzval/lenses, share/petzval/glass\nThe shipped lenses; glasses and spectra.\n"
               ".TP\nshare/doc/petzval/lib/docs\nGuides; hosts_for_artists.md is for Blender, Nuke, Unreal, Unity and "
               "Houdini.\n.SH SEE ALSO\n.BR exiftool (1),\n.BR oiiotool (1)\n";
}

void print_bash_completion() {
  std::cout
      << "# Completion of petzval for bash.\n_petzval() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} words= values=\n  if [ \"$COMP_CWORD\" -eq 1 ]; then\n    words='help"
      << names() << "'\n  else\n    case ${COMP_WORDS[1]} in\n      help) values='all files" << names() << "' ;;\n";
  for_each([](const Command& command, const examples::CommandText& text) {
    std::string cases;
    std::cout << "      " << command.name << ") words='";
    for (const examples::OptionText& option : text.options) {
      if (option.flag.starts_with("--")) std::cout << option.flag << ' ';
      if (!option.values.empty()) cases += ' ' + option.flag + ") values='" + joined(option.values, " ") + "' ;;";
    }
    std::cout << "'; case ${COMP_WORDS[COMP_CWORD-1]} in" << cases << " esac ;;\n";
  });
  std::cout << "    esac\n    case $values:$word in\n      :-*) ;;\n      ?*:*) words=$values ;;\n"
               "      *) words=\"$words $(petzval lenses 2>/dev/null | cut -d' ' -f1)\" ;;\n    esac\n  fi\n"
               "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n}\n"
               "complete -o default -F _petzval petzval\n";
}

void print_zsh_completion() {
  std::cout << "#compdef petzval\n_petzval() {\n  local -a list\n"
               "  if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then\n    list=(\n";
  for_each([](const Command& command, const examples::CommandText&) {
    std::cout << "      " << quoted(std::string(command.name) + ':' + std::string(command.summary), false) << '\n';
  });
  std::cout << "    )\n    _describe command list\n    return\n  fi\n  case $words[2] in\n";
  for_each([](const Command& command, const examples::CommandText& text) {
    std::cout << "    " << command.name << ") _arguments";
    for (const examples::OptionText& option : text.options) {
      if (!option.flag.starts_with("--")) continue;
      const std::string values = option.values.empty() ? "_files" : '(' + joined(option.values, " ") + ')';
      const std::string type = option.type.empty() ? "" : ':' + type_of(option) + ':' + values;
      const std::string line = quoted(option.help, true);
      std::cout << " \\\n      " << line.substr(0, 1) << option.flag << '[' << line.substr(1, line.size() - 2) << ']'
                << type << '\'';
    }
    std::cout << " \\\n      '*:lens:($(petzval lenses 2>/dev/null | cut -d\" \" -f1))' ;;\n";
  });
  std::cout << "  esac\n}\n_petzval \"$@\"\n";
}

}  // namespace commands
