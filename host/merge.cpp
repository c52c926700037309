#include <algorithm>
#include <cassert>
#include <iterator>
#include <optional>

#include "aov.h"
#include "checkpoint.h"
#include "error.h"
#include "limbs.h"

namespace oclair {
namespace {

std::optional<std::string> value_of(const Identity& identity, const std::string& name) {
  for (const auto& [entry, value] : identity)
    if (entry == name) return value;
  return std::nullopt;
}

struct NamedRange {
  SampleRange range;
  std::string name;
};

void require_disjoint(std::vector<NamedRange> ranges) {
  std::sort(ranges.begin(), ranges.end(),
            [](const NamedRange& a, const NamedRange& b) { return a.range.first < b.range.first; });
  for (std::size_t i = 1; i < ranges.size(); ++i) {
    const NamedRange &a = ranges[i - 1], &b = ranges[i];
    if (b.range.first < a.range.end())
      throw Error(Exit::render_failed, b.name + ": its samples " + to_string(b.range) + " overlap the samples " +
                                           to_string(a.range) + " of " + a.name + ", expected disjoint ranges");
  }
}

struct Part {
  const Checkpoint& checkpoint;
  std::string name;
};

void require_mergeable(const std::vector<Part>& parts) {
  std::vector<NamedRange> ranges;
  for (const Part& part : parts) {
    require_same(with_film(parts[0].checkpoint), with_film(part.checkpoint), part.name);
    for (const SampleRange& range : part.checkpoint.ranges) ranges.push_back({range, part.name});
  }
  require_disjoint(ranges);
}

// The layers of both, of those that both have the first one's, as one render with all of them has them.
void add_layers(std::vector<Layer>& layers, std::vector<Layer> more) {
  const auto has = [&](const Layer& layer) {
    return std::any_of(layers.begin(), layers.end(), [&](const Layer& other) { return other.name == layer.name; });
  };
  more.erase(std::remove_if(more.begin(), more.end(), has), more.end());
  layers.insert(layers.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  std::stable_sort(layers.begin(), layers.end(),
                   [](const Layer& a, const Layer& b) { return aov_order(a.name) < aov_order(b.name); });
}

void add_to(FilmPixel& sum, const FilmPixel& other) {
  for (int c = 0; c < 3; ++c) add(sum.sum[c], other.sum[c]);
  sum.rejected += other.rejected;
  sum.hits += other.hits;
}

void add_to(FilmMoments& sum, const FilmMoments& other) {
  for (int k = 0; k < 6; ++k) add(sum.product[k], other.product[k]);
}

void add_to(FilmErrors& sum, const FilmErrors& other) {
  for (int c = 0; c < 3; ++c) {
    add(sum.sum[c], other.sum[c]);
    add(sum.square[c], other.square[c]);
  }
}

}  // namespace

Identity with_film(const Checkpoint& checkpoint) {
  const Film& film = checkpoint.film;
  const WorldFilm& window = checkpoint.head.film;
  Identity all = checkpoint.identity;
  const auto size = [](uint x, uint y) { return std::to_string(x) + "x" + std::to_string(y); };
  all.emplace_back("film size", size(window.width, window.height));
  all.emplace_back("crop size", size(film.width, film.height));
  all.emplace_back("crop offset", size(window.crop_x, window.crop_y));
  all.emplace_back("film exponent", std::to_string(film.exponent));
  return all;
}

void require_same(const Identity& expected, const Identity& found, const std::string& name) {
  std::string differences;
  const auto differs = [&](const std::string& entry, const std::string& is, const std::string& should) {
    differences += (differences.empty() ? "" : "; ") + one_line(entry + " is " + is + ", expected " + should);
  };
  for (const auto& [entry, value] : expected) {
    const std::optional<std::string> other = value_of(found, entry);
    if (other != value) differs(entry, other.value_or("absent"), value);
  }
  for (const auto& [entry, value] : found)
    if (!value_of(expected, entry)) differs(entry, value, "none");
  if (!differences.empty()) throw Error(Exit::render_failed, name + ": is of another render: " + differences);
}

void require_mergeable(std::span<const Checkpoint> heads, std::span<const std::string> names) {
  assert(heads.size() == names.size());
  std::vector<Part> parts;
  for (std::size_t i = 0; i < heads.size(); ++i) parts.push_back({heads[i], names[i]});
  require_mergeable(parts);
}

void add_samples(Checkpoint& sum, Checkpoint part, const std::string& name) {
  require_mergeable({{sum, "the film so far"}, {part, name}});
  if (sum.film.moments.empty() != part.film.moments.empty())
    throw Error(Exit::render_failed, name + ": only one of the films has second moments, expected both or neither");
  if (part.ranges.front().first < sum.ranges.front().first) std::swap(sum, part);
  Film& film = sum.film;
  for_each_array(
      [](const char*, bool, auto& to, const auto& from) {
        for_each_element(to.size(), [&](std::size_t i) { add_to(to[i], from[i]); }, to, from);
      },
      film, part.film);
  film.samples += part.film.samples;
  film.replicas += part.film.replicas;
  film.rays += part.film.rays;
  sum.ranges.insert(sum.ranges.end(), part.ranges.begin(), part.ranges.end());
  sum.ranges = joined(std::move(sum.ranges));
  add_layers(sum.layers, std::move(part.layers));
}

}  // namespace oclair
