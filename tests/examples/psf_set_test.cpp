// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <set>

#include "petzval/image/psf.hpp"
#include "program.hpp"

namespace {

namespace fs = std::filesystem;

class PsfSets : public Programs {
 protected:
  /// A set of twelve PSFs: what to compute, then more options.
  std::vector<std::string> set(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{lens("double_gauss_100mm_f2_28deg"),
                                       "--fields",
                                       "0,7,14",
                                       "--at",
                                       "1000,inf",
                                       "--f-number",
                                       "2.8,4",
                                       "--focus",
                                       "2000",
                                       "--rays",
                                       "4096",
                                       "--size",
                                       "33",
                                       "--out",
                                       path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  void succeed(const std::vector<std::string>& arguments) const {
    const auto outcome = run("psf-set", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  std::string whole() const {
    succeed(set("whole"));
    return read(path("whole/psf_set.exr"));
  }
  static std::string psf(const std::string& name) { return "psfs/" + name + "_587.5618nm_f2.8.exr"; }
};

TEST_F(PsfSets, IndexDescribesTheSet) {
  const auto outcome = run("psf-set", set("whole", {"--check"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(lines(outcome.out),
            (std::vector{path("whole/psf_set.exr"), path("whole/psf_set.json"), path("whole/psf_set.svg")}));
  EXPECT_TRUE(read(path("whole/psf_set.svg")).starts_with("<svg"));
  const auto json = read_json(path("whole/psf_set.json"));
  const petzval::PsfSet set = petzval::read_psf_set(path("whole/psf_set.exr"));
  ASSERT_EQ(json["psfs"].size(), 12u);
  EXPECT_TRUE(json["units"].contains("light"));
  EXPECT_EQ(json["focus_mm"], 2000);
  EXPECT_EQ(json["distances_mm"], (nlohmann::json{1000.0, nullptr}));
  for (std::size_t node = 0; node < 12; ++node) {
    const auto& row = json["psfs"][node];
    const petzval::PsfKernel& kernel = set.kernels()[node];
    EXPECT_EQ(row["part"], petzval::psf_part_name(set.axes().point(node)));
    EXPECT_EQ(row["total"], kernel.total);
    EXPECT_EQ(row["anchor_mm"][1], kernel.anchor_mm.y);
    EXPECT_EQ(row["anchor"], "chief_ray");
    EXPECT_EQ(row["error"], kernel.error);
    EXPECT_GT(kernel.error, 0);
  }
  // The f/2 lens stopped down, and darker towards the edge.
  EXPECT_NEAR(set.kernels()[0].total, 4 / (2.8 * 2.8), 0.01);
  EXPECT_LT(set.kernels()[2].total, 0.95 * set.kernels()[0].total);
  const auto& error = json["interpolation_error"];
  EXPECT_EQ(error["points"], 2);
  EXPECT_GE(error["light_moved_percent"]["worst"], error["light_moved_percent"]["median"]);
  EXPECT_LT(error["noise_of_two_traced_percent"]["median"], error["light_moved_percent"]["worst"]);
}

TEST_F(PsfSets, ShardsEqualOneRunToTheBit) {
  const std::string exr = whole();
  for (const char* shard : {"1/3", "3/3"}) succeed(set("a", {"--shard", shard}));
  succeed(set("b", {"--shard", "2/3"}));
  EXPECT_FALSE(fs::exists(path("a/psf_set.exr")));
  succeed({"merge", path("a"), path("b"), "--out", path("ab.exr")});
  succeed({"merge", path("b"), path("a"), "--out", path("ba.exr")});
  EXPECT_EQ(read(path("ab.exr")), exr);
  EXPECT_EQ(read(path("ba.exr")), exr);
  auto merged = read_json(path("ab.json")), one = read_json(path("whole/psf_set.json"));
  merged.erase("exr"), one.erase("exr");
  EXPECT_EQ(merged, one);
  EXPECT_EQ(read(path("ab.svg")), read(path("whole/psf_set.svg")));
  // More shards than PSFs: some shards are empty.
  for (int i = 1; i <= 13; ++i) succeed(set("many", {"--shard", std::to_string(i) + "/13"}));
  succeed({"merge", path("many"), "--out", path("many.exr")});
  EXPECT_EQ(read(path("many.exr")), exr);
}

TEST_F(PsfSets, FaultyShardIsNamedAndRepaired) {
  const std::string exr = whole();
  for (const char* shard : {"1/4", "2/4", "4/4"}) succeed(set("s", {"--shard", shard}));
  expect_failure("psf-set", {"merge", path("s"), "--out", path("s.exr")},
                 {"shard 3/4", 3, "14deg_1000mm_587.5618nm_f2.8"});
  succeed(set("s", {"--shard", "3/4"}));
  const std::string corrupt = path("s/" + psf("7deg_inf"));  // the fifth PSF, which belongs to the first shard
  const std::string bytes = read(corrupt);
  const auto refused = [&](const std::string& content) {
    write("s/" + psf("7deg_inf"), content);
    expect_failure("psf-set", {"merge", path("s"), "--out", path("s.exr")}, {"shard 1/4", corrupt});
    EXPECT_FALSE(fs::exists(path("s.exr")));
    EXPECT_FALSE(fs::exists(path("s.json")));
  };
  refused(bytes.substr(0, bytes.size() / 2));
  refused("");
  refused(read(path("s/" + psf("0deg_inf"))));
  std::string changed = bytes;
  const std::size_t at = changed.find("throughput") + 25;
  changed[at] = static_cast<char>(changed[at] ^ 1);
  refused(changed);
  // A valid copy in another folder replaces the corrupt file; without a copy, its shard computes only this file again.
  succeed({"merge", path("s"), path("whole"), "--out", path("s.exr")});
  EXPECT_EQ(read(path("s.exr")), exr);
  const auto before = fs::last_write_time(path("s/" + psf("0deg_1000mm")));
  const auto outcome = run("psf-set", set("s", {"--shard", "1/4", "--resume"}));
  EXPECT_EQ(lines(outcome.out), std::vector{corrupt});
  EXPECT_NE(outcome.err.find("note: " + corrupt), std::string::npos) << outcome.err;
  EXPECT_EQ(fs::last_write_time(path("s/" + psf("0deg_1000mm"))), before);
  succeed({"merge", path("s"), "--out", path("s.exr")});
  EXPECT_EQ(read(path("s.exr")), exr);
}

TEST_F(PsfSets, KilledRunContinuesAfterItsLastCompletePsf) {
  const std::string exr = whole();
  std::string command = invocation("psf-set");
  for (const std::string& argument : set("killed")) command += " '" + argument + "'";
  const std::string psfs = path("killed/psfs");
  write("kill.sh", command + " > /dev/null & pid=$!\nwhile [ -z \"$(ls '" + psfs +
                       "')\" ] && kill -0 $pid; do :; done 2> /dev/null\n"
                       "kill -9 $pid 2> /dev/null\nwait $pid\nexit 0\n");
  ASSERT_EQ(std::system(("sh '" + path("kill.sh") + "' 2> /dev/null").c_str()), 0);
  std::set<std::pair<std::string, fs::file_time_type>> had;
  for (const auto& entry : fs::directory_iterator(psfs)) {
    if (entry.path().extension() == ".exr") had.insert({entry.path(), entry.last_write_time()});
  }
  EXPECT_FALSE(had.empty());
  succeed(set("killed", {"--resume"}));
  for (const auto& [file, time] : had) EXPECT_EQ(fs::last_write_time(file), time) << file;
  EXPECT_EQ(read(path("killed/psf_set.exr")), exr);
}

TEST_F(PsfSets, QueriesGiveNodesBitForBitAndPointsBetween) {
  whole();
  const std::string file = path("whole/psf_set.exr");
  succeed({"query", file, "--fields", "7", "--at", "inf", "--f-number", "4", "--out", path("node.exr")});
  const auto query = petzval::read_exr_parts(path("node.exr")),
             node = petzval::read_exr_parts(path("whole/psfs/7deg_inf_587.5618nm_f4.exr"));
  ASSERT_EQ(query.size(), 1u);
  EXPECT_EQ(query[0].numbers, node[0].numbers);
  EXPECT_EQ(query[0].texts.at("checksum"), node[0].texts.at("checksum"));
  succeed({"query", file, "--fields", "3", "--at", "1500", "--out", path("between.exr")});
  const auto [point, kernel] = petzval::from_exr_part(petzval::read_exr_parts(path("between.exr")).front());
  EXPECT_EQ(point.f_number, 2.8);
  EXPECT_EQ(point.wavelength_nm, 587.5618);
  EXPECT_GT(kernel.total, 0.4);
  const auto refused = [&](std::vector<std::string> more, const std::vector<petzval::testing::Token>& tokens) {
    more.insert(more.begin(), {"query", file});
    expect_failure("psf-set", more, tokens);
    EXPECT_FALSE(fs::exists(path("no.exr")) || fs::exists(path("no.svg")));
  };
  refused({"--fields", "15", "--at", "1500", "--out", path("no.exr")}, {"field_deg", 15});
  refused({"--fields", "3", "--at", "900", "--out", path("no.exr")}, {"distance_mm", 900});
  refused({"--fields", "3", "--at", "1500", "--wavelengths", "500", "--out", path("no.exr")},
          {"wavelength_nm", 500, 587.5618});
  refused({"--fields", "3", "--out", path("no.exr")}, {"--at"});
  refused({"--fields", "3", "--at", "1500", "--out", path("no.png")}, {"no.png", ".exr"});
  write("text.exr", "no picture");
  expect_failure("psf-set", {"query", path("text.exr"), "--fields", "3", "--at", "1500", "--out", path("no.exr")},
                 {path("text.exr")});
}

TEST_F(PsfSets, QueriesUseTheOriginOfTheSet) {
  succeed(set("film", {"--from", "film"}));
  const std::vector<std::string> query{"query", path("film/psf_set.exr"), "--fields", "7", "--at", "1000",
                                       "--out", path("psf.exr")};
  expect_failure("psf-set", query, {"--from", "front_vertex"});
  auto from_film = query;
  from_film.insert(from_film.end(), {"--from", "film"});
  succeed(from_film);
  EXPECT_EQ(petzval::read_exr_parts(path("psf.exr")).front().texts.at("distance_from"), "film");
}

TEST_F(PsfSets, RefusesTheFolderOfAnotherSet) {
  const std::string file = lens("double_gauss_100mm_f2_28deg"), job = path("set/job.json");
  succeed(set("set"));
  expect_failure("psf-set", {file, "--fields", "0", "--at", "1000", "--out", path("set")}, {job});
  expect_failure("psf-set", {file, "--fields", "0", "--at", "1000", "--resume", "--out", path("set")}, {job});
  write("set/job.json", "{");
  expect_failure("psf-set", {"merge", path("set"), "--out", path("no.exr")}, {job});
  expect_failure("psf-set", {"merge", path("nowhere"), "--out", path("no.exr")}, {"nowhere", "job.json"});
  expect_failure("psf-set", {"merge", "--out", path("no.exr")}, {"DIR"});
}

}  // namespace
