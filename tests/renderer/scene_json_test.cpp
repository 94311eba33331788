// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <variant>

#include "petzval/core/error.hpp"
#include "renderer/obj_mesh.hpp"
#include "support/files.hpp"

namespace {

using namespace renderer;

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

/// The message has all parts, in this order.
template <class Call>
void refuses(Call call, std::initializer_list<std::string> parts) {
  try {
    call();
    FAIL() << "accepted, wanted an Error with " << *parts.begin();
  } catch (const petzval::Error& error) {
    const std::string message = error.what();
    std::size_t from = 0;
    for (const std::string& part : parts) {
      const std::size_t at = message.find(part, from);
      ASSERT_NE(at, std::string::npos) << message << "\nhas no \"" << part << '"';
      from = at + part.size();
    }
  }
}
void refuses_scene(const std::string& text, std::initializer_list<std::string> parts) {
  SCOPED_TRACE(text);
  refuses([&] { scene(text); }, parts);
}
void refuses_object(const std::string& text, std::initializer_list<std::string> parts) {
  refuses_scene(R"({"objects": [{"sphere": {}}, {)" + text + "}]}", parts);
}
void refuses_material(const std::string& text, std::initializer_list<std::string> parts) {
  refuses_object(R"("sphere": {}, "material": )" + text, parts);
}
void refuses_obj(const std::string& text, std::initializer_list<std::string> parts) {
  SCOPED_TRACE(text);
  refuses([&] { read_obj(file("mesh.obj", text)); }, parts);
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

TEST(SceneJson, RefusesWhatIsNoScene) {
  refuses([] { read_scene(folder() / "missing.json"); }, {"missing.json", "cannot be opened"});
  refuses_scene(R"({"objects": [)", {"scene.json: not JSON"});
  refuses_scene(R"({"sky": [NaN, 0, 0]})", {"scene.json: not JSON"});
  refuses_scene(R"({"sky": [1e999, 0, 0]})", {"scene.json: not JSON"});
  refuses_scene("[]", {"scene.json: found []", "wanted an object with sky, camera and objects"});
  refuses_scene(R"({"skies": [0, 0, 0]})", {"scene.json: found the key \"skies\", wanted sky, camera and objects"});
  refuses_scene(R"({"sky": [0, 0, 0], "sky": [1, 1, 1]})", {"\"sky\" twice"});
  refuses_scene(R"({"objects": {}})", {"scene.json: objects: found {}, wanted a list"});
}

TEST(SceneJson, RefusesSkies) {
  refuses_scene(R"({"sky": [0, -1, 0]})", {"scene.json: sky: found [0,-1,0]", "0 or more"});
  refuses_scene(R"({"sky": [0, 1]})", {"sky: found [0,1], wanted a list of three"});
  refuses_scene(R"({"sky": [0, 1e39, 0]})", {"sky: found [0,1e+39,0]", "finite"});
  refuses_scene(R"({"sky": true})", {"sky: found true"});
  refuses_scene(R"({"sky": "none.exr"})", {"scene.json: sky: ", "none.exr"});
  refuses_scene(R"({"sky": "sky.png"})", {"scene.json: sky: found", "sky.png", "wanted an EXR file"});
  petzval::write_exr(image(-0.5f), folder() / "negative.exr");
  petzval::write_exr(image(std::numeric_limits<float>::quiet_NaN()), folder() / "nan.exr");
  refuses_scene(R"({"sky": "negative.exr"})", {"sky: ", "negative.exr: pixel (1, 1): found -0.5", "0 or more"});
  refuses_scene(R"({"sky": "nan.exr"})", {"nan.exr: pixel (1, 1): found nan", "finite"});
}

TEST(SceneJson, RefusesCameras) {
  const auto refuses_camera = [](const std::string& text, std::initializer_list<std::string> parts) {
    refuses_scene(R"({"camera": {)" + text + "}}", parts);
  };
  refuses_camera(R"("position": [0, 0, 0])", {"scene.json: camera: found the key \"position\", wanted position_mm"});
  refuses_camera(R"("position_mm": [0, 0])", {"camera.position_mm: found [0,0], wanted a list of three"});
  refuses_camera(R"("position_mm": [1, 2, 3], "look_at_mm": [1, 2, 3])",
                 {"camera: found", "look_at_mm away from position_mm"});
  refuses_camera(R"("look_at_mm": [0, -7, 0])", {"camera: found", "wanted up across"});
  refuses_camera(R"("up": [0, 0, 0])", {"camera: found", "wanted up across"});
}

TEST(SceneJson, RefusesShapes) {
  refuses_object(R"("emission": [1, 1, 1])",
                 {"scene.json: objects[1]: found no shape, wanted one of sphere, quad and obj"});
  refuses_object(R"("sphere": {}, "quad": {})", {"objects[1]: found both sphere and quad"});
  refuses_object(R"("cube": {})", {"objects[1]: found the key \"cube\", wanted sphere, quad or obj"});
  refuses_object(R"("sphere": 3)", {"objects[1].sphere: found 3, wanted an object"});
  refuses_object(R"("sphere": {"radius": 3})",
                 {"objects[1].sphere: found the key \"radius\", wanted centre_mm and radius_mm"});
  refuses_object(R"("sphere": {"radius_mm": 0})", {"objects[1].sphere.radius_mm: found 0, wanted a number above 0"});
  refuses_object(R"("sphere": {"radius_mm": -2})", {"radius_mm: found -2"});
  refuses_object(R"("sphere": {"radius_mm": "2"})", {"radius_mm: found \"2\""});
  refuses_object(R"("quad": {"edge_u_mm": [0, 3, 0]})", {"objects[1].quad: found", "edges that span an area"});
  refuses_object(R"("quad": {"edge_u_mm": [0, 0, 0]}, "emission": [1, 1, 1])", {"objects[1].quad: found", "area"});
  refuses_object(R"("quad": {"corner_mm": [0, 0, null]})", {"quad.corner_mm: found [0,0,null]"});
  refuses_object(R"("obj": 3)", {"objects[1].obj: found 3, wanted the name of a file"});
  refuses_object(R"("obj": "none.obj")", {"scene.json: objects[1].obj: ", "none.obj: cannot be opened"});
  file("line.obj", triangle + "f 1 2 2\n");
  refuses_object(R"("obj": "line.obj")",
                 {"scene.json: objects[1].obj: ", "line.obj: found 1 of 1 triangles without area"});
  refuses_object(R"("sphere": {}, "emission": [1, -1, 1])", {"objects[1].emission: found [1,-1,1]", "0 or more"});
}

TEST(SceneJson, RefusesMaterials) {
  refuses_material("{}", {"objects[1].material: found {}, wanted diffuse, mirror, rough, glass or varnish"});
  refuses_material("[1, 1, 1]", {"objects[1].material: found [1,1,1], wanted an object with diffuse"});
  refuses_material(R"({"metal": {}})", {"objects[1].material: found the key \"metal\""});
  refuses_material(R"({"mirror": [1, 1, 1], "glass": {}})", {"objects[1].material: found both mirror and glass"});
  refuses_material(R"({"mirror": [1, 1, 1.5]})", {"objects[1].material.mirror: found [1,1,1.5]", "from 0 to 1"});
  refuses_material(R"({"diffuse": [-0.1, 1, 1]})", {"objects[1].material.diffuse: found [-0.1,1,1]", "from 0 to 1"});
  refuses_material(R"({"diffuse": {}})", {"objects[1].material.diffuse: found {}, wanted a list of three numbers"});
  refuses_material(R"({"diffuse": {"chequer": []}})", {"material.diffuse: found the key \"chequer\""});
  refuses_material(R"({"diffuse": {"checker": [[1, 1, 1]]}})",
                   {"diffuse.checker: found [[1,1,1]], wanted a list of two"});
  refuses_material(R"({"diffuse": {"checker": [[1, 1, 1], [1, 2, 1]]}})", {"diffuse.checker[1]: found [1,2,1]"});
  refuses_material(R"({"diffuse": {"checker": [[1, 1, 1], [1, 1, 1]], "size_mm": 0}})", {"diffuse.size_mm: found 0"});
  refuses_material(R"({"diffuse": {"image": "x.exr", "checker": []}})", {"diffuse: found both checker and image"});
  refuses_material(R"({"diffuse": {"image": "x.exr", "size_mm": 2}})", {"diffuse: found size_mm with image"});
  refuses_material(R"({"diffuse": {"image": "wood.png"}})", {"diffuse.image: found", "wood.png", "wanted an EXR file"});
  refuses_material(R"({"diffuse": {"image": "none.exr"}})", {"diffuse.image: ", "none.exr"});
  petzval::write_exr(image(1.5f), folder() / "bright.exr");
  refuses_material(R"({"diffuse": {"image": "bright.exr"}})",
                   {"diffuse.image: ", "bright.exr: pixel (1, 1): found 1.5", "an albedo from 0 to 1"});
  refuses_material(R"({"rough": {"alpha": 1}})", {"objects[1].material.rough: found the key \"alpha\""});
  refuses_material(R"({"rough": {"reflectance": [2, 0, 0]}})", {"material.rough.reflectance: found [2,0,0]"});
  refuses_material(R"({"rough": {"roughness": 0}})",
                   {"material.rough.roughness: found 0, wanted a number from 0.01 to 1"});
  refuses_material(R"({"glass": {"n": 1.5}})", {"material.glass: found the key \"n\", wanted ior and roughness"});
  refuses_material(R"({"glass": {"ior": 1}})", {"material.glass.ior: found 1, wanted a number from 1.001 to 4"});
  refuses_material(R"({"glass": {"roughness": 0.001}})", {"material.glass.roughness: found 0.001", "0.01 to 1, or 0"});
  refuses_material(R"({"varnish": {"rough": 1}})", {"material.varnish: found the key \"rough\""});
  refuses_material(R"({"varnish": {"roughness": 2}})", {"material.varnish.roughness: found 2"});
  refuses_material(R"({"varnish": {"diffuse": 1}})", {"material.varnish.diffuse: found 1"});

  petzval::write_exr(image(0.5f), folder() / "good.exr");
  file("bare.obj", triangle + "f 1 2 3\n");
  refuses_object(R"("obj": "bare.obj", "material": {"diffuse": {"image": "good.exr"}})",
                 {"objects[1].obj: found corners without texture coordinates"});
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

TEST(ReadObj, GivesCornersWithoutNormalThatOfTheirTriangle) {
  const Mesh mesh = read_obj(file("mesh.obj", triangle + "v 0 0 5\nvn 0 3 4\nf 1//1 2//1 3//1\nf 1 2 4\n"));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const auto i : mesh.triangles[0]) EXPECT_LT(glm::distance(mesh.normals[i], {0, 0.6f, 0.8f}), 1e-6);
  for (const auto i : mesh.triangles[1]) EXPECT_EQ(mesh.normals[i], glm::vec3(0, -1, 0));
}

TEST(ReadObj, RefusesBrokenMeshes) {
  refuses([] { read_obj(folder() / "none.obj"); }, {"none.obj: cannot be opened"});
  refuses_obj("", {"mesh.obj: found no face"});
  refuses_obj(triangle, {"mesh.obj: found no face, wanted a mesh of one triangle or more"});
  refuses_obj(triangle + "f 1 2\n", {"mesh.obj: line 4: found a face of 2 corners, wanted 3 or more"});
  refuses_obj("v 0 nan 0\n", {"mesh.obj: line 1: found \"nan\", wanted a finite number"});
  refuses_obj("v 0 0 0\nv 0 -inf 0\n", {"line 2: found \"-inf\""});
  refuses_obj("v 0 0 1e39\n", {"line 1: found \"1e39\""});
  refuses_obj("v 0 0 0x\n", {"line 1: found \"0x\""});
  refuses_obj("v 0 0\n", {"line 1: found 2 numbers, wanted 3"});
  refuses_obj("vn 0 0 nan\n", {"line 1: found \"nan\""});
  refuses_obj("vt nan\n", {"line 1: found \"nan\""});
  refuses_obj(triangle + "f 1 2 9\n", {"mesh.obj: line 4: found vertex 9, wanted 1 to 3"});
  refuses_obj(triangle + "f 1 2 0\n", {"line 4: found vertex 0"});
  refuses_obj(triangle + "f 1 2 -4\n", {"line 4: found vertex -4"});
  refuses_obj(triangle + "f 1//1 2//1 3//1\n", {"line 4: found normal 1, wanted none"});
  refuses_obj(triangle + "vt 0 0\nf 1/1 2/2 3/1\n", {"line 5: found texture coordinate 2, wanted 1 to 1"});
  refuses_obj(triangle + "f 1 2 x\n", {"line 4: found \"x\", wanted indices"});
  refuses_obj(triangle + "vn 0 0 0\nf 1//1 2//1 3//1\n", {"mesh.obj: found a normal of length 0"});
  refuses_obj(triangle + "v 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 3\n",
              {"mesh.obj: found 2 of 3 triangles without area, the first is triangle 2, wanted none"});
}

}  // namespace
