// SPDX-License-Identifier: Apache-2.0
// Options with the same meaning in every program: distances, focus, f-numbers, lists.
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"

namespace {

class Distances : public Programs {
 protected:
  static Arguments joined(Arguments a, const Arguments& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  nlohmann::json printed(const std::string& program, const Arguments& arguments) const {
    const auto outcome = run(program, arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }
  /// Film positions for a subject at 1000 mm, by program.
  std::vector<std::pair<std::string, double>> films(const std::string& id, const Arguments& more) const {
    const std::string file = lens(id);
    std::vector<std::pair<std::string, double>> result;
    const auto add = [&](const char* program, const nlohmann::json& film) { result.emplace_back(program, film); };
    add("report", printed("report", joined({file, "--json", "--at", "1000"}, more))["film_z_mm"]);
    EXPECT_EQ(run("spots", joined({file, "--at", "1000", "--fields", "0", "--wavelengths", "d", "--rays", "64", "--out",
                                   path("spots")},
                                  more))
                  .status,
              0);
    add("spots", read_json(path("spots/" + id + "_spots.json"))[0]["film_z_mm"]);
    EXPECT_EQ(
        run("psf", joined({file, "--at", "1000", "--focus", "1000", "--rays", "1024", "--out", path("bokeh")}, more))
            .status,
        0);
    add("psf", read_json(path("bokeh/" + id + "_bokeh.json"))["results"][0]["film_z_mm"]);
    EXPECT_EQ(run("colour", joined({file, "--at", "1000", "--focus", "1000", "--fields", "0", "--rays", "64", "--out",
                                    path("colour")},
                                   more))
                  .status,
              0);
    add("colour", read_json(path("colour/" + id + "_chromatic.json"))["pictures"][0]["film_z_mm"]);
    add("focus", printed("focus", joined({file, "--json", "--at", "1000"}, more))[0]["film_z_mm"]);
    // Distance of the film from a subject at 1 m, minus the origin of distances.
    EXPECT_EQ(run("metadata", joined({file, "--focus", "1000", "--out", path("data")}, more)).status, 0);
    add("metadata", 1000 * read_json(path("data/" + id + ".opentrackio.json"))["lens"]["focusDistance"].get<double>());
    return result;
  }
};

TEST_F(Distances, EveryProgramHasTheSameFilmForADistance) {
  const std::string id = "double_gauss_100mm_f2.0";
  const petzval::Lens whole = petzval::testing::data_lens(id);
  using enum petzval::DistanceOrigin;
  for (const auto origin : {front_vertex, film, entrance_pupil}) {
    const Arguments flags =
        origin == front_vertex ? Arguments{} : Arguments{"--from", std::string(petzval::name(origin))};
    const petzval::Lens focused = petzval::with_focus(whole, 1000, {.origin = origin});
    for (const auto& [program, found] : films(id, flags)) {
      SCOPED_TRACE(program + " from " + std::string(petzval::name(origin)));
      if (program == "metadata") {
        // The file has metres, rounded to a micrometre.
        EXPECT_NEAR(found, focused.film_z() + 1000 - petzval::origin_z(focused, origin), 2e-3);
      } else {
        EXPECT_NEAR(found, focused.film_z(), program == "colour" ? 5e-3 : 1e-9);  // colour focuses at 590 nm
      }
    }
  }
  // All programs agree for another criterion as well.
  const petzval::Lens paraxial = petzval::with_focus(whole, 1000, {petzval::FocusCriterion::paraxial});
  for (const auto& [program, found] : films(id, {"--criterion", "paraxial"})) {
    // In the file format, the distance is the distance of the sharpest subject.
    if (program == "metadata") continue;
    EXPECT_NEAR(found, paraxial.film_z(), program == "colour" ? 5e-3 : 1e-9) << program;
  }
}

TEST_F(Distances, EveryProgramNamesTheOriginOfDistances) {
  const std::vector<Arguments> programs{
      {"report"},  {"spots"},      {"focus"},  {"psf"},      {"psf-set"}, {"psf-set", "query"}, {"colour"},
      {"surface"}, {"expressive"}, {"export"}, {"metadata"}, {"models"},  {"choose"},           {"camera-rays"},
#ifdef PETZVAL_TEST_HAS_pull
      {"pull"},
#endif
#ifdef PETZVAL_TEST_HAS_render
      {"render"},
#endif
#ifdef PETZVAL_TEST_HAS_blur
      {"blur"},
#endif
  };
  for (const Arguments& program : programs) {
    const bool sub_command = program.size() > 1;  // its help is complete
    const std::string help = sub_command ? run(program[0], joined({program[1]}, {"--help"})).out
                                         : run("petzval", {"help", program[0], "all"}).out;
    const std::size_t at = help.find("--from ");
    ASSERT_NE(at, std::string::npos) << program[0];
    const std::string line = help.substr(at, 300);
    EXPECT_NE(line.find("[front_vertex]"), std::string::npos) << program[0] << ": " << line;
    for (const char* origin : {"film", "entrance_pupil"}) EXPECT_NE(line.find(origin), std::string::npos) << line;
    const std::size_t criterion = help.find("--criterion ");
    if (program.size() > 1) continue;  // a query does not focus
    ASSERT_NE(criterion, std::string::npos) << program[0];
    EXPECT_NE(help.substr(criterion, 600).find("min_rms"), std::string::npos) << program[0];
  }
}

// A lens opens to the f-number of its own name, which is rounded.
TEST_F(Distances, LensOpensToTheFNumberOfItsName) {
  const std::vector<std::pair<std::string, std::string>> lenses{{"double_gauss_52mm_f1.8", "1.8"},
                                                                {"modern_58mm_f0.95", "0.95"},
                                                                {"telephoto_200mm_f1.8", "1.8"},
                                                                {"apodized_135mm_f2.8", "2.8"},
                                                                {"triplet_98mm_f4.4", "4.4"}};
  for (const auto& [id, name] : lenses) {
    const auto outcome = run("report", {lens(id), "--json", "--f-number", name});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const double fastest = petzval::fastest_f_number(petzval::testing::data_lens(id));
    EXPECT_NEAR(nlohmann::json::parse(outcome.out)["f_number"].get<double>(), fastest, 1e-9) << id;
    EXPECT_NE(outcome.err.find("f/" + name + "\n"), std::string::npos) << outcome.err;
  }
  const std::string file = lens("double_gauss_52mm_f1.8");
  expect_failure("report", {file, "--f-number", "1.77"}, {"--f-number", 1.77});
  // The other programs accept the rounded f-number too.
  for (const auto& [program, more] : std::vector<std::pair<std::string, Arguments>>{
           {"focus", {"--json"}},
           {"psf", {"--at", "2000", "--focus", "1000", "--rays", "64", "--out", path("o")}},
           {"psf-set", {"--fields", "0", "--at", "2000", "--rays", "64", "--out", path("p")}}}) {
    const auto outcome = run(program, joined({file, "--f-number", "1.8"}, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(lines(outcome.err).size(), 1u) << outcome.err;
  }
}

TEST_F(Distances, ListsAcceptBlanksAndSpectralLines) {
  const auto of = [&](const std::string& distances, const std::string& wavelengths) {
    return printed("focus", {lens("cooke_triplet_50mm_f5"), "--json", "--criterion", "min_rms", "--at", distances,
                             "--wavelengths", wavelengths});
  };
  EXPECT_EQ(of("1000, 2000", "F,d, C"), of("1000,2000", "486.1327,587.5618,656.2725"));
  expect_failure("focus", {lens("cooke_triplet_50mm_f5"), "--wavelengths", "F,q"}, {"--wavelengths", "q"});
  expect_failure("focus", {lens("cooke_triplet_50mm_f5"), "--wavelengths", "d,587.5618"}, {"--wavelengths", 587.5618});
}

}  // namespace
