// SPDX-License-Identifier: Apache-2.0
#include "viewer/worker.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

namespace viewer {
namespace {

/// The state of a worker when it has computed everything.
std::shared_ptr<const Snapshot> rest(const Worker& worker) {
  for (int i = 0; i < 3000 && !worker.idle(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(worker.idle());
  return worker.snapshot();
}

TEST(ViewWorker, DrawingsFollowChangesWhileTheMouseRests) {
  SessionOptions options;
  options.input.scene = "town", options.input.width = 160, options.input.height = 120;
  options.setup.lens.thin_mm = 50, options.setup.f_number = 1;
  Worker worker(options, nullptr);
  worker.look_at({25, 40});
  const auto round = rest(worker);
  worker.send({{"type", "setup"}, {"setup", {{"f_number", 1.6}}}});
  const auto small = rest(worker);
  EXPECT_NEAR(small->bokeh.width_px / round->bokeh.width_px, 0.625, 0.03);
  EXPECT_NE(*small->blur, *round->blur);
  worker.send({{"type", "setup"}, {"setup", {{"iris", {{"blades", 5}}}}}});
  EXPECT_NE(rest(worker)->bokeh.values, small->bokeh.values);

  // A lens that cannot serve the picture: no picture and no map are shown as its own.
  worker.send({{"type", "setup"}, {"setup", {{"f_number", 0.5}, {"lens", {{"thin_mm", 5000}}}}}});
  const auto huge = rest(worker);
  EXPECT_NE(huge->problem, "");
  EXPECT_FALSE(huge->frame.still);
  EXPECT_FALSE(huge->blur);
  worker.send({{"type", "undo"}});
  const auto again = rest(worker);
  EXPECT_EQ(again->problem, "");
  EXPECT_TRUE(again->frame.still);
  EXPECT_TRUE(again->blur);
}

}  // namespace
}  // namespace viewer
