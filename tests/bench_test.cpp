// What `oclair bench` measures with: meshes, rays, tables, processes. Not the times.
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "../host/bench/child.h"
#include "../host/bench/our_traversal.h"
#include "../host/bench/rays.h"
#include "../host/bench/recorded_rays.h"
#include "../host/bench/table.h"
#include "../host/bench/terrain.h"
#include "../host/bench/terrain_file.h"
#include "../host/error.h"
#include "../host/reader.h"
#include "embree_oracle.h"
#include "program.h"
#include "temporary_directory.h"

using namespace oclair;
using namespace oclair::test;
using namespace oclair::bench;

namespace {

// Each directed edge belongs to one triangle and its reverse to another: closed, and of one orientation throughout.
void expect_closed(const Mesh& mesh) {
  std::map<std::pair<uint, uint>, int> edges;
  for (const glm::uvec3& t : mesh.triangles) {
    ASSERT_TRUE(t.x < mesh.positions.size() && t.y < mesh.positions.size() && t.z < mesh.positions.size());
    ++edges[{t.x, t.y}], ++edges[{t.y, t.z}], ++edges[{t.z, t.x}];
  }
  std::size_t wrong = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    wrong += edge.first == edge.second || count != 1 || back == edges.end();
  }
  EXPECT_EQ(wrong, 0u) << "of " << edges.size() << " edges";
}

double furthest(const Mesh& mesh) {
  double most = 0.0;
  for (const glm::dvec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) most = std::max(most, std::abs(p[axis]));
  return most;
}

struct Prepared {
  Scene scene;
  EmbreeScene oracle;
  std::vector<RaySet> sets;

  explicit Prepared(std::size_t triangles)
      : scene(place_scene(bench::world_of(terrain(triangles)))),
        oracle(scene),
        sets(ray_sets(scene, [this](const auto& rays) { return closest(rays); })) {}

  std::vector<Hit> closest(const std::vector<Ray>& rays) const {
    std::vector<Hit> hits;
    for (const Ray& ray : rays) hits.push_back(oracle.closest(ray));
    return hits;
  }
};

const Prepared& prepared() {
  static const Prepared once(20'000);
  return once;
}

Row row(const std::string& name) { return {name, "s", 1.5, 3.0, Spread{2.0, 1.75, 2.25}}; }

}  // namespace

TEST(bench_test, terrain_is_closed_lies_in_its_box_and_has_the_asked_number_of_triangles) {
  for (const std::size_t n :
       {least_triangles, std::size_t{1001}, std::size_t{5000}, std::size_t{20'000}, std::size_t{70'001}}) {
    const Mesh mesh = terrain(n);
    EXPECT_EQ(mesh.triangles.size(), n - n % 2);
    EXPECT_EQ(furthest(mesh), 1.0);
    expect_closed(mesh);
  }
}

