#include "tune.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>

#include "../error.h"
#include "../film.h"
#include "../film_plan.h"
#include "../render.h"
#include "../scene_hash.h"
#include "../schedule.h"
#include "../signals.h"

namespace oclair::tune {
namespace {

constexpr std::size_t most_kernels = 10;  // that the settings of a scene compile, some are shared

Effect effect_of(const Choices& chosen) {
  Effect strongest = Effect::none;
  for (const Choice& choice : choices())
    if (!choice.get(chosen).empty()) strongest = std::max(strongest, choice.effect);
  return strongest;
}

// A setting with all that its renders need.
struct Contender {
  Scene scene;
  Bvh bvh;
  Renderer renderer;
  Replicas replicas;

  Contender(const Device& device, const Scene& placed, const Choices& chosen)
      : scene(placed), bvh(prepare(device, chosen)), renderer(start_render(device, scene, bvh)) {}

  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  // One replica that does not count, for caches and the driver.
  void warm_up() {
    Replicas unused;
    add_replica(renderer, unused);
  }

 private:
  Bvh prepare(const Device& device, const Choices& chosen) {
    apply(chosen, scene);
    Bvh built = build_bvh(scene, bvh_width(chosen, device));
    scene.positions = {};
    scene.triangles = {};
    return built;
  }
};

// The film with the sides of `full` times the root of `share`, at most 1, in steps of the root of 2, so that small differences of
// the clock do not change it; no smaller than 16 pixels.
glm::uvec2 scaled(glm::uvec2 full, double share) {
  const double steps = std::min(0.0, std::floor(std::log2(share)));
  const double factor = std::exp2(0.5 * steps);
  const auto side = [&](unsigned whole) { return std::max(std::min(whole, 16u), static_cast<unsigned>(std::lround(whole * factor))); };
  return {side(full.x), side(full.y)};
}

// Bytes of the host's memory for a pixel: replicas of the reference, of both settings and of their differences, levels of the first of
// them, a difference for each row, sums in double, and the films of both.
double bytes_of_pixel(unsigned replicas) {
  constexpr double most_rows = 24.0, sums = 8.0;
  const double leveled = static_cast<double>(std::min<std::size_t>(replicas, leveled_replicas));
  const double pictures = 4.0 * replicas + 3.0 * (level_count - 1) * leveled + most_rows;
  return pictures * 3.0 * sizeof(float) + sums * 3.0 * sizeof(double) + 4.0 * (sizeof(FilmPixel) + sizeof(FilmErrors));
}

double pixels_of(glm::uvec2 film) { return static_cast<double>(film.x) * film.y; }

bool has_crop_window(const Settings& film) { return film.crop_width != film.film_width || film.crop_height != film.film_height; }

double mean_of(const Picture& picture) {
  double sum = 0.0;
  for (const float value : picture) sum += value;
  return sum / static_cast<double>(picture.size());
}

class Tuner {
 public:
  Tuner(const Request& request, const Tell& tell) : request_(request), tell_(tell), device_(open_device(request.device)) {
    result_.request = request;
    result_.scene = request.scene.filename().string();
    result_.device = device_.name;
    result_.driver = device_.platform;
  }

  Result run() {
    choose_size();
    prepare_accurate();
    std::vector<Choices> wanted = candidates(scene_, device_.bvh_width, mean_of(result_.picture));
    total_ = wanted.size() + 1;
    confidence_ = confidence_of_each(request_.confidence, total_);
    result_.interval_confidence = confidence_;
    for (const Choices& chosen : wanted) measure(chosen);
    if (const auto best = best_of_each(); best) measure(*best, true);
    if (result_.rows.empty() && !result_.interrupted) fail_for_time(pair_seconds_);
    finish();
    return std::move(result_);
  }

 private:
  double elapsed() const { return steady_seconds() - started_; }

  void place(std::optional<glm::uvec2> size) {
    World world = read_scene(request_.scene, request_.definitions, {size, {}});
    if (result_.scene_hash.empty()) request_.inspect(world);
    result_.scene_hash = scene_hash(world, request_.definitions);
    scene_ = place_scene(std::move(world));
    result_.width = scene_.settings.crop_width;
    result_.height = scene_.settings.crop_height;
  }

