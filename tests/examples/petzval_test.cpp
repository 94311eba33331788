// SPDX-License-Identifier: Apache-2.0
// The program petzval: overview, help, mistyped commands, flags and lenses, lengths with units, man page and
// completions.
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "petzval/core/config.hpp"
#include "program.hpp"

namespace {

class Petzval : public Programs {
 protected:
  /// The commands that the overview lists.
  std::vector<std::string> commands() const {
    const std::string overview = run("petzval", {"help"}).out;
    static const std::regex line("\n  ([a-z-]+) +[a-zA-Z]");
    std::vector<std::string> result;
    for (std::sregex_iterator found(overview.begin(), overview.end(), line), end; found != end; ++found) {
      result.push_back((*found)[1]);
    }
    return result;
  }
};

TEST_F(Petzval, OverviewListsTheCommands) {
  const Outcome plain = run("petzval", {});
  EXPECT_EQ(plain.status, 0);
  EXPECT_EQ(plain.out, run("petzval", {"help"}).out);
  EXPECT_LE(lines(plain.out).size(), 50u);
  const auto all = commands();
  for (const char* name : {"lenses", "report", "convert",     "focus",  "trace",   "spots",      "psf",    "psf-set",
                           "colour", "shapes", "tilt",        "pull",   "surface", "expressive", "export", "metadata",
                           "models", "choose", "camera-rays", "render", "sheet",   "blur",       "ghosts"}) {
    EXPECT_NE(std::ranges::find(all, name), all.end()) << name;
  }
}

TEST_F(Petzval, VersionIsTheVersionOfTheLibrary) {
  EXPECT_EQ(run("petzval", {"--version"}).out, "petzval " PETZVAL_VERSION "\n");
}

TEST_F(Petzval, HelpOfEveryCommandHasAnExample) {
  for (const std::string& name : commands()) {
    const Outcome help = run("petzval", {"help", name});
    if (help.status != 0) continue;  // not built
    EXPECT_EQ(help.out, run(name, {"--help"}).out) << name;
    EXPECT_NE(help.out.find("Example: petzval " + name), std::string::npos) << help.out;
    const auto shown = lines(help.out);
    EXPECT_LE(shown.size(), 50u) << name;
    for (const std::string& line : shown) EXPECT_LE(line.size(), 100u) << line;
    const std::string all = run("petzval", {"help", name, "all"}).out;
    EXPECT_EQ(all.find("\nOther\n"), std::string::npos) << all;  // every flag is in a group
    EXPECT_GT(all.size(), help.out.size()) << name;
  }
}

/// The example of a help is complete: with another folder or file for the result, and existing inputs, it is accepted.
TEST_F(Petzval, ExamplesOfTheHelpHaveAllRequiredOptions) {
  for (const std::string& name : commands()) {
    const std::string help = run("petzval", {"help", name}).out;
    std::istringstream words(help.substr(std::min(help.size(), help.find("Example: petzval ") + 17)));
    Arguments arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    if (arguments.empty()) continue;  // not built
    arguments.erase(arguments.begin());
    arguments.push_back("--no-such-flag");
    const Outcome outcome = run(name, arguments);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("--no-such-flag"), std::string::npos) << name << ": " << outcome.err;
  }
}

TEST_F(Petzval, OutputNeverReplacesAnInput) {
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,1,-50,0,0,1\n");
  const std::string before = read(path("rays.csv"));
  expect_failure("trace", {"double_gauss_52mm_f1.8", "--table", path("rays.csv"), "--out", path("rays.csv")},
                 {"--out", "--table", "rays.csv"});
  EXPECT_EQ(read(path("rays.csv")), before);
}

