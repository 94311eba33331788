// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <variant>

#include "../expect_error.hpp"
#include "renderer/obj_mesh.hpp"
#include "support/files.hpp"

namespace {

using namespace renderer;
using petzval::testing::expect_error;
using petzval::testing::Token;

std::filesystem::path folder() {
  const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path result = std::filesystem::path(testing::TempDir()) / "petzval_scene_json" / test->name();
  std::filesystem::create_directories(result);
  return result;
}
std::filesystem::path file(const std::string& name, const std::string& text) {
  examples::write_text(folder() / name, text);
  return folder() / name;
}
SceneDescription scene(const std::string& text) { return read_scene(file("scene.json", text)); }

void refuses_scene(const std::string& text, const std::vector<Token>& tokens) {
  SCOPED_TRACE(text);
  expect_error([&] { scene(text); }, tokens);
}
void refuses_object(const std::string& text, const std::vector<Token>& tokens) {
  refuses_scene(R"({"objects": [{"sphere": {}}, {)" + text + "}]}", tokens);
}
void refuses_material(const std::string& text, const std::vector<Token>& tokens) {
  refuses_object(R"("sphere": {}, "material": )" + text, tokens);
}
void refuses_obj(const std::string& text, const std::vector<Token>& tokens) {
  SCOPED_TRACE(text);
  expect_error([&] { read_obj(file("mesh.obj", text)); }, tokens);
}

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

petzval::RgbImage image(float value) {
  petzval::RgbImage result(3, 2);
  for (float& v : result.pixels) v = 0.25f;
  result.pixel(1, 1)[2] = value;
  return result;
}

TEST(SceneJson, HasDocumentedDefaults) {
  const SceneDescription empty = scene("{}");
  EXPECT_TRUE(empty.objects.empty());
  EXPECT_EQ(empty.sky.colour, Rgb(0, 0, 0));
  EXPECT_EQ(empty.pose.position, glm::dvec3(0, 0, 0));
  EXPECT_EQ(empty.pose.look_at, glm::dvec3(0, 0, -1));
  EXPECT_EQ(empty.pose.up, glm::dvec3(0, 1, 0));
  EXPECT_EQ(scene(R"({"camera": {"position_mm": [5, 6, 7]}})").pose.look_at, glm::dvec3(5, 6, 6));

  const SceneDescription plain = scene(R"({"objects": [{"sphere": {}}, {"quad": {}},
    {"sphere": {}, "material": {"rough": {}}}, {"sphere": {}, "material": {"glass": {}}},
    {"sphere": {}, "material": {"varnish": {}}},
    {"sphere": {}, "material": {"diffuse": {"checker": [[1, 0, 0], [0, 1, 0]]}}}]})");
  ASSERT_EQ(plain.objects.size(), 6u);
  EXPECT_EQ(std::get<Sphere>(plain.objects[0].shape).radius, 1);
  EXPECT_EQ(plain.objects[0].emission, Rgb(0, 0, 0));
  EXPECT_EQ(std::get<Diffuse>(plain.objects[0].material).albedo.colour, Rgb(0.5f, 0.5f, 0.5f));
  EXPECT_EQ(std::get<Quad>(plain.objects[1].shape).edge_v, glm::vec3(0, 1, 0));
  EXPECT_EQ(std::get<Rough>(plain.objects[2].material).roughness, 0.2f);
  EXPECT_EQ(std::get<Glass>(plain.objects[3].material).ior, 1.5f);
  EXPECT_EQ(std::get<Varnish>(plain.objects[4].material).roughness, 0.1f);
  EXPECT_EQ(std::get<Diffuse>(plain.objects[5].material).albedo.checker->size_mm, 10);
}

