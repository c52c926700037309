#include "stopping.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "film.h"

namespace oclair {
namespace {

constexpr double floor_share = 0.01;    // of the squared mean colour: a tenth of the mean radiance
constexpr uint cell_side = 8;           // pixels
constexpr double most_of_a_burst = 0.05;
constexpr double most_growth = 4.0;  // of the floor within a sequence of pairs: the picture's mean doubled
constexpr std::uint64_t fewest_pairs = 4;
constexpr std::uint64_t fewest_pixel_pairs = 4096;  // of all pixels together

double square(const std::array<double, 3>& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

// How far the mean of n independent values of unit deviation may ever stay below its expectation, but with probability alpha:
// the one-sided asymptotic confidence sequence of Waudby-Smith, Arbour, Sinha, Kennedy, Ramdas 2024 (Annals of Statistics 52:
// Time-uniform central limit theory and asymptotic confidence sequences), tightest near n = n0.
double sequence_width(double n, double alpha) {
  constexpr double n0 = 32;
  const double l = -2.0 * std::log(2.0 * alpha), r2 = (l + std::log(l + 1.0)) / n0, q = n * r2 + 1.0;
  return std::sqrt(2.0 * q / (n * n * r2) * std::log1p(std::sqrt(q) / (2.0 * alpha)));
}

std::string format(const char* pattern, double a, double b, double c) {
  char line[200];
  std::snprintf(line, sizeof line, pattern, a, b, c);
  return line;
}

}  // namespace

ErrorMonitor::ErrorMonitor(double target, double confidence, std::uint64_t block_samples, const FilmDirectory& directory,
                           std::size_t pixels)
    : target_(target), confidence_(confidence), block_(block_samples), pixels_(pixels, FilmAllocator<Pixel>(directory)) {
  assert(target > 0.0 && confidence > 0.0 && confidence < 1.0 && block_samples > 0);
}

void ErrorMonitor::add(const Film& film) {
  if (film.samples == 0 || film.samples % block_ != 0 || film.samples == samples_) return;
  if (samples_ == 0 || pixels_.size() != film.pixels.size() || film.samples != samples_ + block_) {
    rebase(film);
  } else if (pair_begun_) {
    end_pair(film);
  } else {
    begin_pair(film);
  }
  // What the film itself tells takes ten times as long as all else here: it is asked where only that is left.
  film_error_ = bound_reached() ? image_error(film) : std::nullopt;
}

void ErrorMonitor::begin_pair(const Film& film) {
  for_each_pixel(film, [&](std::size_t i) {
    const auto block = take_block(film, i);
    for (int c = 0; c < 3; ++c) pixels_[i].first[c] = static_cast<float>(block[c]);
  });
  samples_ = film.samples;
  pair_begun_ = true;
}

void ErrorMonitor::end_pair(const Film& film) {
  pair_begun_ = false;
  const std::size_t row_of_cells = (film.width + cell_side - 1) / cell_side;
  std::vector<double> cells(row_of_cells * ((film.height + cell_side - 1) / cell_side), 0.0);
  double y = 0.0;
  std::size_t row = 0, column = 0;
  for_each_pixel(film, [&](std::size_t i) {
    auto difference = take_block(film, i);
    for (int c = 0; c < 3; ++c) difference[c] -= pixels_[i].first[c];
    const double variance = 0.5 * square(difference), weighted = pixels_[i].weight * variance;
    pixels_[i].largest = std::max(pixels_[i].largest, variance);
    if (!black_) pixels_[i].variance_sum += variance;
    y += weighted;
    cells[row / cell_side * row_of_cells + column / cell_side] += weighted;
    if (++column == film.width) column = 0, ++row;
  });
  if (!black_) {
    const double count = static_cast<double>(pixels_.size());
    y /= count;
    ++pairs_;
    const double step = y - mean_;
    mean_ += step / static_cast<double>(pairs_);
    square_sum_ += step * (y - mean_);
    largest_burst_ = std::max(largest_burst_, *std::max_element(cells.begin(), cells.end()) / count);
  }
  samples_ = film.samples;
  set_weights(film);
}

// Calls body(i) for each pixel; what lies in files does not stay in memory behind it.
template <class Body>
void ErrorMonitor::for_each_pixel(const Film& film, const Body& body) {
  for_each_element(pixels_.size(), body, film, pixels_);
}

// Takes the film as where the next pair begins.
void ErrorMonitor::rebase(const Film& film) {
  if (pixels_.size() != film.pixels.size()) {
    pixels_ = FilmVector<Pixel>(film.pixels.size(), pixels_.get_allocator());
    unknown_pixels_ = 0;
  }
  for_each_pixel(film, [&](std::size_t i) { take_block(film, i); });
  samples_ = film.samples;
  pair_begun_ = false;
  set_weights(film);
}

void ErrorMonitor::set_weights(const Film& film) {
  const double count = static_cast<double>(pixels_.size());
  std::array<double, 3> mean{};
  for_each_pixel(film, [&](std::size_t i) {
    const auto pixel = known_mean(film, i);
    for (int c = 0; c < 3; ++c) mean[c] += pixel[c] / count;
  });
  const double floor = floor_share * square(mean);
  black_ = !(floor > 0.0);
  if (floor > most_growth * sequence_floor_) begin_sequence(floor);
  variance_mean_ = variance_square_mean_ = variance_most_ = pixel_burst_ = 0.0;
  for_each_pixel(film, [&](std::size_t i) {
    Pixel& pixel = pixels_[i];
    pixel.weight = black_ ? 0.0 : 1.0 / (square(known_mean(film, i)) + floor);
    pixel_burst_ = std::max(pixel_burst_, pixel.weight * pixel.largest / count);
    const double variance = pairs_ > 0 ? pixel.weight * pixel.variance_sum / static_cast<double>(pairs_) : 0.0;
    variance_mean_ += variance / count;
    variance_square_mean_ += variance * variance / count;
    variance_most_ = std::max(variance_most_, variance);
  });
}

// Forgets the pairs so far: the weights that they were seen with came from a picture that lacked most of its light.
void ErrorMonitor::begin_sequence(double floor) {
  spent_sequences_ += pairs_ >= pairs_needed();
  sequence_floor_ = floor;
  pairs_ = 0;
  mean_ = square_sum_ = largest_burst_ = 0.0;
  for_each_element(pixels_.size(), [&](std::size_t i) { pixels_[i].variance_sum = 0.0; }, pixels_);
}

// The pixel's mean, from the sums that take_block left.
std::array<double, 3> ErrorMonitor::known_mean(const Film& film, std::size_t i) const {
  const double accepted = static_cast<double>(film.samples - film.pixels[i].rejected);
  std::array<double, 3> mean{};
  for (int c = 0; c < 3 && accepted > 0.0; ++c) mean[c] = pixels_[i].sum[c] / accepted;
  return mean;
}

// The mean of the pixel's samples since the last film; 0 if all were left out.
std::array<double, 3> ErrorMonitor::take_block(const Film& film, std::size_t i) {
  Pixel& pixel = pixels_[i];
  const std::uint64_t rejected = film.pixels[i].rejected;
  const double taken = static_cast<double>((film.samples - samples_) - (rejected - pixel.rejected));
  // Relative to the film's scale, so that no scale of light overflows; rounded twice to double, which is enough here and quicker than
  // pixel_mean.
  const double unit = std::ldexp(1.0, -FILM_FRACTION_BITS);
  std::array<double, 3> block{};
  for (int c = 0; c < 3; ++c) {
    const ulong* const limbs = film.pixels[i].sum[c];
    const double sum = unit * (0x1p64 * static_cast<double>(limbs[1]) + static_cast<double>(limbs[0]));
    if (taken > 0.0) block[c] = (sum - pixel.sum[c]) / taken;
    pixel.sum[c] = sum;
  }
  pixel.rejected = rejected;
  if (!(taken > 0.0) && !pixel.unknown) {
    pixel.unknown = true;
    ++unknown_pixels_;
  }
  return block;
}

std::uint64_t ErrorMonitor::pairs_needed() const {
  const std::uint64_t pixels = std::max<std::uint64_t>(1, pixels_.size());
  return std::max(fewest_pairs, (fewest_pixel_pairs + pixels - 1) / pixels);
}

std::uint64_t ErrorMonitor::samples_to_judge() const {
  return pairs_ < pairs_needed() ? (2 * (pairs_needed() - pairs_) - (pair_begun_ ? 1 : 0)) * block_ : 0;
}

// What may go wrong in this sequence of pairs, for each of two reasons. Of all sequences together it is (1 - confidence) /
// 2: the first one has 15/16 of that, those after it 1/32, 1/64, ... One that ended before it could certify leaves its share to the
// next. It was never asked, but when it ended was decided by its samples: for this the sum over all sequences is approximate.
double ErrorMonitor::alpha() const {
  const int spent = static_cast<int>(std::min<std::uint64_t>(spent_sequences_, 60));
  const double share = spent == 0 ? 0.9375 : std::ldexp(1.0, -4 - spent);
  return 0.5 * (1.0 - confidence_) * share;
}

double ErrorMonitor::burst_share() const {
  return mean_ > 0.0 ? std::max(largest_burst_, pixel_burst_) / (mean_ * static_cast<double>(pairs_)) : 0.0;
}

std::optional<double> ErrorMonitor::estimate() const {
  if (pairs_ == 0) return std::nullopt;
  return std::sqrt(std::max(mean_, variance_mean_) * static_cast<double>(block_) / static_cast<double>(samples_));
}

std::optional<double> ErrorMonitor::bound() const {
  if (pairs_ < 2) return std::nullopt;
  const double pairs = static_cast<double>(pairs_), pixels = static_cast<double>(pixels_.size());
  // The deviation of Y from one pair to another: at least that of normal blocks in independent pixels.
  const double normal = 2.0 * variance_square_mean_ / pixels;
  const double seen = std::max(normal, square_sum_ / (pairs - 1.0));
  // First the expectation of Y. Weights have changed since the first pairs: those of today count if they say more.
  const double reweighting = mean_ > 0.0 ? std::max(1.0, variance_mean_ / mean_) : 1.0;
  const double expectation = reweighting * (mean_ + std::sqrt(seen) * sequence_width(pairs, alpha()));
  // Then the error of this one image about its expectation: of n blocks, n times the squared error is almost a weighted sum of
  // chi-squares, whose upper tail is bounded by Laurent, Massart 2000 (Adaptive estimation of a quadratic functional by model
  // selection), lemma 1. Almost: the kurtosis that makes Y deviate more than normal blocks do counts 2 / n as much here.
  const double blocks = static_cast<double>(samples_ / block_), x = -std::log(alpha());
  const double deviation = std::sqrt(normal + 2.0 * (seen - normal) / blocks);
  const double excess = deviation * std::sqrt(2.0 * x) + 2.0 * x * variance_most_ / pixels;
  return std::sqrt((expectation + excess) / blocks);
}

bool ErrorMonitor::bound_reached() const { return pairs_ >= pairs_needed() && *bound() <= target_; }

bool ErrorMonitor::certified() const { return why_not().empty(); }

std::string ErrorMonitor::why_not() const {
  const std::uint64_t needed = pairs_needed();
  if (unknown_pixels_ > 0)
    return "pixels of which all samples of a block were left out: " + std::to_string(unknown_pixels_) +
           "; nothing is known of their error";
  if (pairs_ < needed) {
    if (black_ && samples_ > 0) return "the picture is black so far";
    return "the error is judged after " + std::to_string(samples_to_judge()) + " more samples per pixel";
  }
  if (!bound_reached())
    return format("the error is below %.3g with %.4g %% confidence, %.3g was asked for", *bound(), 100.0 * confidence_, target_);
  if (film_error_ && !(*film_error_ <= target_))
    return format("the error is estimated as %.3g from all samples, %.4g times the %.3g that was asked for", *film_error_, *film_error_ / target_, target_);
  if (burst_share() > most_of_a_burst)
    return format("%.0f %% of the noise seen are a few samples in one block of %.0f x %.0f pixels: there may be more like them",
                  100.0 * burst_share(), cell_side, cell_side);
  return "";
}

std::optional<std::uint64_t> ErrorMonitor::samples_expected() const {
  const auto now = bound();
  if (!now) return std::nullopt;
  const std::uint64_t least = samples_ + samples_to_judge();
  const double share = *now / target_;
  return std::max(least, static_cast<std::uint64_t>(std::min(share * share * static_cast<double>(samples_), 0x1p62)));
}

}  // namespace oclair
