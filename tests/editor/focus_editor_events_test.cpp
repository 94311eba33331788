// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstddef>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "../expect_error.hpp"
#include "editor_scene.hpp"

namespace petzval {
namespace {

using testing::numbers;
using testing::patch;
using testing::thin_50;
using testing::wall_scene;

/// Random events of all types, most of them valid.
class RandomEvents {
 public:
  explicit RandomEvents(unsigned seed) : engine_(seed) {}

  std::string next() {
    switch (engine_() % 20) {
      case 0:
      case 1: return R"({"type": "add_point", "pixel": [)" + real(0, 800) + ", " + real(0, 600) + "]}";
      case 2:
        return R"({"type": "add_point", "position_mm": [)" + real(-900, 900) + ", " + real(-900, 900) + ", " +
               real(-9000, 20) + R"(], "blur_px": )" + real(-5, 5) + "}";
      case 3:
      case 4:
        return R"({"type": "move_point", "id": ")" + id() + R"(", "pixel": [)" + real(0, 800) + ", " + real(0, 600) +
               R"(], "continues": )" + (engine_() % 2 ? "true}" : "false}");
      case 5:
        return R"({"type": "set_point", "id": ")" + id() + R"(", "weight": )" + real(0, 3) + R"(, "extent_stops": )" +
               (engine_() % 2 ? real(-2, 2) : "null") + "}";
      case 6: return R"({"type": "remove_point", "id": ")" + id() + R"("})";
      case 7:
      case 8: {
        static const char* const all[] = {"distance", "film", "tilt", "surface"};
        return std::string(R"({"type": "serve", "by": ")") + all[engine_() % 4] + "\"}";
      }
      case 9: return patch(R"({"focus_mm": )" + real(60, 9000) + "}");
      case 10: return patch(R"({"f_number": )" + real(2, 16) + "}");
      case 11: return patch(R"({"iris": {"blades": )" + std::to_string(engine_() % 9) + "}}");
      case 12: return patch(R"({"camera": {"bokeh": {"lens_ratio": )" + real(0.7, 1.4) + "}}}");
      case 13:
        return patch(R"({"camera": {"expressive": {"power": [{"radius": 1, "power": )" + real(0.99, 1.01) + "}]}}}");
      case 14: return patch(R"({"f_number": 2, "lens": {"thin_mm": )" + real(30, 90) + "}}");
      case 15: return patch(R"({"film": {"tilt_rad": )" + real(-0.1, 0.1) + "}}");
      case 16: return R"({"type": "key", "time_s": )" + std::to_string(engine_() % 5) + "}";
      case 17: return R"({"type": "time", "time_s": )" + real(0, 5) + "}";
      case 18: return R"({"type": "undo"})";
      default: return engine_() % 2 ? R"({"type": "redo"})" : R"({"type": "weighting", "nearer": true})";
    }
  }

 private:
  std::string real(double least, double most) {
    return std::to_string(least + (most - least) * static_cast<double>(engine_() % 1000000) / 1e6);
  }
  std::string id() { return std::to_string(1 + engine_() % 12); }
  std::mt19937 engine_;
};

/// Applies random events; refused events change nothing.
FocusEditor after_random_events(unsigned seed, int count) {
  FocusEditor editor(wall_scene(), thin_50());
  RandomEvents events(seed);
  for (int i = 0; i < count; ++i) {
    const std::string log = editor.log();
    const std::string event = editor.state().targets.size() > 11
                                  ? R"({"type": "remove_point", "id": ")" + editor.state().targets[0].id + R"("})"
                                  : events.next();
    const std::vector<double> before = numbers(editor.state());
    try {
      editor.apply(event);
    } catch (const Error&) {
      EXPECT_EQ(numbers(editor.state()), before) << event;
      EXPECT_EQ(editor.log(), log);
    }
  }
  return editor;
}

TEST(FocusEditorEvents, ReplayGivesTheSameStateToTheBit) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    FocusEditor editor = after_random_events(seed, 600);
    FocusEditor again(wall_scene(), thin_50());
    again.replay(editor.log());
    EXPECT_EQ(numbers(again.state()), numbers(editor.state())) << seed;
    EXPECT_EQ(again.log(), editor.log());
  }
}