TEST(SceneJson, ReadsEveryKey) {
  petzval::write_exr(image(0.75f), folder() / "picture.exr");
  file("mesh.obj", triangle + "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  const SceneDescription s = scene(R"({"sky": "picture.exr",
    "camera": {"position_mm": [1, 2, 3], "look_at_mm": [4, 5, 6], "up": [0, 0, 1]},
    "objects": [
      {"sphere": {"centre_mm": [1, 2, 3], "radius_mm": 4}, "material": {"mirror": [0.1, 0.2, 0.3]}, "emission": [5, 6, 7]},
      {"quad": {"corner_mm": [1, 2, 3], "edge_u_mm": [2, 0, 0], "edge_v_mm": [0, 0, 3]},
       "material": {"rough": {"reflectance": [0.1, 0.2, 0.3], "roughness": 0.4}}},
      {"obj": "mesh.obj", "material": {"diffuse": {"image": "picture.exr"}}},
      {"sphere": {}, "material": {"glass": {"ior": 1.7, "roughness": 0.05}}},
      {"sphere": {}, "material": {"varnish": {"diffuse": {"checker": [[1, 0, 0], [0, 1, 0]], "size_mm": 7}, "roughness": 0.3}}},
      {"sphere": {}, "material": {"diffuse": [0.1, 0.2, 0.3]}}]})");
  EXPECT_EQ(s.name, (folder() / "scene.json").string());
  EXPECT_EQ(s.sky.colour, Rgb(1, 1, 1));
  EXPECT_EQ(s.sky.image->pixel(1, 1)[2], 0.75f);
  EXPECT_EQ(s.pose.position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(s.pose.look_at, glm::dvec3(4, 5, 6));
  EXPECT_EQ(s.pose.up, glm::dvec3(0, 0, 1));
  ASSERT_EQ(s.objects.size(), 6u);
  EXPECT_EQ(s.objects[2].name, s.name + ": objects[2]");
  const auto& sphere = std::get<Sphere>(s.objects[0].shape);
  EXPECT_EQ(sphere.centre, glm::vec3(1, 2, 3));
  EXPECT_EQ(sphere.radius, 4);
  EXPECT_EQ(std::get<Mirror>(s.objects[0].material).reflectance, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(s.objects[0].emission, Rgb(5, 6, 7));
  const auto& quad = std::get<Quad>(s.objects[1].shape);
  EXPECT_EQ(quad.corner, glm::vec3(1, 2, 3));
  EXPECT_EQ(quad.edge_u, glm::vec3(2, 0, 0));
  EXPECT_EQ(quad.edge_v, glm::vec3(0, 0, 3));
  EXPECT_EQ(std::get<Rough>(s.objects[1].material).reflectance, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(std::get<Rough>(s.objects[1].material).roughness, 0.4f);
  EXPECT_EQ(std::get<Mesh>(s.objects[2].shape).triangles.size(), 1u);
  EXPECT_EQ(std::get<Diffuse>(s.objects[2].material).albedo.image->pixel(1, 1)[2], 0.75f);
  EXPECT_EQ(std::get<Glass>(s.objects[3].material).ior, 1.7f);
  EXPECT_EQ(std::get<Glass>(s.objects[3].material).roughness, 0.05f);
  const auto& varnish = std::get<Varnish>(s.objects[4].material);
  EXPECT_EQ(varnish.albedo.colour, Rgb(1, 0, 0));
  EXPECT_EQ(varnish.albedo.checker->other, Rgb(0, 1, 0));
  EXPECT_EQ(varnish.albedo.checker->size_mm, 7);
  EXPECT_EQ(varnish.roughness, 0.3f);
  EXPECT_EQ(std::get<Diffuse>(s.objects[5].material).albedo.colour, Rgb(0.1f, 0.2f, 0.3f));
}

TEST(SceneJson, RefusesInvalidScenes) {
  expect_error([] { read_scene(folder() / "missing.json"); }, {"missing.json", "No such file"});
  refuses_scene(R"({"objects": [)", {"scene.json", "JSON"});
  refuses_scene(R"({"sky": [NaN, 0, 0]})", {"scene.json", "JSON"});
  refuses_scene(R"({"sky": [1e999, 0, 0]})", {"scene.json", "JSON"});
  refuses_scene("[]", {"scene.json", "[]"});
  refuses_scene(R"({"skies": [0, 0, 0]})", {"scene.json", "\"skies\""});
  refuses_scene(R"({"sky": [0, 0, 0], "sky": [1, 1, 1]})", {"\"sky\""});
  refuses_scene(R"({"objects": {}})", {"scene.json", "objects", "{}"});
}

TEST(SceneJson, RefusesSkies) {
  refuses_scene(R"({"sky": [0, -1, 0]})", {"scene.json", "sky", "[0,-1,0]"});
  refuses_scene(R"({"sky": [0, 1]})", {"sky", "[0,1]"});
  refuses_scene(R"({"sky": [0, 1e39, 0]})", {"sky", "[0,1e+39,0]"});
  refuses_scene(R"({"sky": true})", {"sky", "true"});
  refuses_scene(R"({"sky": "none.exr"})", {"scene.json", "sky", "none.exr"});
  refuses_scene(R"({"sky": "sky.png"})", {"scene.json", "sky", "sky.png"});
  petzval::write_exr(image(-0.5f), folder() / "negative.exr");
  petzval::write_exr(image(std::numeric_limits<float>::quiet_NaN()), folder() / "nan.exr");
  refuses_scene(R"({"sky": "negative.exr"})", {"sky", "negative.exr", "pixel", 1, "-0.500000"});
  refuses_scene(R"({"sky": "nan.exr"})", {"nan.exr", "pixel", 1, "nan"});
}

TEST(SceneJson, RefusesCameras) {
  const auto refuses_camera = [](const std::string& text, const std::vector<Token>& tokens) {
    refuses_scene(R"({"camera": {)" + text + "}}", tokens);
  };
  refuses_camera(R"("position": [0, 0, 0])", {"scene.json", "camera", "\"position\""});
  refuses_camera(R"("position_mm": [0, 0])", {"camera.position_mm", "[0,0]"});
  refuses_camera(R"("position_mm": [1, 2, 3], "look_at_mm": [1, 2, 3])", {"camera", "look_at_mm", "position_mm"});
  refuses_camera(R"("look_at_mm": [0, -7, 0])", {"camera", "up"});
  refuses_camera(R"("up": [0, 0, 0])", {"camera", "up"});
}

TEST(SceneJson, RefusesShapes) {
  refuses_object(R"("emission": [1, 1, 1])", {"scene.json", "objects[1]", "sphere", "quad"});
  refuses_object(R"("sphere": {}, "quad": {})", {"objects[1]", "sphere", "quad"});
  refuses_object(R"("cube": {})", {"objects[1]", "\"cube\""});
  refuses_object(R"("sphere": 3)", {"objects[1].sphere", 3});
  refuses_object(R"("sphere": {"radius": 3})", {"objects[1].sphere", "\"radius\""});
  refuses_object(R"("sphere": {"radius_mm": 0})", {"objects[1].sphere.radius_mm", 0});
  refuses_object(R"("sphere": {"radius_mm": -2})", {"radius_mm", -2});
  refuses_object(R"("sphere": {"radius_mm": "2"})", {"radius_mm", "\"2\""});
  refuses_object(R"("quad": {"edge_u_mm": [0, 3, 0]})", {"objects[1].quad", "edges"});
  refuses_object(R"("quad": {"edge_u_mm": [0, 0, 0]}, "emission": [1, 1, 1])", {"objects[1].quad", "area"});
  refuses_object(R"("quad": {"corner_mm": [0, 0, null]})", {"quad.corner_mm", "[0,0,null]"});
  refuses_object(R"("obj": 3)", {"objects[1].obj", 3});
  refuses_object(R"("obj": "none.obj")", {"scene.json", "objects[1].obj", "none.obj", "No such file"});
  file("line.obj", triangle + "f 1 2 2\n");
  refuses_object(R"("obj": "line.obj")", {"scene.json", "objects[1].obj", "line.obj", 1});
  refuses_object(R"("sphere": {}, "emission": [1, -1, 1])", {"objects[1].emission", "[1,-1,1]"});
}

TEST(SceneJson, RefusesMaterials) {
  refuses_material("{}", {"objects[1].material", "{}"});
  refuses_material("[1, 1, 1]", {"objects[1].material", "[1,1,1]"});
  refuses_material(R"({"metal": {}})", {"objects[1].material", "\"metal\""});
  refuses_material(R"({"mirror": [1, 1, 1], "glass": {}})", {"objects[1].material", "mirror", "glass"});
  refuses_material(R"({"mirror": [1, 1, 1.5]})", {"objects[1].material.mirror", "[1,1,1.5]"});
  refuses_material(R"({"diffuse": [-0.1, 1, 1]})", {"objects[1].material.diffuse", "[-0.1,1,1]", 0, 1});
  refuses_material(R"({"diffuse": {}})", {"objects[1].material.diffuse", "{}"});
  refuses_material(R"({"diffuse": {"chequer": []}})", {"material.diffuse", "\"chequer\""});
  refuses_material(R"({"diffuse": {"checker": [[1, 1, 1]]}})", {"diffuse.checker", "[[1,1,1]]"});
  refuses_material(R"({"diffuse": {"checker": [[1, 1, 1], [1, 2, 1]]}})", {"diffuse.checker[1]", "[1,2,1]"});
  refuses_material(R"({"diffuse": {"checker": [[1, 1, 1], [1, 1, 1]], "size_mm": 0}})", {"diffuse.size_mm", 0});
  refuses_material(R"({"diffuse": {"image": "x.exr", "checker": []}})", {"diffuse", "checker", "image"});
  refuses_material(R"({"diffuse": {"image": "x.exr", "size_mm": 2}})", {"diffuse", "size_mm", "image"});
  refuses_material(R"({"diffuse": {"image": "wood.png"}})", {"diffuse.image", "wood.png"});
  refuses_material(R"({"diffuse": {"image": "none.exr"}})", {"diffuse.image", "none.exr"});
  petzval::write_exr(image(1.5f), folder() / "bright.exr");
  refuses_material(R"({"diffuse": {"image": "bright.exr"}})", {"diffuse.image", "bright.exr", "pixel", 1, "1.500000"});
  refuses_material(R"({"rough": {"alpha": 1}})", {"objects[1].material.rough", "\"alpha\""});
  refuses_material(R"({"rough": {"reflectance": [2, 0, 0]}})", {"material.rough.reflectance", "[2,0,0]"});
  refuses_material(R"({"rough": {"roughness": 0}})", {"material.rough.roughness", 0});
  refuses_material(R"({"glass": {"n": 1.5}})", {"material.glass", "\"n\""});
  refuses_material(R"({"glass": {"ior": 1}})", {"material.glass.ior", 1});
  refuses_material(R"({"glass": {"roughness": 0.001}})", {"material.glass.roughness", 0.001});
  refuses_material(R"({"varnish": {"rough": 1}})", {"material.varnish", "\"rough\""});
  refuses_material(R"({"varnish": {"roughness": 2}})", {"material.varnish.roughness", 2});
  refuses_material(R"({"varnish": {"diffuse": 1}})", {"material.varnish.diffuse", 1});

  petzval::write_exr(image(0.5f), folder() / "good.exr");
  file("bare.obj", triangle + "f 1 2 3\n");
  refuses_object(R"("obj": "bare.obj", "material": {"diffuse": {"image": "good.exr"}})", {"objects[1].obj", "texture"});
}

TEST(ReadObj, CutsFacesIntoTrianglesAndCountsIndicesFromBothEnds) {
  const Mesh mesh = read_obj(
      file("mesh.obj", "# a square\nv 0 0 0\nv 2 0 0\r\nv 2 2 0 1.0\nv +0 2e0 0 # comment\ng one\nf 1 2 -2 -1\n"));
  EXPECT_EQ(mesh.positions.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
  glm::vec3 area{0, 0, 0};
  for (const auto& [a, b, c] : mesh.triangles)
    area += 0.5f * glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
  EXPECT_EQ(area, glm::vec3(0, 0, 4));
}

TEST(ReadObj, CornersWithoutNormalGetTheTriangleNormal) {
  const Mesh mesh = read_obj(file("mesh.obj", triangle + "v 0 0 5\nvn 0 3 4\nf 1//1 2//1 3//1\nf 1 2 4\n"));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const auto i : mesh.triangles[0]) EXPECT_LT(glm::distance(mesh.normals[i], {0, 0.6f, 0.8f}), 1e-6);
  for (const auto i : mesh.triangles[1]) EXPECT_EQ(mesh.normals[i], glm::vec3(0, -1, 0));
}

TEST(ReadObj, RefusesBrokenMeshes) {
  expect_error([] { read_obj(folder() / "none.obj"); }, {"none.obj", "No such file"});
  refuses_obj("", {"mesh.obj", "face"});
  refuses_obj(triangle, {"mesh.obj", "face"});
  refuses_obj(triangle + "f 1 2\n", {"mesh.obj", "line 4", 2});
  refuses_obj("v 0 nan 0\n", {"mesh.obj", "line 1", "\"nan\""});
  refuses_obj("v 0 0 0\nv 0 -inf 0\n", {"line 2", "\"-inf\""});
  refuses_obj("v 0 0 1e39\n", {"line 1", "\"1e39\""});
  refuses_obj("v 0 0 0x\n", {"line 1", "\"0x\""});
  refuses_obj("v 0 0\n", {"line 1", 2});
  refuses_obj("vn 0 0 nan\n", {"line 1", "\"nan\""});
  refuses_obj("vt nan\n", {"line 1", "\"nan\""});
  refuses_obj(triangle + "f 1 2 9\n", {"mesh.obj", "line 4", "vertex", 9});
  refuses_obj(triangle + "f 1 2 0\n", {"line 4", "vertex", 0});
  refuses_obj(triangle + "f 1 2 -4\n", {"line 4", "vertex", -4});
  refuses_obj(triangle + "f 1//1 2//1 3//1\n", {"line 4", "normal", 1});
  refuses_obj(triangle + "vt 0 0\nf 1/1 2/2 3/1\n", {"line 5", "texture", 2});
  refuses_obj(triangle + "f 1 2 x\n", {"line 4", "\"x\""});
  refuses_obj(triangle + "vn 0 0 0\nf 1//1 2//1 3//1\n", {"mesh.obj", "normal", 0});
  refuses_obj(triangle + "v 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 3\n", {"mesh.obj", 2, 3});
}

}  // namespace
