// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <map>

#include "program.hpp"

namespace {

class Gallery : public Programs {
 protected:
  /// Runs a script of the shell in the folder of the test, with a program petzval that runs `program`.
  Outcome shell(const std::string& script, const std::string& program = "exit 0") const {
    std::filesystem::create_directories(path("programs"));
    if (!std::filesystem::exists(path("programs/petzval")) || read(path("programs/petzval")) != program) {
      for (const char* name : {"petzval", "wu_figure7", "wu_statements"}) {
        write("programs/" + std::string(name), program);
        std::filesystem::permissions(path("programs/" + std::string(name)), std::filesystem::perms::owner_all);
      }
    }
    write("script.sh", "set -eu\nfolder='" + folder.string() + "'\nexamples='" + examples() + "'\n" + script);
    const int status = std::system(
        ("sh '" + path("script.sh") + "' > '" + path("out.txt") + "' 2> '" + path("err.txt") + '\'').c_str());
    return {WEXITSTATUS(status), read(path("out.txt")), read(path("err.txt"))};
  }

  static std::string examples() {
    return (std::filesystem::path(PETZVAL_TEST_DATA).parent_path() / "examples").string();
  }

  /// A gallery of three pictures. `second`: the commands of the second picture.
  Outcome gallery(const std::string& second) const {
    return shell(
        ". \"$examples/gallery_page.sh\"\n"
        "pictures() {\n"
        "  section lenses Lenses 'Two lenses.'\n"
        "  picture a/one.svg 'First lens' 'A <b>short</b> lens.' <<END\necho '1 < 2' > a/one.svg\nEND\n"
        "  also a/one.svg 'Again' 'The same file.'\n"
        "  picture two.svg 'Second lens' 'A long lens.' <<END\n" +
        second +
        "\nEND\n"
        "  section tables Tables 'One table.' halves\n"
        "  picture three.html Table 'Numbers.' <<END\necho '<table></table>' > three.html\nEND\n"
        "}\n"
        "gallery \"$folder/out\" \"$folder/programs\" pictures Title Lead\n");
  }
  /// True for an SVG file with the width of all sheets.
  static bool is_sheet(const std::string& file) {
    const std::string svg = read(file);
    return svg.starts_with("<svg") && svg.find(" width=\"1280\"") < svg.find('\n') && svg.ends_with("</svg>\n");
  }
  std::string page() const { return read(path("out/index.html")); }
};

TEST_F(Gallery, PageHasContentsCommandsAndTimes) {
  const auto outcome = gallery("echo 2 > two.svg");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* text :
       {"<li><a href=\"#lenses\">Lenses</a></li>", "<section id=\"lenses\">", "<li><a href=\"#tables\">Tables</a></li>",
        "<img src=\"a/one.svg\" alt=\"First lens\"", "A <b>short</b> lens.",
        "<pre class=\"command\">echo '1 &lt; 2' &gt;", "<table></table>", "<p class=\"time\">at most 1 second</p>"}) {
    EXPECT_NE(page().find(text), std::string::npos) << text << '\n' << page();
  }
  EXPECT_EQ(page().find("Still being made"), std::string::npos);
  EXPECT_NE(outcome.out.find("The first picture: " + path("out/a/one.svg")), std::string::npos) << outcome.out;
}

TEST_F(Gallery, SecondRunMakesOnlyPicturesWithNewCommands) {
  ASSERT_EQ(gallery("echo 2 > two.svg").status, 0);
  const auto again = gallery("echo new > two.svg");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.out.find("[1/3] First lens: kept\n[2/3] Second lens\n[3/3] Table: kept\n"), std::string::npos)
      << again.out;
  EXPECT_EQ(read(path("out/two.svg")), "new\n");
}

TEST_F(Gallery, NewerProgramsMakeAllPicturesAgain) {
  ASSERT_EQ(gallery("echo 2 > two.svg").status, 0);
  std::filesystem::last_write_time(path("programs/petzval"),
                                   std::filesystem::file_time_type::clock::now() + std::chrono::seconds(1));
  EXPECT_EQ(gallery("echo 2 > two.svg").out.find("kept"), std::string::npos);
}

TEST_F(Gallery, FailedCommandIsReportedAndTheRestIsMade) {
  for (const char* command : {"exit 3", "true"}) {
    const auto outcome = gallery(command);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("Not made: two.svg"), std::string::npos) << outcome.err;
    EXPECT_NE(page().find("Not made: exit status"), std::string::npos) << page();
    EXPECT_NE(page().find("<table></table>"), std::string::npos) << page();
  }
}