  // So large that the budget is used, as far as a pilot can tell. A scene with a crop window has the size that it says.
  void choose_size() {
    place(request_.size);
    const glm::uvec2 full{result_.width, result_.height};
    const double pixels = pixels_of(full), bytes = bytes_of_pixel(request_.replicas) * pixels;
    const double share_that_fits = static_cast<double>(default_film_memory()) / bytes;
    if (request_.size || has_crop_window(scene_.settings)) {
      if (share_that_fits >= 1.0) return;
      throw Error(Exit::device, "memory: " + std::to_string(request_.replicas) + " replicas of " + std::to_string(full.x) + "x" +
                                    std::to_string(full.y) + " pixels take " + mib(static_cast<std::size_t>(bytes)) + ", expected at most " +
                                    mib(default_film_memory()) + ", half of what there is; fewer --replicas or a smaller --size");
    }
    tell_(0, 0, "the size of the pictures");
    const glm::uvec2 small = scaled(full, 4096.0 / pixels);
    if (small != full) place(small);
    const double compiling = steady_seconds();
    Contender pilot(device_, scene_, {});
    pilot.warm_up();
    const double kernel_seconds = steady_seconds() - compiling;  // little if the driver has kept it, and then most others, too
    const double begun = steady_seconds();
    add_replica(pilot.renderer, pilot.replicas);
    const double seconds_of_pixel = (steady_seconds() - begun) / pixels_of(small);
    const std::size_t wanted = candidates(scene_, device_.bvh_width, mean_of(pilot.replicas.pictures[0])).size() + 1;
    const double left = 0.8 * (request_.budget - elapsed() - kernel_seconds * static_cast<double>(std::min(wanted, most_kernels)));
    const double replica = std::max(left, 1.0) / (2.0 * request_.replicas * static_cast<double>(wanted));
    const glm::uvec2 size = scaled(full, std::min(replica / seconds_of_pixel / pixels, share_that_fits));
    if (size != small) place(size);
  }

  void prepare_accurate() {
    tell_(0, 0, "accurate");
    accurate_ = std::make_unique<Contender>(device_, scene_, Choices{});
    accurate_->warm_up();
    const double begun = steady_seconds();
    double least = std::numeric_limits<double>::infinity();  // seconds of a replica: a stall of the machine is not their price
    for (unsigned k = 0; k < request_.replicas && !stop_requested(); ++k) {
      const double before = steady_seconds();
      add_replica(accurate_->renderer, reference_);
      least = std::min(least, steady_seconds() - before);
      const double needed = least * (3.0 * request_.replicas - (k + 1));  // for the rest of these, and for a pair
      if (k + 1 >= std::min<std::size_t>(request_.replicas, leveled_replicas + 1) && elapsed() + needed > request_.budget) fail_for_time(needed);
    }
    pair_seconds_ = 2.0 * (steady_seconds() - begun);
    if (reference_.pictures.empty()) throw Error(Exit::stopped, "stopped by a signal before the first picture: nothing is measured");
    result_.picture = mean_picture(reference_.pictures);
  }

  // Seconds that are still needed for one setting.
  [[noreturn]] void fail_for_time(double needed) const {
    char enough[32];
    std::snprintf(enough, sizeof enough, "%.0fs", std::ceil(1.2 * (elapsed() + needed) + 1.0));
    throw Error(Exit::stopped, "the budget is too short to measure one setting: expected --budget " + std::string(enough) +
                                   " or more for the first of them, a smaller --size or fewer --replicas");
  }

  void measure(const Choices& chosen, bool combination = false) {
    const std::string name = text_of(chosen);
    result_.interrupted = result_.interrupted || stop_requested();
    if (result_.interrupted || elapsed() + pair_seconds_ > request_.budget) {
      result_.not_measured.push_back(name);
      return;
    }
    tell_(result_.rows.size(), total_, name);
    const double begun = steady_seconds();
    Contender other(device_, scene_, chosen);
    other.warm_up();
    Renderer& accurate = accurate_->renderer;
    other.renderer.samples = accurate.samples;  // the same random numbers
    Replicas mine;
    for (unsigned k = 0; k < request_.replicas; ++k) {
      if (stop_requested()) result_.interrupted = true;
      if (result_.interrupted) break;
      for (const bool first : {k % 2 == 0, k % 2 != 0}) {
        if (first) add_replica(accurate, mine);
        else add_replica(other.renderer, other.replicas);
      }
    }
    pair_seconds_ = std::max(pair_seconds_, steady_seconds() - begun);
    if (result_.interrupted) {
      result_.not_measured.push_back(name);
      return;
    }
    Row row;
    row.name = name;
    row.choices = chosen;
    row.combination = combination;
    row.effect = effect_of(chosen);
    row.estimates = estimate(reference_.pictures, mine, other.replicas, confidence_);
    row.curve = convergence(reference_, other.replicas);
    row.difference = mean_picture(other.replicas.pictures);
    const Picture mean = mean_picture(mine.pictures);
    for (std::size_t i = 0; i < mean.size(); ++i) row.difference[i] -= mean[i];
    if (result_.rows.empty()) {
      const Estimates own = estimate(reference_.pictures, mine, mine, confidence_);
      result_.replica_variance = own.replica_variance;
      result_.replica_seconds = own.replica_seconds;
      result_.curve = convergence(reference_, mine);
    }
    judge(row, request_.error);
    result_.rows.push_back(std::move(row));
  }

