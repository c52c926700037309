#include "file_readers.h"

#include <cfloat>
#include <cmath>
#include <stdexcept>

#include "../host/bvh.h"
#include "../host/checkpoint.h"
#include "../host/error.h"
#include "../host/film.h"
#include "../host/header.h"
#include "../host/image_info.h"
#include "../host/image_planes.h"
#include "../host/mesh_file.h"
#include "../host/reader.h"
#include "../host/scene.h"
#include "../host/texture_file.h"
#include "checkpoint_cases.h"
#include "encoders.h"
#include "files.h"
#include "temporary_directory.h"

namespace oclair::test {
namespace {

namespace fs = std::filesystem;

bool is_within(const packed_float3& v, float most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

// Up to the device. What place_scene promises of the numbers that the kernels read is looked at where a file decides it.
void place(World world) {
  const Scene scene = place_scene(std::move(world));
  for (const packed_uint3& triangle : scene.triangles)
    for (const uint vertex : {triangle.x, triangle.y, triangle.z})
      if (!is_within(scene.positions[vertex], 1.0f)) throw std::logic_error("a vertex lies outside the canonical frame");
  for (const Quadric& quadric : scene.quadrics)
    if (!is_within(quadric.center, 1.0f) || !is_within(quadric.axis_x, FLT_MAX) || !is_within(quadric.axis_y, FLT_MAX) ||
        !is_within(quadric.axis_z, FLT_MAX) || !std::isfinite(quadric.area))
      throw std::logic_error("a quadric lies outside the canonical frame, or is not finite");
  for (const packed_float3& n : scene.normals)
    if (!is_within(n, 1.001f)) throw std::logic_error("a normal is not finite, or longer than 1");
  build_bvh(scene, 8);
}

// As the scene that names the file says it (refuse in host/document.cpp).
std::string as_part_of_a_scene(const std::exception& refusal) { return one_line(refusal.what()); }

template <class Parse>
std::string read_mesh(Parse parse) {
  try {
    World world;
    world.shapes.emplace_back().mesh = to_world(parse(), {});
    place(std::move(world));
  } catch (const MeshFileError& refusal) {
    return as_part_of_a_scene(refusal);
  } catch (const std::range_error& refusal) {  // of to_world
    return as_part_of_a_scene(refusal);
  } catch (const Error& refusal) {
    return refusal.what();
  }
  return "";
}

template <class Read>
std::string read_file(const fs::path& path, std::string_view bytes, Read read) {
  put(path, std::string(bytes));
  try {
    read(path);
  } catch (const Error& refusal) {
    return refusal.what();
  }
  return "";
}

const std::string TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
const std::string PLY_TRIANGLE =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float heat_x\n"
    "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 1\n1 0 0 0\n0 1 0 1\n3 0 1 2\n";

// The directory of the scene that is read.
const TemporaryDirectory& scene_directory() {
  static const TemporaryDirectory directory;
  static const bool filled = [] {
    put(directory / "a.obj", TRIANGLE);
    put(directory / "a.ply", PLY_TRIANGLE);
    put(directory / "a.serialized",
        content(fs::path(OCLAIR_TEST_DIRECTORY) / "data" / "fuzz" / "serialized" / "two_shapes"));
    put(directory / "a.png", png_bytes(2, 1, PNG_COLOR_TYPE_RGB, 8, {200, 100, 50, 0, 255, 1}));
    const std::vector<float> values = {0.5f, 1.0f, 0.0f, 100.0f};
    put(directory / "a.exr",
        exr_bytes(2, 2, {{"R", Imf::HALF, values}, {"G", Imf::HALF, values}, {"B", Imf::HALF, values}}));
    put(directory / "included.xml", "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"a\"/></scene>");
    return true;
  }();
  (void)filled;
  return directory;
}

void write_images(const fs::path& exr, const fs::path& png, const Checkpoint& checkpoint) {
  const Film& film = checkpoint.film;
  const WorldFilm& window = checkpoint.head.film;
  Figures figures;
  figures.ranges = checkpoint.ranges;
  figures.rejected = rejected_samples(film);
  figures.rays = film.rays;
  figures.estimated_error = image_error(film);
  write_exr(exr, {window.width, window.height, window.crop_x, window.crop_y, window.crop_width, window.crop_height},
            parts_of(film, window.pixel_format, checkpoint.head.moment_name, checkpoint.layers),
            header_attributes(checkpoint.head.attributes, figures, {}));
  write_png(png, film.width, film.height, rgb_of(film));
}

// With as many samples that come after its own: what is written then can be read.
void merge_with_next_samples(const Checkpoint& checkpoint, const fs::path& path) {
  const std::uint64_t samples = checkpoint.film.samples;
  const std::uint64_t end = (checkpoint.ranges.back().end() + REPLICA_SAMPLES - 1) / REPLICA_SAMPLES * REPLICA_SAMPLES;
  if (end > MAX_SAMPLES - samples) return;
  Checkpoint sum = checkpoint, part = checkpoint;
  part.ranges = {{end, samples}};
  part.film.replicas = count_replicas(part.ranges);
  add_samples(sum, std::move(part), "the next samples");
  write_checkpoint(path, sum);
  try {
    read_checkpoint(path);
  } catch (const Error& error) {
    throw std::logic_error(error.what());
  }
}

}  // namespace

std::string read_as_scene(std::string_view bytes) {
  return read_file(scene_directory() / "scene.xml", bytes, [](const fs::path& path) { place(read_scene(path)); });
}

std::string read_as_obj(std::string_view bytes) {
  return read_mesh([&] { return parse_obj(bytes); });
}

std::string read_as_ply(std::string_view bytes) {
  return read_mesh([&] { return parse_ply(bytes); });
}

std::string read_as_serialized(std::string_view bytes) {
  const std::string first = read_mesh([&] { return parse_serialized(bytes, 0); });
  const std::string second = read_mesh([&] { return parse_serialized(bytes, 1); });
  return first.empty() ? second : first;
}

std::string read_as_image(std::string_view bytes) {
  try {
    const Image image = parse_image(bytes);
    constexpr std::size_t SIZES[] = {1, 2, 2, 4};  // TexelFormat
    if (image.texels.size() != std::size_t{image.width} * image.height * image.channels * SIZES[image.format] ||
        image.texels.empty())
      throw std::logic_error("the texels are not as many as the image says");
  } catch (const TextureFileError& refusal) {
    return as_part_of_a_scene(refusal);
  }
  return "";
}

std::string read_as_exr(std::string_view bytes) {
  static const TemporaryDirectory directory;
  return read_file(directory / "a.exr", bytes, [](const fs::path& path) {
    read_image_info(path);
    try {
      read_image_planes(path);
    } catch (const Error&) {  // that has no colour
    }
  });
}

std::string read_as_checkpoint(std::string_view bytes) {
  static const TemporaryDirectory directory;
  return read_file(directory / "a.checkpoint", bytes, [](const fs::path& path) {
    const Checkpoint checkpoint = read_checkpoint(path);
    write_images(directory / "a.exr", directory / "a.png", checkpoint);
    merge_with_next_samples(checkpoint, directory / "b.checkpoint");
  });
}

}  // namespace oclair::test