TEST(bench_test, sticks_are_closed_lie_in_their_box_and_have_the_asked_number_of_triangles) {
  for (const std::size_t n : {least_triangles, std::size_t{1003}, std::size_t{20'000}}) {
    const Mesh mesh = sticks(n);
    EXPECT_EQ(mesh.triangles.size(), n - n % 4);
    EXPECT_EQ(furthest(mesh), 1.0);
    expect_closed(mesh);
  }
}

TEST(bench_test, no_generated_triangle_is_without_area) {
  EXPECT_EQ(place_scene(bench::world_of(terrain(70'000))).degenerate_primitives, 0u);
  EXPECT_EQ(place_scene(bench::world_of(sticks(20'000))).degenerate_primitives, 0u);
}

TEST(bench_test, a_smooth_mesh_has_the_same_vertices_and_a_unit_normal_for_each) {
  const Mesh flat = terrain(5000), mesh = smooth(flat);
  EXPECT_EQ(mesh.positions, flat.positions);
  EXPECT_EQ(mesh.triangles.size(), flat.triangles.size());
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const glm::dvec3& n : mesh.normals) EXPECT_NEAR(glm::length(n), 1.0, 1e-12);
}

TEST(bench_test, lamps_shine_downwards_with_the_same_area_in_all) {
  const auto area = [](const Mesh& mesh) {
    double sum = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 n = glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
      EXPECT_LT(n.y, 0.0);
      sum += 0.5 * glm::length(n);
    }
    return sum;
  };
  EXPECT_EQ(small_lamps(1000).triangles.size(), 2000u);
  EXPECT_NEAR(area(small_lamps(1000)), area(lamp()), 1e-12);
}

TEST(bench_test, a_scene_file_of_the_terrain_is_the_scene_that_is_made_in_memory) {
  const ::TemporaryDirectory directory;
  write_terrain_scene(terrain(5000), directory / "", 512);
  const Scene read = place_scene(read_scene(directory / "terrain.xml")), made = place_scene(bench::world_of(terrain(5000)));
  EXPECT_EQ(read.triangles.size(), made.triangles.size());
  EXPECT_EQ(read.settings.film_width, made.settings.film_width);
  EXPECT_EQ(read.lights.size(), made.lights.size());
  // The file's numbers are rounded to float32, then those of lookat: 4 u of lengths of 1 and of directions of 2.
  const auto expect_near = [](const packed_float3& a, const packed_float3& b) {
    EXPECT_NEAR(a.x, b.x, 8 * 0x1p-24);
    EXPECT_NEAR(a.y, b.y, 8 * 0x1p-24);
    EXPECT_NEAR(a.z, b.z, 8 * 0x1p-24);
  };
  expect_near(read.camera.origin, made.camera.origin);
  expect_near(read.camera.corner, made.camera.corner);
  expect_near(read.camera.step_x, made.camera.step_x);
  expect_near(read.camera.step_y, made.camera.step_y);
}

TEST(bench_test, every_ray_without_an_end_starts_inside_the_box_and_hits) {
  for (const RaySet& set : prepared().sets) {
    EXPECT_EQ(set.rays.size(), std::size_t{rays_across} * rays_across) << set.name;
    std::size_t outside = 0;
    for (const Ray& ray : set.rays)
      for (const float c : {ray.origin.x, ray.origin.y, ray.origin.z}) outside += !(std::abs(c) <= 1.0f);
    EXPECT_EQ(outside, 0u) << set.name;
    if (!set.any_hit) {
      EXPECT_EQ(missed(prepared().closest(set.rays)), 0u) << set.name;
    }
  }
}

// A direction d that goes through film position (x, y) is a multiple of corner + x step_x + y step_y.
TEST(bench_test, each_64_primary_rays_fill_one_tile_of_the_film) {
  const Camera& camera = prepared().scene.camera;
  const glm::dmat3 from_film(unpacked(camera.step_x), unpacked(camera.step_y), unpacked(camera.corner));
  const glm::dmat3 to_film = glm::inverse(from_film);
  const std::vector<Ray>& rays = prepared().sets.at(0).rays;
  std::set<std::pair<int, int>> tiles;
  for (std::size_t first = 0; first < rays.size(); first += WORK_GROUP_SIZE) {
    std::set<std::pair<int, int>> pixels, own_tiles;
    for (std::size_t i = first; i < first + WORK_GROUP_SIZE; ++i) {
      const glm::dvec3 p = to_film * unpacked(rays[i].direction);
      const int x = static_cast<int>(std::floor(p.x / p.z)), y = static_cast<int>(std::floor(p.y / p.z));
      pixels.insert({x, y});
      own_tiles.insert({x / TILE_WIDTH, y / TILE_WIDTH});
    }
    EXPECT_EQ(pixels.size(), std::size_t{WORK_GROUP_SIZE});
    ASSERT_EQ(own_tiles.size(), 1u);
    tiles.insert(*own_tiles.begin());
  }
  EXPECT_EQ(tiles.size(), rays.size() / WORK_GROUP_SIZE);
}

// The cosine has the mean 2/3 and the variance 1/2 - 4/9 = 1/18; |z| <= 4.27 (docs/testing.md).
TEST(bench_test, diffuse_and_ao_rays_leave_the_side_that_was_seen_with_the_density_of_the_cosine) {
  const std::vector<Ray>& primary = prepared().sets.at(0).rays;
  const std::vector<Hit> hits = prepared().closest(primary);
  for (const std::size_t set : {1u, 3u}) {
    const std::vector<Ray>& rays = prepared().sets.at(set).rays;
    double sum = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Corners c = corners_of(prepared().scene, hits[i].primitive);
      glm::dvec3 normal = glm::normalize(glm::cross(unpacked(c[1]) - unpacked(c[0]), unpacked(c[2]) - unpacked(c[0])));
      if (glm::dot(normal, unpacked(primary[i].direction)) > 0.0) normal = -normal;
      const double cosine = glm::dot(normal, unpacked(rays[i].direction));
      EXPECT_GT(cosine, -1e-6);
      sum += cosine;
    }
    const double n = static_cast<double>(rays.size());
    EXPECT_LE(std::abs(sum / n - 2.0 / 3.0) / std::sqrt(1.0 / 18.0 / n), 4.27) << prepared().sets[set].name;
  }
}

TEST(bench_test, shadow_rays_end_on_a_square_below_the_top_and_ao_rays_are_short) {
  const double scale = std::ldexp(1.0, prepared().scene.frame.exponent);
  for (const Ray& ray : prepared().sets.at(2).rays) {
    const glm::dvec3 end = scale * (unpacked(ray.origin) + static_cast<double>(ray.t_max) * unpacked(ray.direction));
    EXPECT_NEAR(end.y, 1.0 - 2.0 / 32.0, 1e-6);  // lengths up to 3 and directions of float32: 3 u each
    EXPECT_LE(std::abs(end.x), 0.25 + 1e-6);
    EXPECT_LE(std::abs(end.z), 0.25 + 1e-6);
  }
  for (const Ray& ray : prepared().sets.at(3).rays) EXPECT_EQ(ray.t_max, static_cast<float>(ao_distance));
}

// More rays than a launch takes, the last group not full.
TEST(bench_test, each_ray_of_a_buffer_has_the_answer_that_it_has_alone) {
  const Scene scene = place_scene(bench::world_of(terrain(5000)));
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  OurTraversal traversal(device(), scene, bvh);
  const std::vector<Ray>& ao = prepared().sets.at(3).rays;
  const std::vector<Ray> few(ao.begin(), ao.begin() + 1000);
  std::vector<Ray> many;
  while (many.size() < max_launch + 1037) many.push_back(few[many.size() % few.size()]);
  const auto answers = [&](const std::vector<Ray>& rays) {
    traversal.load(rays);
    traversal.run(false);
    traversal.run(true);
    return std::pair(traversal.hits(), traversal.blocked());
  };
  const auto [few_hits, few_blocked] = answers(few);
  const auto [many_hits, many_blocked] = answers(many);
  std::size_t blocked = 0;
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(many_hits[i].t, few_hits[i % few.size()].t);
    EXPECT_EQ(many_hits[i].primitive, few_hits[i % few.size()].primitive);
    EXPECT_EQ(many_blocked[i], few_blocked[i % few.size()]);
    EXPECT_EQ(many_blocked[i] != 0, many_hits[i].primitive != NONE);
    blocked += many_blocked[i];
  }
  EXPECT_TRUE(blocked > 0 && blocked < many.size());
}

// Few rays: the memory checker runs this one, too.
TEST(bench_test, what_is_hit_is_blocked) {
  const Prepared few(least_triangles);
  const std::vector<Ray>& ao = few.sets.at(3).rays;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < WORK_GROUP_SIZE + 6; ++i) rays.push_back(ao[i * ao.size() / (WORK_GROUP_SIZE + 6)]);
  const Bvh bvh = build_bvh(few.scene, device().bvh_width);
  OurTraversal traversal(device(), few.scene, bvh);
  traversal.load(rays);
  traversal.run(false);
  traversal.run(true);
  const std::vector<Hit> expected = few.closest(rays), hits = traversal.hits();
  const std::vector<cl_uint> blocked = traversal.blocked();
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i].primitive != NONE, expected[i].primitive != NONE) << i;
    EXPECT_EQ(blocked[i] != 0, expected[i].primitive != NONE) << i;
    count += blocked[i] != 0;
  }
  EXPECT_TRUE(count > 0 && count < rays.size());
}

TEST(bench_test, a_render_of_n_segments_records_n_rays_a_pixel_in_a_closed_room) {
  World world = bench::world_of(terrain(5000));
  world.film.width = world.film.crop_width = 37;
  world.film.height = world.film.crop_height = 29;
  world.integrator.rr_depth = 100;
  for (const uint depth : {1u, 2u, 3u}) {
    world.integrator.max_depth = depth;
    const Scene scene = place_scene(world);
    const RecordedRays rays = record_rays(device(), scene, build_bvh(scene, device().bvh_width), 0, 2);
    EXPECT_EQ(rays.closest.size(), 37u * 29u * 2u * depth);
    EXPECT_EQ(rays.any.empty(), depth == 1);
    EXPECT_LE(rays.any.size(), 37u * 29u * 2u * (depth - 1));
  }
}

TEST(bench_test, contenders_take_turns_and_the_first_turn_is_not_counted) {
  std::string order;
  const auto contender = [&order](char name, double seconds) {
    return Contender{[&order, name] { order += static_cast<char>(name + 'a' - 'A'); },
                     [&order, name, seconds] {
                       order += name;
                       return seconds;
                     }};
  };
  const auto seconds = measure({contender('A', 1.0), contender('B', 2.0)}, 3);
  EXPECT_EQ(order, "aAbBbBaAaAbBbBaA");
  EXPECT_EQ(seconds, (std::vector<Seconds>{{1.0, 1.0, 1.0}, {2.0, 2.0, 2.0}}));
}

TEST(bench_test, the_median_of_an_even_number_of_values_lies_between_the_middle_two) {
  const Spread even = spread_of({4.0, 1.0, 2.0, 8.0}), odd = spread_of({5.0, 1.0, 3.0});
  EXPECT_EQ(even.median, 3.0);
  EXPECT_EQ(even.least, 1.0);
  EXPECT_EQ(even.most, 8.0);
  EXPECT_EQ(odd.median, 3.0);
}

TEST(bench_test, ratios_are_formed_round_by_round) {
  EXPECT_EQ(ratio_of({1.0, 6.0, 4.0}, {1.0, 2.0, 2.0}).median,
            2.0);  // of the medians it would be 4 / 2 as well, of the sums 11 / 5
  EXPECT_EQ(ratio_of({1.0, 10.0, 100.0}, {1.0, 5.0, 20.0}).most, 5.0);
}

TEST(bench_test, each_target_is_listed_once) {
  std::set<std::string> names;
  for (const Target& target : targets) EXPECT_TRUE(names.insert(target.name).second) << target.name;
}

TEST(bench_test, targets_judge_the_median_ratio_or_else_the_figure_itself) {
  EXPECT_EQ(figure_of(row("x")), 2.0);
  EXPECT_EQ(figure_of({"x", "s", 1.5, {}, {}}), 1.5);
  EXPECT_TRUE(met({"x", true, 2.0}, 2.0));
  EXPECT_FALSE(met({"x", true, 2.0}, 1.999));
  EXPECT_TRUE(met({"x", false, 2.0}, 2.0));
  EXPECT_FALSE(met({"x", false, 2.0}, 2.001));
}

TEST(bench_test, the_list_of_targets_tells_what_is_met_what_is_not_and_what_was_not_measured) {
  std::ostringstream text;
  Table table(text);
  Row first = row(targets[0].name), second = row(targets[1].name);
  first.ratio->median = targets[0].value;
  second.ratio->median = 0.5 * targets[1].value;
  table.add(first);
  table.add(second);
  text.str("");
  table.print_targets();
  const auto line = [&](const std::string& name) {
    const std::size_t at = text.str().find("\n" + name + "  ") + 1;
    return text.str().substr(at, text.str().find('\n', at) - at);
  };
  const auto ends_with = [](const std::string& said, const std::string& end) {
    return said.size() > end.size() && said.substr(said.size() - end.size()) == end;
  };
  EXPECT_TRUE(ends_with(line(targets[0].name), "  met")) << text.str();
  EXPECT_TRUE(ends_with(line(targets[1].name), "  NOT met"));
  for (std::size_t i = 2; i < std::size(targets); ++i) EXPECT_TRUE(ends_with(line(targets[i].name), "  not measured"));
}

TEST(bench_test, json_has_every_setting_and_row_and_another_table_takes_them_from_it) {
  std::ostringstream text;
  Table table(text);
  table.setting("machine", "here");
  table.heading("some");
  table.add(row("one"));
  table.add(row(targets[0].name));
  table.add({"three", "bytes", 96.0, {}, {}});
  table.note("a remark");
  const nlohmann::json json = nlohmann::json::parse(table.json());
  EXPECT_EQ(json["settings"]["machine"], "here");
  ASSERT_EQ(json["rows"].size(), 3u);
  EXPECT_EQ(json["rows"][0]["name"], "one");
  EXPECT_EQ(json["rows"][0]["ours"], 1.5);
  EXPECT_EQ(json["rows"][0]["peer"], 3.0);
  EXPECT_EQ(json["rows"][0]["ratio"]["least"], 1.75);
  EXPECT_FALSE(json["rows"][0].contains("target"));
  EXPECT_EQ(json["rows"][1]["target"]["at_least"], targets[0].value);
  EXPECT_EQ(json["rows"][1]["target"]["met"], true);
  EXPECT_FALSE(json["rows"][2].contains("ratio"));
  EXPECT_EQ(json["notes"][0], "a remark");
  for (const char* said : {"machine", "one", "three", "a remark"})
    EXPECT_NE(text.str().find(said), std::string::npos) << said;

  std::ostringstream silence;
  Table other(silence);
  other.take(table.json());
  EXPECT_EQ(silence.str(), "");
  EXPECT_EQ(nlohmann::json::parse(other.json())["rows"], json["rows"]);
}

TEST(bench_test, a_child_hands_back_its_result_or_its_error) {
  EXPECT_EQ(in_child([] { return std::string("done\0more", 9); }), std::string("done\0more", 9));
  try {
    in_child([]() -> std::string { throw Error(oclair::Exit::scene, "x.xml: broken"); });
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, oclair::Exit::scene);
    EXPECT_STREQ(error.what(), "x.xml: broken");
  }
}

TEST(bench_test, a_worker_keeps_its_state_between_actions) {
  int here = 0;
  Worker worker([&] { return Worker::Actions{[&] { return ++here; }, [&] { return 10.0 * here; }}; });
  EXPECT_EQ(worker.run(0), 1.0);
  EXPECT_EQ(worker.run(0), 2.0);
  EXPECT_EQ(worker.run(1), 20.0);
  EXPECT_EQ(here, 0);
  EXPECT_THROW(worker.run(7), Error);
}

TEST(bench_test, the_command_writes_a_row_for_every_target_of_the_traversal) {
  const ::TemporaryDirectory directory;
  const std::string file = (directory / "bench.json").string();
  const ProgramResult result = run_oclair({"bench", "traversal", "--triangles", "1000", "--rounds", "1", "--json", file});
  ASSERT_EQ(result.exit, 0) << result.err;
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream);
  std::set<std::string> names;
  for (const auto& entry : json["rows"]) {
    names.insert(entry["name"]);
    EXPECT_GT(entry["ours"], 0.0);
    EXPECT_NE(result.out.find(entry["name"].get<std::string>()), std::string::npos) << entry["name"];
  }
  EXPECT_EQ(names.size(), 12u);
  for (const Target& target : targets) {
    const std::string name = target.name;
    if (name.rfind("70k ", 0) == 0 && (name.find("closest") != std::string::npos || name.find("any") != std::string::npos)) {
      EXPECT_TRUE(names.count("1k " + name.substr(4))) << name;
    }
  }
  for (const char* setting : {"machine", "load", "device", "Embree", "rounds"})
    EXPECT_TRUE(json["settings"].contains(setting)) << setting;
}

TEST(bench_test, the_command_refuses_what_it_does_not_know_in_one_line) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"bench", "speed"}, "PART 'speed': expected traversal, path, build, start, sampler or all"},
      {{"bench", "traversal", "--triangles", "999"}, "--triangles '999': expected a whole number from 1000 to 100000000"},
      {{"bench", "traversal", "--rounds", "0"}, "--rounds '0': expected a whole number from 1 to 1000"},
      {{"bench", "traversal", "--growth", "--triangles", "1000"},
       "--growth: expected neither SCENE nor --triangles beside it"},
      {{"bench", "traversal", "a.xml", "--triangles", "1000"}, "--triangles: expected no SCENE beside it"},
  };
  for (const auto& [arguments, message] : cases) {
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 2) << message;
    EXPECT_EQ(result.err, "oclair: " + message + "\n");
    EXPECT_EQ(result.out, "");
  }
  EXPECT_EQ(run_oclair({"bench", "traversal", "no-such.xml"}).exit, 3);
  EXPECT_EQ(run_oclair({"bench", "traversal", "--device", "no such device"}).exit, 4);
}