TEST_F(Gallery, InterruptionKeepsFinishedPictures) {
  const auto outcome = gallery("exit 130");
  EXPECT_EQ(outcome.status, 130);
  EXPECT_NE(outcome.out.find("Stopped."), std::string::npos) << outcome.out;
  EXPECT_NE(page().find("First lens"), std::string::npos) << page();
  EXPECT_NE(gallery("echo 2 > two.svg").out.find("First lens: kept"), std::string::npos);
  EXPECT_NE(page().find("<table></table>"), std::string::npos) << page();
}

/// The commands of the gallery name commands and flags that exist.
TEST_F(Gallery, FlagsOfAllCommandsExist) {
  const auto outcome = shell("sh \"$examples/gallery.sh\" \"$folder/programs\" \"$folder/out\" || true\n",
                             "#!/bin/sh\n"
                             "case $0 in */petzval) name=\"petzval $1\" help=\"petzval help $1\" ;; *) name=${0##*/} "
                             "help=\"$name --help\" ;; esac\n"
                             "[ \"$name\" != 'petzval help' ] || exit 0\n"
                             "text=$(" +
                                 invocation("petzval").substr(0, invocation("petzval").rfind('/') + 1) +
                                 "$help) || echo \"no command $name\" >&2\n"
                                 "for flag; do\n"
                                 "  case $flag in --*) case \"$text\" in *\" $flag\"[\\ ,]*|*\",$flag \"*) ;; *) echo "
                                 "\"$name: no flag $flag\" >&2 ;; esac ;; esac\n"
                                 "done\n");
  EXPECT_EQ(outcome.err.find("no command"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("no flag"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("Done in"), std::string::npos) << outcome.out;
}

TEST_F(Gallery, DrawsFigure7) {
  const auto outcome = run("wu_figure7", {"--rays", "1024", "--out", path("figure.svg")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(is_sheet(path("figure.svg")));
  EXPECT_EQ(pictures_in(path("figure.svg")), 20u);
  expect_failure("wu_figure7", {"--out", path("figure.jpg")}, {"figure.jpg", ".svg"});
}

TEST_F(Gallery, DrawsTheShapesOfBokeh) {
  const auto outcome = run("shapes", {"--out", path("shapes"), "--rays", "4096"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::vector<std::string> files;
  for (const char* name : {"blades", "cats_eyes", "lens_ratio", "weights", "maps"}) {
    files.push_back(path(std::string("shapes/bokeh_") + name + ".svg"));
    EXPECT_TRUE(is_sheet(files.back()));
  }
  EXPECT_EQ(lines(outcome.out), files);
}

/// Wu et al. 2010 describe their figure 7 in words, tested here for four readings of "in focus" and "distance from the
/// lens".
TEST_F(Gallery, ProfilesAgreeWithThePaperExceptKnownCases) {
  const auto outcome = run("wu_statements", {"--rays", "16384", "--html", path("table.html")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = lines(outcome.out);
  ASSERT_EQ(rows.size(), 87u);  // a second table has the pupils of the four lenses
  std::map<std::string, int> disagree;
  for (std::size_t i = 1; i < 81; ++i) {
    const bool no = rows[i].find("  NO  ") != std::string::npos;
    ASSERT_NE(no, rows[i].find("  yes  ") != std::string::npos) << rows[i];
    if (no) ++disagree[rows[i].substr(0, rows[i].find(' '))];
  }
  EXPECT_EQ(disagree.count("double_gauss_100mm_f1.35"), 0u);
  EXPECT_EQ(disagree.count("double_gauss_100mm_f1.7_substitute"), 0u);
  // The third row at the paraxial focus is sharpest when focused at 1100 mm, not at 1000; focused at 800 mm its disc is
  // nearly uniform, but has a bright core.
  EXPECT_EQ(disagree["double_gauss_100mm_f2_28deg"], 6) << outcome.out;
  // The Tronnier does the opposite at every distance except 1000 mm.
  EXPECT_EQ(disagree["double_gauss_100mm_f2.0"], 16) << outcome.out;
  EXPECT_NE(read(path("table.html")).find("</table>"), std::string::npos);
  // TextbookPupil of the light at 1000 mm, and the image of the stop.
  EXPECT_NE(rows[86].find("50.265"), std::string::npos) << rows[86];
  EXPECT_NE(rows[86].find("49.610"), std::string::npos) << rows[86];
}

}  // namespace