TEST_F(Petzval, HelpShowsOneGroupOfOptions) {
  const std::string iris = run("petzval", {"help", "psf", "iris"}).out;
  EXPECT_NE(iris.find("--roundness"), std::string::npos) << iris;
  EXPECT_EQ(iris.find("--focus"), std::string::npos) << iris;
  const Outcome unknown = run("petzval", {"help", "psf", "wheels"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_NE(unknown.err.find("wheels"), std::string::npos) << unknown.err;
}

TEST_F(Petzval, MistypedValueGetsASuggestion) {
  expect_failure("focus", expanded({"LENS", "--criterion", "min_rsm"}), {"--criterion", "min_rsm", "mean min_rms?"});
}

TEST_F(Petzval, MistypedCommandGetsASuggestion) {
  const Outcome outcome = run("petzval", {"reprot"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("reprot"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("mean report?"), std::string::npos) << outcome.err;
}

/// A mistyped flag is named before its consequence, a missing option.
TEST_F(Petzval, FlagOfOtherProgramsGetsASuggestion) {
  expect_failure("psf", expanded({"LENS", "--aperture", "2"}), {"--aperture", "mean --f-number?"});
  expect_failure("focus", expanded({"LENS", "--focus", "1m"}), {"--focus", "mean --at?"});
  expect_failure("render", expanded({"LENS", "--feilds=0"}), {"--feilds=0"});
}

TEST_F(Petzval, WordsOfUsersLeadToCommands) {
  const auto all = commands();
  static const std::regex line("(?:^|\n)petzval help ([a-z-]+)");
  for (const char* word : {"mtf", "seidel", "aberrations", "dof", "bokeh", "blender", "nuke", "unreal", "zemax",
                           "distortion", "t-stop", "MTF", "roundness"}) {
    const Outcome help = run("petzval", {"help", word});
    EXPECT_EQ(help.status, 0) << word;
    std::smatch found;
    ASSERT_TRUE(std::regex_search(help.out, found, line)) << word << ": " << help.out;
    EXPECT_NE(std::ranges::find(all, found[1].str()), all.end()) << help.out;
  }
  EXPECT_EQ(run("petzval", {"help", "depth", "of", "field"}).out, run("petzval", {"help", "dof"}).out);
  for (const char* word : {"", "---", "nosuchword"}) {
    const Outcome help = run("petzval", {"help", word});
    EXPECT_EQ(help.status, 2) << word;
    EXPECT_EQ(help.out, "") << word;
  }
}

/// The table of words.cpp has lines "words | commands | text". The commands exist and have the flags of the text.
TEST_F(Petzval, TasksNameCommandsAndTheirFlags) {
  const auto all = commands();
  static const std::regex row(R"( ([^|]+) \| ([^|]+) \| (.+))"), flag("--[a-z-]+");
  std::size_t count = 0;
  for (const std::string& line : lines(read(std::string(PETZVAL_TEST_DATA) + "/../examples/petzval/words.cpp"))) {
    std::smatch task;
    if (!std::regex_match(line, task, row)) continue;
    ++count;
    const std::string word = task[1].str().substr(0, task[1].str().find(' ')), text = task[3];
    const std::string shown = run("petzval", {"help", word}).out;
    std::istringstream names(task[2].str());
    std::string helps, first;
    for (std::string name; names >> name;) {
      if (first.empty()) first = name;
      EXPECT_NE(std::ranges::find(all, name), all.end()) << line;
      const Outcome help = run("petzval", {"help", name, "all"});
      if (help.status != 0) return;  // not built
      helps += help.out;
      EXPECT_NE(shown.find("petzval help " + name), std::string::npos) << shown;
    }
    for (std::sregex_iterator found(text.begin(), text.end(), flag), end; found != end; ++found) {
      EXPECT_NE(helps.find(found->str() + ' '), std::string::npos) << line << ": " << found->str();
    }
    const Outcome mistaken = run("petzval", {word, "double_gauss_52mm_f1.8"});
    EXPECT_EQ(mistaken.status, 2) << word;
    EXPECT_NE(mistaken.err.find("petzval " + first), std::string::npos) << mistaken.err;
  }
  EXPECT_GT(count, 15u);
}

TEST_F(Petzval, BashCompletesValues) {
  write("completion.bash", run("petzval", {"--bash-completion"}).out);
  const auto completed = [&](const std::string& words) {
    write("complete.bash", "source '" + path("completion.bash") + "'\nCOMP_WORDS=(petzval " + words +
                               ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_petzval\necho \"${COMPREPLY[*]}\"\n");
    EXPECT_EQ(std::system(("bash '" + path("complete.bash") + "' > '" + path("completed") + "'").c_str()), 0);
    return read(path("completed"));
  };
  EXPECT_EQ(completed("psf lens.json --criterion min"), "min_rms min_max\n");
  EXPECT_EQ(completed("help psf"), "psf psf-set\n");
  EXPECT_EQ(completed("psf --diff"), "--diffraction\n");
  EXPECT_EQ(completed("ren"), "render\n");
}

TEST_F(Petzval, MistypedLensGetsASuggestion) {
  expect_failure("report", {"double_gauss_52mm_f1.9"}, {"double_gauss_52mm_f1.9", "double_gauss_52mm_f1.8"});
}

TEST_F(Petzval, ShippedLensesHaveNames) {
  const std::string id = "double_gauss_52mm_f1.8";
  EXPECT_EQ(run("report", {id, "--json"}).out, run("report", {lens(id), "--json"}).out);
  const auto found = nlohmann::json::parse(run("lenses", {"gauss", "52", "--json"}).out);
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(std::ranges::any_of(found, [&](const auto& row) { return row.at("id") == id; }));
  for (const auto& row : found) EXPECT_NE(row.dump().find("52"), std::string::npos) << row;
}

TEST_F(Petzval, ListOfLensesHasSeparateColumns) {
  for (const std::string& line : lines(run("lenses", {}).out)) {
    std::istringstream words(line);
    std::string id, cell;
    words >> id;
    for (int i = 0; i < 3; ++i) {
      words >> cell;
      double value = 0;
      const auto [end, status] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      EXPECT_TRUE(cell == "-" || (status == std::errc() && end == cell.data() + cell.size())) << line;
    }
  }
}

TEST_F(Petzval, FilesHaveTheWholeNameOfAShippedLens) {
  for (const char* id : {"double_gauss_100mm_f1.35", "double_gauss_100mm_f2.0"}) {
    const auto outcome = run("spots", {id, "--fields", "0", "--out", path("spots")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(path("spots/" + std::string(id) + "_spots.svg"))) << outcome.out;
  }
}

TEST_F(Petzval, LengthsTakeUnits) {
  const std::string id = "double_gauss_52mm_f1.8";
  const auto by = [&](const char* distance) { return run("focus", {id, "--at", distance, "--json"}).out; };
  const std::string expected = by("2540");
  EXPECT_FALSE(expected.empty());
  for (const char* distance : {"2.54m", "254cm", "2540mm", "100in"}) EXPECT_EQ(by(distance), expected) << distance;
  expect_failure("focus", {id, "--at", "3yards"}, {"--at", "3yards"});
}

TEST_F(Petzval, WavelengthsHaveNames) {
  const auto at = [&](const std::string& wavelengths) {
    return run("focus", {"double_gauss_52mm_f1.8", "--at", "3m", "--json", "--wavelengths", wavelengths}).out;
  };
  std::string visible = "430";
  for (int nm = 440; nm <= 670; nm += 10) visible += ',' + std::to_string(nm);
  EXPECT_EQ(at("visible"), at(visible));
  EXPECT_EQ(at("rgb"), at("475,510,650"));
  EXPECT_NE(at("rgb"), at("d"));
}

TEST_F(Petzval, PicturesKeepTheCommand) {
  const auto draw = [&](const char* name, const char* threads) {
    EXPECT_EQ(run("psf", {"double_gauss_52mm_f1.8", "--at", "5m", "--focus", "1m", "--rays", "512", "--out", path(name),
                          "--threads", threads})
                  .status,
              0);
    return read(path(name) + "/double_gauss_52mm_f1.8_bokeh.svg");
  };
  const std::string svg = draw("a", "1");
  EXPECT_NE(svg.find("petzval psf double_gauss_52mm_f1.8 --at 5m --focus 1m --rays 512"), std::string::npos);
  EXPECT_NE(svg.find("petzval " PETZVAL_VERSION), std::string::npos);
  EXPECT_EQ(svg, draw("b", "2"));
}

TEST_F(Petzval, QuietSaysNothing) {
  const Outcome outcome = run("lenses", {"nothing_has_this_name", "--quiet"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(run("lenses", {"nothing_has_this_name"}).err, "");
}

TEST_F(Petzval, UnknownInstructionSetsAreRefused) {
  const char* const before = std::getenv("PETZVAL_INSTRUCTION_SET");
  const std::string old = before ? before : "";
  setenv("PETZVAL_INSTRUCTION_SET", "nonsense", 1);
  expect_failure("lenses", {}, {"PETZVAL_INSTRUCTION_SET", "nonsense"});
  setenv("PETZVAL_INSTRUCTION_SET", old.c_str(), 1);
  EXPECT_EQ(run("lenses", {}).status, 0);
}

/// The man page and the completions name every flag of the help of every command.
TEST_F(Petzval, ManPageAndCompletionsHaveTheFlagsOfTheHelp) {
  const std::string man = std::regex_replace(run("petzval", {"--man-page"}).out, std::regex("\\\\-"), "-");
  const std::string bash = run("petzval", {"--bash-completion"}).out, zsh = run("petzval", {"--zsh-completion"}).out;
  static const std::regex flag("(?:^|\\n) +(?:-[a-z],)?(--[a-z0-9-]+)");
  std::size_t count = 0;
  for (const std::string& name : commands()) {
    const std::string help = run("petzval", {"help", name, "all"}).out;
    for (std::sregex_iterator found(help.begin(), help.end(), flag), end; found != end; ++found, ++count) {
      for (const std::string* text : {&man, &bash, &zsh}) {
        EXPECT_NE(text->find((*found)[1].str()), std::string::npos) << name << ' ' << (*found)[1];
      }
    }
  }
  EXPECT_GT(count, 100u);
  write("completion.bash", bash);
  EXPECT_EQ(std::system(("bash -n '" + path("completion.bash") + "'").c_str()), 0);
}

}  // namespace
