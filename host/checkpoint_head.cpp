#include "checkpoint_head.h"

#include <nlohmann/json.hpp>

namespace oclair {
namespace {

using Json = nlohmann::json;

constexpr int MAX_EXPONENT = 4096;    // far beyond what float radiances lead to
constexpr double MAX_RADIUS = 1e6;    // pixels
constexpr int MAX_NESTING = 4;
constexpr std::size_t MAX_IDENTITY = 1000;  // entries: those of two checkpoints are searched one by one

// JSON holds only UTF-8. A string of other bytes becomes an array of their numbers.
Json json_of(const std::string& text) {
  try {
    Json(text).dump();
    return text;
  } catch (const Json::type_error&) {
    return std::vector<unsigned char>(text.begin(), text.end());
  }
}

Json json_of(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json list = Json::array();
  for (const auto& [name, value] : pairs) list.push_back(Json::array({json_of(name), json_of(value)}));
  return list;
}

const Json& member(const Json& object, const std::string& name) {
  if (!object.is_object() || !object.contains(name)) throw CheckpointHeadError("lacks " + name);
  return object[name];
}

const Json& list(const Json& json, const std::string& name, std::size_t least, std::size_t most) {
  if (!json.is_array() || json.size() < least || json.size() > most) throw CheckpointHeadError("has a wrong list " + name);
  return json;
}

std::int64_t whole(const Json& json, const std::string& name, std::int64_t least, std::int64_t most) {
  const bool fits = json.is_number_integer() && !(json.is_number_unsigned() && json.get<std::uint64_t>() >> 63);
  if (!fits || json.get<std::int64_t>() < least || json.get<std::int64_t>() > most)
    throw CheckpointHeadError("has a wrong " + name + " (from " + std::to_string(least) + " to " + std::to_string(most) + ")");
  return json.get<std::int64_t>();
}

uint side(const Json& json, const std::string& name, uint least, uint most = MAX_FILM_SIDE) {
  return static_cast<uint>(whole(json, name, least, most));
}

double real(const Json& json, const std::string& name) {
  if (!json.is_number() || !(json.get<double>() >= 0) || json.get<double>() > MAX_RADIUS)
    throw CheckpointHeadError("has a wrong " + name);
  return json.get<double>();
}

std::string text(const Json& json, const std::string& name) {
  if (json.is_string()) return json.get<std::string>();
  std::string bytes;
  for (const Json& byte : list(json, name, 0, MAX_HEAD)) bytes.push_back(static_cast<char>(whole(byte, name, 0, 255)));
  return bytes;
}

std::vector<std::pair<std::string, std::string>> text_pairs(const Json& json, const std::string& name,
                                                            std::size_t most = MAX_HEAD) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const Json& pair : list(json, name, 0, most)) {
    list(pair, name, 2, 2);
    pairs.emplace_back(text(pair[0], name), text(pair[1], name));
  }
  return pairs;
}

std::vector<SampleRange> ranges(const Json& json) {
  std::vector<SampleRange> result;
  for (const Json& pair : list(json, "ranges", 1, MAX_HEAD)) {
    list(pair, "ranges", 2, 2);
    const auto first = static_cast<std::uint64_t>(whole(pair[0], "first sample", 0, MAX_SAMPLES - 1));
    const auto count = static_cast<std::uint64_t>(whole(pair[1], "count of samples", 1, MAX_SAMPLES - first));
    if (first % REPLICA_SAMPLES != 0)
      throw CheckpointHeadError("has a range that begins within a replica of " + std::to_string(REPLICA_SAMPLES) + " samples");
    if (!result.empty() && result.back().end() >= first) throw CheckpointHeadError("has ranges that are not in order");
    result.push_back({first, count});
  }
  return result;
}

Json json_of(const WorldFilm& film) {
  return {{"size", {film.width, film.height}},
          {"crop", {film.crop_x, film.crop_y, film.crop_width, film.crop_height}},
          {"filter", static_cast<int>(film.filter)},
          {"filter radius", film.filter_radius},
          {"filter deviation", film.filter_stddev},
          {"sample border", film.sample_border ? 1 : 0},
          {"pixel format", static_cast<int>(film.pixel_format)}};
}