TEST(FocusEditorEvents, ThreadsDoNotChangeTheState) {
  const std::string log = after_random_events(9, 300).log();
  std::vector<std::vector<double>> found(2);
  std::vector<std::thread> threads;
  for (std::vector<double>& result : found) {
    threads.emplace_back([&] {
      FocusEditor editor(wall_scene(), thin_50());
      editor.replay(log);
      result = numbers(editor.state());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(found[0], found[1]);
}

TEST(FocusEditorEvents, UndoLeadsBackToTheStart) {
  FocusEditor editor = after_random_events(5, 400);
  int steps = 0;
  for (; editor.can_undo(); ++steps) editor.apply(R"({"type": "undo"})");
  EXPECT_GT(steps, 100);
  EXPECT_EQ(numbers(editor.state()), numbers(FocusEditor(wall_scene(), thin_50()).state()));
  for (; editor.can_redo(); --steps) editor.apply(R"({"type": "redo"})");
  EXPECT_GE(0, steps);  // events that were undone before count too
  EXPECT_THROW(editor.apply(R"({"type": "redo"})"), Error);
}

// An event that adds a point costs the point and a reference to each other point, not all points again (640 MB here).
TEST(FocusEditorEvents, StepsOfUndoSharePoints) {
  FocusEditor editor(wall_scene(), thin_50());
  const auto bytes = [] {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  const double before = bytes();
  constexpr int count = 1500;
  for (int i = 0; i < count; ++i) {
    editor.apply(R"({"type": "add_point", "position_mm": [0, 0, )" + std::to_string(-2000 - i) + "]}");
  }
  EXPECT_LT(bytes() - before, 40e6);
  for (int i = 0; i < 3; ++i) editor.apply(R"({"type": "undo"})");
  EXPECT_EQ(editor.state().targets.size(), std::size_t{count - 3});
  EXPECT_NEAR(editor.state().focus_mm, 2000 + count - 4, 1e-6);
}

TEST(FocusEditorEvents, DraggingIsOneStepOfUndo) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "add_point", "id": "a", "pixel": [400, 300]})");
  const std::vector<double> before = numbers(editor.state());
  editor.apply(R"({"type": "move_point", "id": "a", "pixel": [410, 300]})");
  for (int x = 420; x < 700; x += 10) {
    editor.apply(R"({"type": "move_point", "id": "a", "pixel": [)" + std::to_string(x) +
                 R"(, 300], "continues": true})");
  }
  EXPECT_NE(numbers(editor.state()), before);
  editor.apply(R"({"type": "undo"})");
  EXPECT_EQ(numbers(editor.state()), before);
}

TEST(FocusEditorEvents, RefusedEventsNameTheKeyAndTheRule) {
  FocusEditor editor(wall_scene(), thin_50());
  editor.apply(R"({"type": "add_point", "id": "eye", "pixel": [400, 300]})");
  const std::vector<double> before = numbers(editor.state());
  const std::pair<const char*, std::vector<std::string>> cases[] = {
      {"[1, 2]", {"list", "object"}},
      {"{\"type\": ", {"JSON"}},
      {R"({"kind": "focus"})", {"type", "missing"}},
      {R"({"type": "zoom"})", {"zoom", "add_point", "redo"}},
      {R"({"type": "time"})", {"time_s", "missing"}},
      {R"({"type": "time", "time_s": 3, "unit": "ms"})", {"unit", "unknown", "time_s"}},
      {R"({"type": "setup", "setup": 3})", {"setup", "3", "object"}},
      {R"({"type": "setup", "setup": {"f_number": 2, "stops": 3}})", {"stops", "unknown", "f_number"}},
      {R"({"type": "setup", "setup": {"focus_mm": -3}})", {"setup:1:28", "focus_mm", "-3", "above 0"}},
      {R"({"type": "setup", "setup": {"focus_mm": 20}})", {"20"}},
      {R"({"type": "setup", "setup": {"f_number": "2.8"}})", {"f_number", "2.8"}},
      {R"({"type": "setup", "setup": {"film": {"width_mm": 30}}})", {"film.width_mm", "30", "left out"}},
      {R"({"type": "add_point", "id": "eye", "pixel": [1, 2]})", {"eye", "unused"}},
      {R"({"type": "add_point", "pixel": [900, 2]})", {"pixel", "900", "800"}},
      {R"({"type": "add_point"})", {"neither", "pixel", "position_mm"}},
      {R"({"type": "add_point", "pixel": [1, 2], "position_mm": [1, 2, 3]})", {"both"}},
      {R"({"type": "add_point", "position_mm": [0, 0, 0], "at_infinity": true})", {"direction"}},
      {R"({"type": "add_point", "pixel": [1, 2], "weight": -1})", {"weight", "-1"}},
      {R"({"type": "set_point", "id": "eye", "extent_stops": 99})", {"extent_stops", "99", "20"}},
      {R"({"type": "move_point", "id": "ear", "pixel": [1, 2]})", {"ear", "eye"}},
      {R"({"type": "serve", "by": "magic"})", {"magic", "surface"}},
      {R"({"type": "setup", "setup": {"iris": {"blades": 2}}})", {"blades", "2"}},
      {R"({"type": "setup", "setup": {"lens": {"file": "achromat_100mm"}}})", {"file", "thin_mm"}},
      {R"({"type": "setup", "setup": {"f_number": null}})", {"f_number", "missing"}},
      {R"({"type": "setup", "setup": {"film": {"tilt_rad": 1.5}}})", {"tilt_rad", "1.5", "pi/3"}},
      {R"({"type": "redo"})", {"redo", "no event"}},
  };
  for (const auto& [event, words] : cases) {
    try {
      editor.apply(event);
      ADD_FAILURE() << event << " was accepted";
    } catch (const Error& error) {
      for (const std::string& word : words) {
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what() << " lacks " << word;
      }
    }
    EXPECT_EQ(numbers(editor.state()), before) << event;
  }
  try {
    editor.replay(R"([{"type": "still"}, {"type": "zoom"}])");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("event 2"), std::string::npos);
  }
}

}  // namespace
}  // namespace petzval
