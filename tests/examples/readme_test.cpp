// SPDX-License-Identifier: Apache-2.0
// Checks the pages of the repository: programs print the output shown, and paths exist.
// (tests/house/guides.cmake checks their code.)
#include <filesystem>
#include <regex>

#include "program.hpp"

namespace {

class Readme : public Programs {
 protected:
  static std::filesystem::path root() { return std::filesystem::path(PETZVAL_TEST_DATA).parent_path(); }

  /// Every line indented, without trailing blanks.
  static std::string indented(const std::string& text, std::size_t columns) {
    std::string result;
    for (const std::string& line : lines(text)) {
      const std::size_t length = line.find_last_not_of(' ') + 1;
      result += (length > 0 ? std::string(columns, ' ') : "") + line.substr(0, length) + '\n';
    }
    return result;
  }
};

TEST_F(Readme, ShowsTheOutputOfThePrograms) {
  const std::string page = read(root() / "README.md");
  const auto outcome = run("hello_lens", {});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(lines(outcome.out).size(), 3u);
  EXPECT_NE(page.find("prints\n\n" + indented(outcome.out, 4)), std::string::npos) << indented(outcome.out, 4);
}

/// Commands of several lines can be copied into a shell: every line but the last ends in a backslash.
TEST_F(Readme, CommandsOfAllPagesCanBeCopied) {
  std::size_t found = 0;
  for (const char* name : {"README.md", "data/README.md", "tests/README.md", "tests/bench/README.md",
                           "examples/renderer/README.md", "examples/hosts/README.md"}) {
    const auto page = lines(read(root() / name));
    for (std::size_t i = 0; i + 1 < page.size(); ++i) {
      if (!page[i].starts_with("    build/") && !page[i].starts_with("    sh ")) continue;
      ++found;
      for (std::size_t k = i; k + 1 < page.size() && page[k + 1].starts_with("        "); ++k) {
        EXPECT_TRUE(page[k].ends_with("\\")) << name << ':' << k + 1 << ": " << page[k];
      }
    }
  }
  EXPECT_GE(found, 4u);
}

/// Paths in back quotes and targets of links are relative to the root of the repository or to the folder of the page.
TEST_F(Readme, PathsOfAllPagesExist) {
  const std::regex path("(`|\\]\\()((cmake|data|examples|include|lib|tests)/[A-Za-z0-9_./-]*)[`)]");
  std::size_t found = 0;
  for (const char* page :
       {"README.md", "data/README.md", "lib/README.md", "tests/README.md", "tests/bench/README.md"}) {
    const std::string text = read(root() / page);
    for (std::sregex_iterator match(text.begin(), text.end(), path), end; match != end; ++match, ++found) {
      const std::string name = (*match)[2];
      EXPECT_TRUE(std::filesystem::exists(root() / name)) << page << ": " << name;
    }
  }
  EXPECT_GT(found, 10u);
}

}  // namespace