  // The best value of each option that gains for sure, together; nothing if that is fewer than two options.
  std::optional<Choices> best_of_each() const {
    std::map<std::string, const Row*> best;  // by the option
    for (const Row& row : result_.rows) {
      if (!row.accurate_enough || !(row.gain.low > 1.0)) continue;
      const Row*& so_far = best[row.name.substr(0, row.name.find('='))];
      if (!so_far || row.gain.estimate > so_far->gain.estimate) so_far = &row;
    }
    if (best.size() < 2) return {};
    Choices together;
    for (const auto& [option, row] : best) together = joined(together, row->choices);
    return together;
  }

  void finish() {
    result_.seconds =
        seconds_to_error(request_.error, 0.0, result_.replica_variance, result_.replica_seconds).value_or(0.0);
    rank(result_);
    result_.rejected = rejected_samples(read_film(accurate_->renderer));
    result_.wall_seconds = elapsed();
  }

  const Request& request_;
  const Tell& tell_;
  const double started_ = steady_seconds();
  Device device_;
  Scene scene_;
  Result result_;
  std::unique_ptr<Contender> accurate_;
  Replicas reference_;  // accurate, with random numbers of its own
  std::size_t total_ = 0;
  double confidence_ = 0.0, pair_seconds_ = 0.0;
};

}  // namespace

Result tune(const Request& request, const Tell& tell) { return Tuner(request, tell).run(); }

bool has_bias(const Row& row) {
  return !row.estimates.same && (row.effect != Effect::noise || !row.estimates.bias.contains(0.0));
}

void judge(Row& row, double error) {
  const Estimates& e = row.estimates;
  const Interval bias = has_bias(row) ? e.squared_bias : Interval{0.0, 0.0, 0.0};
  const Interval variance = e.same ? Interval{1.0, 1.0, 1.0} : e.variance;
  // Nothing is gained where the bias alone is as large as the error, be there noise or none.
  const auto gain = [&](double speed, double variance_ratio, double squared_bias) {
    const double share_for_noise = 1.0 - std::max(0.0, squared_bias) / (error * error);
    return share_for_noise > 0.0 ? speed / variance_ratio * share_for_noise : 0.0;
  };
  row.gain = {gain(e.speed.estimate, variance.estimate, bias.estimate), gain(e.speed.low, variance.high, bias.high),
              gain(e.speed.high, variance.low, bias.low)};
  row.seconds = seconds_to_error(error, bias.estimate, e.replica_variance, e.replica_seconds);
  // What cannot happen has happened if an option without a bias shows one, or one without an effect other bits: then nothing is sure.
  // That an option which can have a bias has changed no sample bounds nothing.
  switch (row.effect) {
    case Effect::none:
    case Effect::noise: row.accurate_enough = !has_bias(row); break;
    case Effect::bias: row.accurate_enough = !e.same && bias.high < error * error && e.bias_bound < error; break;
  }
}

void rank(Result& result) {
  std::stable_sort(result.rows.begin(), result.rows.end(),
                   [](const Row& a, const Row& b) { return a.gain.estimate > b.gain.estimate; });
  const auto bias_of = [](const Row& row) {
    return has_bias(row) ? std::max(0.0, row.estimates.squared_bias.estimate) : 0.0;
  };
  // The accurate setting, whose gain is 1 and whose bias is 0, is a point of the plot as well.
  for (Row& row : result.rows) {
    row.on_front = row.seconds && (bias_of(row) > 0.0 || row.gain.estimate > 1.0);
    for (const Row& other : result.rows) {
      const bool no_worse = other.gain.estimate >= row.gain.estimate && bias_of(other) <= bias_of(row);
      if (no_worse && (other.gain.estimate > row.gain.estimate || bias_of(other) < bias_of(row))) row.on_front = false;
    }
    if (bias_of(row) > 0.0 && row.gain.estimate <= 1.0) row.on_front = false;
  }
  result.recommended.reset();
  for (std::size_t i = 0; i < result.rows.size() && !result.recommended; ++i)
    if (result.rows[i].accurate_enough && result.rows[i].gain.low > 1.0) result.recommended = i;
}

}  // namespace oclair::tune