WorldFilm world_film(const Json& json) {
  WorldFilm film;
  const Json& size = list(member(json, "size"), "size", 2, 2);
  const Json& crop = list(member(json, "crop"), "crop", 4, 4);
  film.width = side(size[0], "width", 1);
  film.height = side(size[1], "height", 1);
  film.crop_x = side(crop[0], "crop", 0, film.width - 1);
  film.crop_y = side(crop[1], "crop", 0, film.height - 1);
  film.crop_width = side(crop[2], "crop", 1, film.width - film.crop_x);
  film.crop_height = side(crop[3], "crop", 1, film.height - film.crop_y);
  film.filter = static_cast<FilterKind>(side(member(json, "filter"), "filter", 0, static_cast<uint>(FilterKind::gaussian)));
  film.filter_radius = real(member(json, "filter radius"), "filter radius");
  film.filter_stddev = real(member(json, "filter deviation"), "filter deviation");
  film.sample_border = side(member(json, "sample border"), "sample border", 0, 1) == 1;
  film.pixel_format =
      static_cast<PixelFormat>(side(member(json, "pixel format"), "pixel format", 0, static_cast<uint>(PixelFormat::xyza)));
  return film;
}

bool refuse_nesting(int depth, Json::parse_event_t, Json&) {
  if (depth > MAX_NESTING) throw CheckpointHeadError("is nested too deeply");
  return true;
}

CheckpointHead head_of(const Json& json) {
  CheckpointHead head;
  Checkpoint& checkpoint = head.checkpoint;
  checkpoint.identity = text_pairs(member(json, "identity"), "identity", MAX_IDENTITY);
  checkpoint.ranges = ranges(member(json, "ranges"));
  checkpoint.head.film = world_film(member(json, "film"));
  checkpoint.kept = whole(member(json, "kept"), "kept", 0, 1) == 1;
  checkpoint.head.moment_name = text(member(json, "moment name"), "moment name");
  checkpoint.head.attributes = text_pairs(member(json, "attributes"), "attributes");
  checkpoint.film.width = checkpoint.head.film.crop_width;
  checkpoint.film.height = checkpoint.head.film.crop_height;
  checkpoint.film.exponent = static_cast<int>(whole(member(json, "exponent"), "exponent", -MAX_EXPONENT, MAX_EXPONENT));
  checkpoint.film.rays = static_cast<std::uint64_t>(whole(member(json, "rays"), "rays", 0, std::numeric_limits<std::int64_t>::max()));
  checkpoint.film.samples = count_samples(checkpoint.ranges);
  checkpoint.film.replicas = count_replicas(checkpoint.ranges);
  for (const Json& name : list(member(json, "layers"), "layers", 0, MAX_HEAD))
    checkpoint.layers.push_back({text(name, "layers"), {}});
  for (const Json& entry : list(member(json, "arrays"), "arrays", 0, MAX_HEAD)) {
    list(entry, "arrays", 3, 3);
    const auto bytes = whole(entry[1], "size of an array", 0, std::numeric_limits<std::int64_t>::max());
    head.arrays.push_back({text(entry[0], "arrays"), static_cast<std::uint64_t>(bytes), text(entry[2], "arrays")});
  }
  return head;
}

}  // namespace

std::string head_text(const Checkpoint& checkpoint, const std::vector<ArrayEntry>& arrays) {
  Json json;
  json["identity"] = json_of(checkpoint.identity);
  json["ranges"] = Json::array();
  for (const SampleRange& range : checkpoint.ranges) json["ranges"].push_back(Json::array({range.first, range.count}));
  json["film"] = json_of(checkpoint.head.film);
  json["exponent"] = checkpoint.film.exponent;
  json["kept"] = checkpoint.kept ? 1 : 0;
  json["rays"] = checkpoint.film.rays;
  json["moment name"] = json_of(checkpoint.head.moment_name);
  json["attributes"] = json_of(checkpoint.head.attributes);
  json["layers"] = Json::array();
  for (const Layer& layer : checkpoint.layers) json["layers"].push_back(json_of(layer.name));
  json["arrays"] = Json::array();
  for (const ArrayEntry& array : arrays) json["arrays"].push_back(Json::array({array.name, array.bytes, array.checksum}));
  return json.dump() + "\n";
}

CheckpointHead parse_head(std::string_view text) {
  try {
    return head_of(Json::parse(text, refuse_nesting));
  } catch (const Json::exception& error) {
    throw CheckpointHeadError(std::string("cannot be parsed: ") + error.what());
  }
}

}  // namespace oclair
